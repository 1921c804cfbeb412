#pragma once
#include "apps/tapesim/study_file.hpp"
#include "cosim/run/figures.hpp"

namespace tape::tapesim {
/// What a run of a study leaves for the comparison.
struct Measured {
  Real error = 0;                   ///< against a closed form
  Real value = 0;                   ///< of the figure, for the comparison with the finest run
  std::vector<Vec3> middle_line{};  ///< [m] the same, for the comparison of states
};
/// @throws InputError if the scene has not what the reference is about
Measured measure(const Reference& reference, const World& world, const cosim::RunLog& log);
/// Error of a run against the finest one: |difference| of figures, or largest distance [m] of middle lines.
Real distance(const Reference& reference, const Measured& run, const Measured& finest);
/// What `error` means, with its unit.
std::string error_label(const Reference& reference);
}  // namespace tape::tapesim
