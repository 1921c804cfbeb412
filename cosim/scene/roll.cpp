#include "cosim/scene/roll.hpp"

#include "cosim/scene/pose.hpp"
#include "tape/model/roll.hpp"

namespace cosim {
void read_roll(const Reader& roll, const Reader& strip_section, tape::Scene& scene, tape::Strip& strip) {
  if (const Reader length = strip_section["length"]) length.fail("follows from roll.turns and roll.free_length");
  for (const char* key : {"position", "rotation_deg", "path", "velocity"})
    if (const Reader value = strip_section[key]) value.fail("the strip of a roll is where the roll is");
  strip_section.read(strip.mesh);
  tape::WindingParams params;
  tape::Core core;
  roll.read(params);
  roll["core"].read(core);
  try {
    wind(scene, strip, params, core, read_pose(roll));
  } catch (const tape::InputError& e) {
    roll.fail(e.what());
  }
}
}  // namespace cosim
