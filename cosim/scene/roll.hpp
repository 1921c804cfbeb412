#pragma once
#include "cosim/scene/reader.hpp"
#include "tape/model/scene.hpp"

namespace cosim {
/// Winds `strip` as the section `roll` says and adds its hub to the scene, but for the hub's material.
/// @param strip_section  `strip` of the scene file, if it is there: no key of it may say where the strip is or how long
void read_roll(const Reader& roll, const Reader& strip_section, tape::Scene& scene, tape::Strip& strip);
}  // namespace cosim
