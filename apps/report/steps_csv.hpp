#pragma once
#include <string>
#include <vector>

#include "cosim/run/run_log.hpp"

namespace tape::report {
using cosim::Phase;
/// Column names of steps.csv, units in the names.
/// @param phases  of the script; with any there is a column of the name of each step's phase
std::vector<std::string> step_columns(const World& world, const std::vector<Phase>& phases);
/// One step in these columns.
std::vector<std::string> step_cells(const World& world, const std::vector<Phase>& phases, const cosim::StepRow& row);
}  // namespace tape::report
