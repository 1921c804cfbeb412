#pragma once
#include "apps/report/table.hpp"
#include "cosim/run/summary.hpp"

namespace tape::report {
/// What the phases of a run took, and what in them took it: a step's time is split into the tape's solve, contact search (candidates and
/// CCD), Bullet with the exchange, and cutting.
Table phase_table(const std::vector<cosim::PhaseSummary>& phases);
}  // namespace tape::report
