#include "tape/model/roll.hpp"

#include "tape/model/primitives.hpp"
#include "tape/model/strip_mesh.hpp"

namespace tape {
namespace {
Body make_hub(const Core& core, const Pose& roll) {
  if (!(core.inner_diameter < core.outer_diameter))
    throw InputError("roll.core.inner_diameter = " + to_text(core.inner_diameter) +
                     " m: the core has no wall (allowed: < outer_diameter, " + to_text(core.outer_diameter) + " m)");
  Mat3 axis_along_y;  // from z
  axis_along_y << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  Body hub;
  hub.name = "hub";
  hub.mesh = ring_mesh(core.inner_diameter / 2, core.outer_diameter / 2, core.height, core.sides, 1);
  hub.motion = Motion::dynamic;
  hub.pose = {roll.rotation * axis_along_y, roll.position};
  hub.density = core.density;
  hub.solid = core_properties(core);
  return hub;
}
}  // namespace

void wind(Scene& scene, Strip& strip, const WindingParams& params, const Core& core, const Pose& pose) {
  const Film& film = scene.films[static_cast<std::size_t>(strip.film)];
  Winding& winding = strip.winding.emplace(make_winding(params, core, film));
  winding.hub = static_cast<int>(scene.bodies.size());
  strip.mesh.length = winding.length() + params.free_length;
  winding.cell = cell_length(strip.mesh, film.width);
  strip.mesh.length = winding.wound() + params.free_length;
  strip.pose = pose;
  if (params.sense == Sense::left) strip.pose.rotation *= Vec3(-1, -1, 1).asDiagonal();
  scene.bodies.push_back(make_hub(core, strip.pose));
}
}  // namespace tape
