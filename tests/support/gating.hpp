#pragma once
#include <numbers>

#include "tape/math/rotation.hpp"
#include "tape/model/primitives.hpp"
#include "tests/support/simulation.hpp"

/// Scenes in which an effect is off, or on with a coefficient of zero.
namespace tape::test {
/// A strip that drops onto a drum and slides off it.
inline Setup draped() {
  auto setup = strip_setup(flat_strip(0.06, 3, Vec3(-0.02, 0, 0.0205)));
  add_body(setup, "drum", cylinder_mesh(0.02, 0.03, 24, 1), Motion::fixed, Vec3::Zero()).pose.rotation =
      rotation_exp(Vec3(std::numbers::pi / 2, 0, 0));
  setup.newton.velocity_tol = 1e-6;
  return setup;
}
/// A strip that hangs by its root, swings, and comes near to nothing.
inline Setup swinging() {
  Strip strip = flat_strip(0.05, 3, Vec3::Zero());
  strip.pose.rotation = rotation_exp(Vec3(0, std::numbers::pi / 3, 0));
  auto setup = strip_setup(strip);
  setup.scene.grips = {hold("hook", root_vertices(make_strip_mesh(strip.mesh, 0.019, 1), 1e-9))};
  add_body(setup, "floor", box_mesh(Vec3(0.2, 0.2, 0.01)), Motion::fixed, Vec3(0, 0, -0.2));
  setup.newton.velocity_tol = 1e-6;
  return setup;
}
inline Setup without(Setup setup, std::initializer_list<std::string> effects) {
  for (const std::string& effect : effects) setup.forced[effect] = false;
  return setup;
}
inline Setup frictionless() {  // built all the same
  auto setup = draped();
  setup.scene.materials[0].mu = 0;
  setup.forced["friction"] = true;
  return setup;
}
inline Setup limp() {
  auto setup = swinging();
  setup.scene.films[0].bending_modulus = 1e-20;
  return setup;
}
}  // namespace tape::test
