#pragma once
#include <string>
#include <vector>

#include "cosim/run/run_log.hpp"

namespace tape::report {
/// Column names of steps.csv, units in the names.
std::vector<std::string> step_columns(const World& world);
/// One step in these columns.
std::vector<std::string> step_cells(const World& world, const cosim::StepRow& row);
}  // namespace tape::report
