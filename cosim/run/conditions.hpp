#pragma once
#include <string>
#include <vector>

#include "cosim/run/run_log.hpp"

namespace cosim {
/// Something that a trustworthy run meets, or that the scene states. The report and the terminal show what is not met; a run that comes to
/// its end without meeting what its scene states has failed.
struct Condition {
  std::string name;
  Real value = 0;
  std::string required;  ///< relation and number, such as "<= 0.05"
  bool met = true;
  bool stated = false;  ///< by the scene
};
/// All conditions of a run; README.md of this folder defines them.
std::vector<Condition> check_conditions(const World& world, const RunLog& log);

/// Largest balance of energy above an earlier one, per scale of energy [1]: what came from nowhere.
Real energy_rise(const RunLog& log);
}  // namespace cosim
