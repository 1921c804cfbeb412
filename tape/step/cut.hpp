#pragma once
#include <string>
#include <vector>

#include "tape/cutting/pressure.hpp"
#include "tape/step/world.hpp"

namespace tape {
/// Vertices of the world on the edge of a blade.
/// @throws InputError if there is no such body, the edge has no length, or fewer than two vertices of the body's mesh are on it
std::vector<int> sharp_vertices(const World& world, const Blade& blade);

/// @throws InputError if a blade cannot be, or a kerf is no wider than the contact of a strip with itself: its sides would touch
void require_blades(const World& world);

/// Watches the blades of a world, as long as no strip is cut.
class BladeWatch {
 public:
  explicit BladeWatch(const World& world);
  bool any() const { return !probes_.empty(); }
  /// [blades] by the barrier's forces on sharp vertices.
  /// @param x  [nv] m
  std::vector<BladePressure> pressures(const std::vector<ContactPair>& pairs, const std::vector<Vec3>& x) const;

 private:
  const World& world_;
  std::vector<BladePressureProbe> probes_;  // [blades]
  std::vector<char> sharp_;                 // [vertices] of any blade
};

/// A cut that was made, or why it was not.
struct CutReport {
  std::string blade, strip;
  std::string refusal = {};           ///< empty: the cut was made
  Real pressure = 0;                  ///< [Pa]
  int pieces = 0;                     ///< of the strip now
  Real kerf_area = 0, kerf_mass = 0;  ///< [m^2], [kg] taken away
  Real smallest_angle = 0;            ///< [deg] of the new triangles
  Real deviation = 0;                 ///< [m] of the kerf's middle from the blade
  Real largest_change = 0;            ///< [m/s] of a vertex, by what restores momentum
  Real kinetic = 0;                   ///< [J] change of the energy of motion
  std::vector<Vec3> where = {};       ///< [m] the blade's edge
};

/// After a step: counts the steps that blades press, and cuts the strip under a blade that has pressed long enough. World and state change
/// together, or not at all: what uses the world must take the state up anew (Stepper::renew). At most one cut a step; a second blade waits.
/// @param pressures  [blades]
std::vector<CutReport> cut_strips(World& world, State& state, const std::vector<BladePressure>& pressures);
}  // namespace tape
