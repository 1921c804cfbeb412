#pragma once
#include <stdexcept>

#include "apps/tapesim/study_file.hpp"
#include "cosim/run/figures.hpp"

namespace tape::tapesim {
/// What a run of a study leaves for the comparison.
struct Measured {
  Real error = 0;              ///< against a closed form
  Real value = 0;              ///< of the figure, for the comparison with the finest run
  std::vector<Vec3> points{};  ///< [m] the same: of the middle line, or of the hub's centre at equal times
  std::vector<Vec3> turns{};   ///< [rad] rotation vectors of the hub at these times
};
/// What came of a run has nothing to measure, as where nothing was peeled: a result, not a mistake in the study.
struct NothingMeasured : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// @throws InputError if the scene has not what the reference is about; NothingMeasured
Measured measure(const Reference& reference, const World& world, const cosim::RunLog& log);
/// Error of a run against the finest one: |difference| of figures, largest distance [m] of middle lines, or RMS distance [m] of the hub.
Real distance(const Reference& reference, const Measured& run, const Measured& finest);
/// RMS angle [deg] between the orientations of the hub.
Real turn_distance(const Measured& run, const Measured& finest);
/// What `error` means, with its unit.
std::string error_label(const Reference& reference);
}  // namespace tape::tapesim
