#include <cmath>
#include <numbers>

#include "tape/math/rotation.hpp"
#include "tape/model/primitives.hpp"
#include "tests/hard/hard_case.hpp"

namespace tape::test {
namespace {
constexpr Real kGravity = 9.81;

void set_friction(Setup& setup, Real mu) {
  for (Material& m : setup.scene.materials) m.mu = mu;
}

/// Strips of 30 mm one above the other, `spacing` apart, the lowest at height z.
Setup stack(int sheets, int cells, Real spacing, Real z) {
  Setup setup = dropped_strip(0.03, cells, z);
  for (int k = 1; k < sheets; ++k) {
    Strip strip = setup.scene.strips[0];
    strip.name = "tape" + std::to_string(k + 1);
    strip.pose.position.z() = z + k * spacing;
    setup.scene.strips.push_back(strip);
  }
  return setup;
}
Setup frictionless_stack(int cells, MeshPattern pattern) {
  Setup setup = stack(3, cells, 3.6e-4, 3e-4);
  for (Strip& strip : setup.scene.strips) strip.mesh.pattern = pattern;
  set_friction(setup, 0);
  setup.newton.velocity_tol = 1e-7;
  add_body(setup, "floor", box_mesh(Vec3(0.06, 0.04, 0.01)), Motion::fixed, Vec3(0, 0, -0.005));
  return setup;
}
Setup floating_stack() {
  Setup setup = stack(3, 3, 2 * vinyl().xi + vinyl().dhat + 1e-5, 0);
  setup.scene.gravity.setZero();
  return setup;
}
/// Nothing drives the sheets sideways.
void stays_in_place(const Simulation& s, std::vector<std::string>& broken) {
  for (const StripPart& part : s.world().assembly.strips) {
    Vec3 drift = Vec3::Zero();
    for (int v = part.first_vertex; v < part.first_vertex + part.vertices; ++v)
      drift += (s.state().x[static_cast<std::size_t>(v)] - s.world().assembly.x[static_cast<std::size_t>(v)]) / part.vertices;
    if (drift.head<2>().norm() > 1e-6) broken.push_back("a sheet drifted by " + to_text(drift.head<2>().norm()) + " m");
  }
}
void two_iterations(const Simulation& s, std::vector<std::string>& broken) {
  if (s.newton_max > 2) broken.push_back("took " + std::to_string(s.newton_max) + " Newton iterations");
}

/// A strip under a block of 20 g on a table, pulled out at `speed`.
Setup pulled_out(Real speed) {
  Setup setup = dropped_strip(0.05, 3, 3e-4);
  add_body(setup, "table", box_mesh(Vec3(0.3, 0.06, 0.01)), Motion::fixed, Vec3(-0.05, 0, -0.005));
  add_body(setup, "block", box_mesh(Vec3(0.02, 0.02, 0.01)), Motion::dynamic, Vec3(0.005, 0, 0.0056)).mass = 0.02;
  Grip grip;
  grip.name = "pull";
  grip.what.object = "tape";
  grip.what.vertices = {0, 1, 2, 3};
  grip.motion = {{0.05, 0.08 / speed, Vec3(-0.08, 0, 0)}};
  setup.scene.grips.push_back(grip);
  setup.scene.time.dt = std::min(0.005, 0.01 / speed);
  return setup;
}

Setup dropped_at(Real dt) {
  Setup setup = dropped_strip(0.03, 3, 0.002);
  setup.scene.time.dt = dt;
  setup.newton.velocity_tol = 1e-8 / dt;  // 10 nm left by the stop are 3e-7 of the scale of energy, m g 30 mm
  add_body(setup, "floor", box_mesh(Vec3(0.06, 0.04, 0.01)), Motion::fixed, Vec3(0, 0, -0.005));
  return setup;
}
/// At rest a flat strip lies where the barrier carries its weight: within the band above contact.
void lies_flat(const Simulation& s, std::vector<std::string>& broken) {
  for (const Vec3& p : s.state().x)
    if (std::fabs(p.z() - (vinyl().xi + vinyl().dhat)) > 1e-4) {
      broken.push_back("a vertex rests at z = " + to_text(p.z()) + " m");
      return;
    }
}

/// A block of `mass` kg on a strip of 0.13 g.
Setup heavy_on_light(Real mass) {
  Setup setup = dropped_strip(0.03, 3, 3e-4);
  add_body(setup, "floor", box_mesh(Vec3(0.1, 0.06, 0.01)), Motion::fixed, Vec3(0, 0, -0.005));
  add_body(setup, "block", box_mesh(Vec3(0.01, 0.01, 0.01)), Motion::dynamic, Vec3(0, 0, 0.0056)).mass = mass;
  return setup;
}
/// A long bar that tips over the edge of a table with a strip caught under its end.
Setup lever() {
  Setup setup = dropped_strip(0.03, 3, 3e-4);
  add_body(setup, "table", box_mesh(Vec3(0.1, 0.06, 0.01)), Motion::fixed, Vec3(0, 0, -0.005));
  add_body(setup, "bar", box_mesh(Vec3(0.2, 0.01, 0.005)), Motion::dynamic, Vec3(0.07, 0, 0.0031)).mass = 0.1;
  return setup;
}
/// A small block at radius r on a disc that turns at a rate where w^2 r is `ratio` times mu g.
Setup turntable(Real ratio) {
  const Real radius = 0.04, mu = 0.5, rate = std::sqrt(ratio * mu * kGravity / radius);
  Setup setup;
  setup.scene.time = {.dt = 0.002, .duration = 1};
  setup.newton.velocity_tol = 1e-5;
  setup.scene.contact.dhat = 1e-4;
  set_friction(setup, mu);
  Body& disc = add_body(setup, "disc", cylinder_mesh(0.1, 0.01, 48, 1), Motion::driven, Vec3(0, 0, -0.005));
  disc.angular_velocity = Vec3(0, 0, rate);
  Body& block = add_body(setup, "block", box_mesh(Vec3(0.006, 0.006, 0.003)), Motion::dynamic, Vec3(radius, 0, 0.00158));
  block.velocity = Vec3(0, rate * radius, 0);
  block.angular_velocity = Vec3(0, 0, rate);
  return setup;
}
Real block_radius(const Simulation& s) { return s.state().bodies[1].pose.position.head<2>().norm(); }
void stays(const Simulation& s, std::vector<std::string>& broken) {
  if (block_radius(s) > 0.0402) broken.push_back("slipped to r = " + to_text(block_radius(s)) + " m");
}
void slips(const Simulation& s, std::vector<std::string>& broken) {
  if (block_radius(s) < 0.041) broken.push_back("held at r = " + to_text(block_radius(s)) + " m");
}
}  // namespace

std::vector<HardCase> stack_cases() {
  std::vector<HardCase> cases = {
      {"HC6_frictionless_stack", "nothing holds three sheets in place", 1, false, [] { return frictionless_stack(6, MeshPattern::same); },
       stays_in_place},
      {"HC6_coarse_stack", "sheets that sag over their coarse cells", 1, false, [] { return frictionless_stack(3, MeshPattern::same); },
       stays_in_place},
      {"HC6_crossed_stack", "as before, on another mesh", 1, false, [] { return frictionless_stack(6, MeshPattern::crossed); },
       stays_in_place},
      {"HC6_stack_out_of_reach", "sheets a hair beyond the barrier's reach, no gravity", 0.05, false, floating_stack, two_iterations},
      {"HC20_mass_ratio_1000", "a block a thousand times as heavy as the strip under it", 0.2, false, [] { return heavy_on_light(0.13); }},
      {"HC20_mass_ratio_30000", "4 kg on a strip of 0.13 g", 0.1, false, [] { return heavy_on_light(4); }},
      {"HC20_lever", "a long bar tips about the table's edge, a strip under its short end", 0.3, false, lever},
      {"HC20_turntable_holds", "w^2 r is 0.9 mu g", 0.5, true, [] { return turntable(0.9); }, stays},
      {"HC20_turntable_slips", "w^2 r is 1.1 mu g", 0.5, true, [] { return turntable(1.1); }, slips},
  };
  for (const int speed : {1, 2, 4, 8})
    cases.push_back({"HC10_pulled_at_" + std::to_string(speed) + "_m_s", "a strip is pulled from under a block", 0.06 + 0.08 / speed, true,
                     [speed] { return pulled_out(speed); }});
  for (const auto& [name, dt, duration] : {std::tuple{"1e-4", 1e-4, 0.5}, {"1e-3", 1e-3, 0.5}, {"1e-2", 1e-2, 1.0}, {"1e-1", 1e-1, 3.0}})
    cases.push_back({std::string("HC12_dt_") + name, "drop and rest", duration, false, [dt = dt] { return dropped_at(dt); }, lies_flat});
  return cases;
}
}  // namespace tape::test
