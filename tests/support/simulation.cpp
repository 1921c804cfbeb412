#include "tests/support/simulation.hpp"

#include <cmath>

#include "tape/contact/intersection.hpp"

namespace tape::test {
Simulation::Simulation(Setup setup, Backend backend)
    : world_(std::make_unique<World>(World::build(std::move(setup)))),
      state_(State::start(*world_)),
      stepper_(make_stepper(backend, *world_)) {}

const StepReport& Simulation::step() {
  report_ = stepper_->step(state_, exchange);
  const auto note = [&](const std::string& what) { broken.push_back("step " + std::to_string(state_.step) + ": " + what); };
  newton_max = std::max(newton_max, report_.newton);
  newton_sum += report_.newton;
  min_gap = std::min(min_gap, report_.min_gap);
  if (!report_.ok) note(report_.failure);
  if (report_.linear_failures > 0) note("a linear solve ended at its iteration limit");
  if (report_.ccd_capped > 0 && !may_reach_limits)
    note("the CCD of " + std::to_string(report_.ccd_capped) + " pairs ended at its iteration limit");
  if (report_.substeps > 1 && !may_reach_limits)
    note("Newton's method reached a limit; taken in " + std::to_string(report_.substeps) + " parts");
  ccd_capped += report_.ccd_capped;
  retried += report_.substeps > 1 ? 1 : 0;
  if (!(report_.min_gap > 0)) note("gap " + to_text(report_.min_gap) + " m");
  const std::vector<Vec3> now = x();
  for (const Vec3& p : now)
    if (!p.allFinite()) {
      note("a position is not finite");
      return report_;
    }
  if (check_intersections && find_intersections(world_->surface, now).count > 0) note("surfaces intersect");
  if (report_.ok) cut(report_.blades);
  return report_;
}

void Simulation::cut(const std::vector<BladePressure>& pressures) {
  cuts_ = cut_strips(*world_, state_, pressures);
  for (const CutReport& cut : cuts_)
    if (cut.refusal.empty()) stepper_->renew(state_);
}

void Simulation::resume(const std::string& file) {
  state_ = load_snapshot(file, *world_);
  *world_ = world_->with(state_.remnants);
  stepper_->renew(state_);
}

void Simulation::run_to(Real time, const std::function<void(const Simulation&)>& each) {
  while (state_.time < time - 1e-9 && (broken.empty() || report_.ok)) {
    step();
    if (each) each(*this);
  }
}

Real Simulation::energy() const {
  Real sum = report_.kinetic;
  for (const EffectReport& e : report_.effects) sum += e.energy;
  return sum;
}

Real Simulation::energy_scale() const {
  Eigen::AlignedBox<Real, 3> box;
  Real mass = 0;
  for (std::size_t v = 0; v < world_->assembly.x.size(); ++v) {
    mass += world_->assembly.mass[v];
    if (world_->assembly.owner[v].block >= 0) box.extend(world_->assembly.x[v]);
  }
  Real sum = report_.kinetic + mass * world_->setup.scene.gravity.norm() * box.diagonal().norm();
  for (const EffectReport& e : report_.effects) sum += std::fabs(e.energy);
  return sum;
}

Film vinyl() { return {.name = "vinyl_19mm"}; }
Film packaging_film() {
  return {.name = "packaging_48mm",
          .width = 0.048,
          .thickness = 8e-5,
          .density = 924,
          .membrane_modulus = 2.2e9,
          .bending_modulus = 2.2e9,
          .poisson = 0.42,
          .xi = 2e-5,
          .dhat = 8e-5};
}

Strip flat_strip(Real length, int cells, const Vec3& start) {
  Strip strip;
  strip.mesh = {.length = length, .cells_across = cells};
  strip.pose.position = start;
  return strip;
}

Setup strip_setup(const Strip& strip) {
  Setup setup;
  setup.scene.films = {vinyl()};
  setup.scene.strips = {strip};
  setup.scene.time = {.dt = 0.01, .duration = 1};
  setup.newton.velocity_tol = 1e-3;
  return setup;
}

Body& add_body(Setup& setup, const std::string& name, TriangleMesh mesh, Motion motion, const Vec3& position) {
  Body body;
  body.name = name;
  body.mesh = std::move(mesh);
  body.motion = motion;
  body.pose.position = position;
  return setup.scene.bodies.emplace_back(std::move(body));
}

Grip hold(const std::string& name, std::vector<int> vertices) {
  Grip grip;
  grip.name = name;
  grip.what = {.object = "tape", .vertices = std::move(vertices), .points = {}};
  return grip;
}
}  // namespace tape::test
