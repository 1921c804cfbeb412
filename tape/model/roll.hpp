#pragma once
#include "tape/model/scene.hpp"

namespace tape {
/// Winds `strip` around a hub that is added to scene.bodies: a dynamic body named `hub`.
/// @param strip  its film, mesh settings, name and material; its length, pose and winding are set here
/// @param pose   of the roll: the centre of its hub; the axis is y. Sense `right` leaves the top of the roll along x; `left` is the same
///               roll turned half around z, so its free end points along -x and the surfaces are mirror images
/// @throws InputError if settings are out of range or cannot make a roll
void wind(Scene& scene, Strip& strip, const WindingParams& params, const Core& core, const Pose& pose);
}  // namespace tape
