#include <numbers>

#include "cosim/roll/settled_roll.hpp"
#include "cosim/run/read_run.hpp"
#include "tape/math/rotation.hpp"
#include "tape/model/primitives.hpp"
#include "tests/hard/hard_case.hpp"

namespace tape::test {
namespace {
constexpr bool kSticky[2][2] = {{false, false}, {true, true}};  // the sticky face, to either side of what it meets

Adhesion adhesion(AdhesionLaw law) {
  Adhesion a{law, {}, {.cn = 0.675, .ct = 0.675, .beta0 = 1}, {.reach = 0.6}, {}};
  std::copy(&kSticky[0][0], &kSticky[0][0] + 4, &a.sticks[0][0]);
  return a;
}
/// A strip of 30 mm that lies on a plate of material 1, at the gap where adhesion rests.
Setup stuck(const Adhesion& how, Motion plate = Motion::fixed) {
  const Film film = vinyl();
  Setup setup = dropped_strip(0.03, 3, film.xi + 0.55 * film.dhat);
  add_body(setup, "plate", box_mesh(Vec3(0.06, 0.04, 0.01), {12, 8, 1}), plate, Vec3(0, 0, -0.005)).material = 1;
  setup.scene.materials.push_back({"steel", 0.5});
  setup.scene.adhesives = {{0, 1, how}};
  return setup;
}
/// The plate turned over: the strip hangs from it.
Setup hanging(const Adhesion& how) {
  Setup setup = stuck(how);
  setup.scene.gravity.z() = 9.81;
  return setup;
}
std::vector<int> ends(const Setup& setup, bool tip) {
  const StripMesh mesh = make_strip_mesh(setup.scene.strips[0].mesh, vinyl().width, setup.scene.seed);
  return tip ? tip_vertices(mesh, 1e-6) : root_vertices(mesh, 1e-6);
}
/// Draws an end of the strip by `way` in `time`.
void draw(Setup& setup, bool tip, const Vec3& way, Real time) {
  Grip grip = hold(tip ? "tip" : "root", ends(setup, tip));
  grip.motion = {{0, time, way}};
  setup.scene.grips.push_back(grip);
}
Setup torn(const Adhesion& how, Real speed) {
  Setup setup = stuck(how);
  draw(setup, true, Vec3(0, 0, 0.05), 0.05 / speed);
  return setup;
}
Setup pressed_bonds() {
  Setup setup = stuck(adhesion(AdhesionLaw::bond));
  Body& press = add_body(setup, "press", box_mesh(Vec3(0.05, 0.03, 0.01)), Motion::driven, Vec3(0, 0, 0.0055));
  Waypoint open{.time = 0, .pose = press.pose}, closed{.time = 0.1, .pose = press.pose};
  closed.pose.position.z() = 0.005 + 2.2e-4;  // 1.1e-4 between the faces for a film that rests at 2.9e-4
  press.waypoints = {open, closed};
  return setup;
}
/// The plate slides or turns under a strip that is held by its ends.
Setup moved_plate(const Vec3& velocity, const Vec3& spin) {
  Setup setup = stuck(adhesion(AdhesionLaw::bond), Motion::driven);
  setup.scene.bodies[0].velocity = velocity;
  setup.scene.bodies[0].angular_velocity = spin;
  draw(setup, true, Vec3::Zero(), 1);
  draw(setup, false, Vec3::Zero(), 1);
  return setup;
}
/// The plate jumps by more than the contact band in every step.
Setup shaken() {
  Setup setup = stuck(adhesion(AdhesionLaw::per_pair), Motion::driven);
  Body& plate = setup.scene.bodies[0];
  for (int k = 0; k < 40; ++k) {
    plate.waypoints.push_back({.time = 0.01 * k, .pose = plate.pose});
    plate.waypoints.back().pose.position.z() += k % 2 == 0 ? 0 : -2e-4;
  }
  return setup;
}
/// A box of two halves with tape over its seam, crushed by a fifth of its length: the seam closes from 16 to 2 mm.
Setup crushed_box(AdhesionLaw law) {
  const Film film = vinyl();
  Setup setup = dropped_strip(0.06, 3, film.xi + 0.55 * film.dhat);
  for (const auto& [name, side] : {std::pair{"left", -1}, {"right", 1}}) {
    Body& half = add_body(setup, name, box_mesh(Vec3(0.027, 0.04, 0.01), {6, 8, 1}), Motion::driven, Vec3(side * 0.0215, 0, -0.005));
    half.material = 1;
    half.waypoints = {{.time = 0, .pose = half.pose}, {.time = 0.3, .pose = half.pose}};
    half.waypoints[1].pose.position.x() -= side * 0.007;
  }
  setup.scene.materials.push_back({"board", 0.5});
  setup.scene.adhesives = {{0, 1, adhesion(law)}};
  return setup;
}
/// A strip folded on its sticky face over a loop; its ends are pressed together and let go.
Setup stuck_to_itself(AdhesionLaw law) {
  const Film film = vinyl();
  Setup setup = dropped_strip(0.07, 3, film.xi + 0.9 * film.dhat);
  Strip& strip = setup.scene.strips[0];
  strip.pose.rotation = rotation_exp(Vec3(std::numbers::pi, 0, 0));  // backing down
  strip.path = {{.length = 0.0275, .turn = 0}, {.length = 0.015, .turn = -std::numbers::pi}};
  add_body(setup, "floor", box_mesh(Vec3(0.1, 0.06, 0.01)), Motion::fixed, Vec3(0, 0, -0.005)).material = 1;
  Body& press = add_body(setup, "press", box_mesh(Vec3(0.012, 0.03, 0.01)), Motion::driven, Vec3(-0.03, 0, 0.0165));
  press.material = 1;
  for (const auto& [time, z] : {std::pair{0.0, 0.0165}, {0.2, 0.0055}, {0.4, 0.03}}) {
    press.waypoints.push_back({.time = time, .pose = press.pose});
    press.waypoints.back().pose.position.z() = z;
  }
  setup.scene.materials.push_back({"steel", 0.5});
  Adhesion self = adhesion(law);
  self.sticks[0][1] = true;
  setup.scene.adhesives = {{0, 0, self}};
  return setup;
}
void sticks(const Simulation& s, std::vector<std::string>& broken) {
  if (s.report().adhesion.empty() || s.report().adhesion[0].live == 0) broken.push_back("nothing sticks");
}
/// A roll of two turns without friction falls on a table.
Setup frictionless_roll(const std::string& model) {
  const std::string scene = "film: vinyl_19mm\ntime: {dt: 0.01, duration: 1}\nmodel: " + model + R"(
roll: {turns: 2, free_length: 0.02, position: [0, 0, 0.0225]}
bodies: {table: {shape: box, size: [0.2, 0.1, 0.01], position: [0, 0, -0.005]}}
materials: {default: {mu: 0}}
interfaces:
  - {between: [tape.sticky, tape], law: per_pair, beta0: 1}
  - {between: [tape.sticky, hub], law: per_pair, beta0: 1}
)";
  Setup setup = cosim::read_run(cosim::SceneFile::parse(scene, TAPE_SOURCE_DIR "/data/scenes/frictionless_roll.yaml")).setup;
  cosim::place_roll(cosim::settle_roll(cosim::roll_alone(setup, 0), {}), 0, setup);
  return setup;
}
Setup to(Real velocity_tol, Setup setup) {
  setup.newton.velocity_tol = velocity_tol;
  return setup;
}
Adhesion with(AdhesionLaw law, const std::function<void(Adhesion&)>& change) {
  Adhesion a = adhesion(law);
  change(a);
  return a;
}
}  // namespace

std::vector<HardCase> adhesion_cases() {
  using enum AdhesionLaw;
  const auto strong = with(per_pair, [](Adhesion& a) { a.pair.cn = a.pair.ct = 1000; });
  const auto weak = with(per_pair, [](Adhesion& a) { a.pair.cn = a.pair.ct = 1e-3, a.pair.eta = 1e-3, a.pair.work = 0; });
  const auto soft_bond = with(bond, [](Adhesion& a) { a.bond.kappa_b = 1e3; });
  const auto hard_bond = with(bond, [](Adhesion& a) { a.bond.kappa_b = 1e9; });
  const auto steep = with(per_area, [](Adhesion& a) { a.area.strength = 1e6, a.area.toughness = 50, a.area.peak = 0.01; });
  return {
      {"adhesion_strong", "a thousand newtons a pair", 0.2, false, [=] { return hanging(strong); }},
      {"adhesion_weak_and_quick", "pairs that let go within a step", 0.2, false, [=] { return hanging(weak); }},
      {"adhesion_soft_bonds", "bonds that stretch by more than their height", 0.2, false, [=] { return hanging(soft_bond); }},
      {"adhesion_hard_bonds", "bonds a thousand times as stiff", 0.2, false, [=] { return to(1e-7, hanging(hard_bond)); }},
      {"adhesion_pressed_bonds", "bonds pressed below the flip guard", 0.2, true, pressed_bonds},
      {"adhesion_sheared_bonds", "a plate slides under bonds", 0.2, true, [] { return moved_plate(Vec3(0.02, 0, 0), Vec3::Zero()); }},
      {"adhesion_twisted_bonds", "a plate turns under bonds", 0.2, true, [] { return moved_plate(Vec3::Zero(), Vec3(0, 0, 3)); }},
      {"adhesion_shaken", "pairs leave and enter the band in every step", 0.4, true, shaken},
      {"adhesion_torn_pairs", "a strip torn off at 1 m/s", 0.05, true, [] { return torn(adhesion(per_pair), 1); }},
      {"adhesion_torn_bonds", "bonds torn at 1 m/s", 0.05, true, [] { return torn(adhesion(bond), 1); }, {}, 1e-6, true},
      {"adhesion_torn_area", "a steep law by area, far from resolved, torn at 1 m/s", 0.05, true, [=] { return torn(steep, 1); }},
      {"adhesion_crushed_box", "a taped box crushed by a fifth of its length", 0.35, true, [] { return crushed_box(per_pair); }, sticks},
      {"adhesion_on_itself", "folded on its sticky face, pressed together, let go", 0.4, true, [] { return stuck_to_itself(per_pair); },
       sticks},
      {"adhesion_on_itself_area", "the same by area", 0.4, true, [] { return stuck_to_itself(per_area); }, sticks},
      {"adhesion_frictionless_roll", "nothing but cohesion holds a roll that falls", 0.2, false,
       once([] { return frictionless_roll("coh-f"); })},
      {"adhesion_frictionless_bonds", "nothing but bonds does", 0.2, false, once([] { return frictionless_roll("bond-f"); })},
  };
}
}  // namespace tape::test
