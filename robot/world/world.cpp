#include "robot/world/world.hpp"

#include <fmt/format.h>

#include <cmath>

#include "robot/world/physics.hpp"

namespace robot {
namespace {
void require(bool good, const std::string& what, Real value, const char* range) {
  if (!good) throw InputError(fmt::format("world: {} = {:g} (allowed: {})", what, value, range));
}
const WorldParams& checked(const WorldParams& p) {
  require(p.gravity.allFinite(), "gravity", p.gravity.norm(), "finite [m/s^2]");
  require(p.substep >= 1e-6 && p.substep <= 0.1, "substep", p.substep, "[1e-6, 0.1] s");
  require(p.iterations >= 1, "iterations", p.iterations, ">= 1");
  require(p.contact_erp >= 0 && p.contact_erp <= 1, "contact_erp", p.contact_erp, "[0, 1]");
  require(p.limit_erp >= 0 && p.limit_erp <= 1, "limit_erp", p.limit_erp, "[0, 1]");
  return p;
}
int substeps(Real dt, Real longest) {
  constexpr Real kRoundOff = 1e-9;  // a dt that is a multiple of the substep is cut into just so many
  return std::max(1, static_cast<int>(std::ceil(dt / longest - kRoundOff)));
}
}  // namespace

struct World::Impl {
  explicit Impl(const WorldParams& p) : params(checked(p)), physics(p) {}
  DrivenRobot& at(int robot) { return *physics.robots().at(static_cast<std::size_t>(robot)); }
  WorldParams params;
  Physics physics;
  Real last_dt = 0;  // [s] of the last step; 0: none to report of
  std::vector<Contact> contacts;
};

World::World(const WorldParams& params) : impl_(std::make_unique<Impl>(params)) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

int World::add_robot(std::shared_ptr<const RobotModel> model, const RobotParams& params) {
  require(params.friction >= 0 && std::isfinite(params.friction), "friction", params.friction, ">= 0");
  impl_->physics.add(std::move(model), params);
  return robots() - 1;
}

int World::robots() const { return static_cast<int>(impl_->physics.robots().size()); }
const RobotModel& World::model(int robot) const { return impl_->at(robot).body().model(); }
int World::dof(int robot) const { return static_cast<int>(impl_->at(robot).body().dof()); }

RobotState World::state(int robot) const {
  const Articulation& body = impl_->at(robot).body();
  return {body.X_WL(0), body.q(), body.v()};
}

void World::set_state(int robot, const RobotState& state) {
  DrivenRobot& r = impl_->at(robot);
  const auto bad = [&](const char* what) { return InputError("robot " + r.body().model().name + ": a state needs " + what); };
  if (state.q.size() != r.body().joints()) throw bad("one position for each joint");
  if (state.v.size() != r.body().dof()) throw bad("one velocity for each degree of freedom");
  if (!state.q.allFinite() || !state.v.allFinite() || !state.X_WB.matrix().allFinite()) throw bad("finite numbers");
  r.body().set_base(state.X_WB);
  r.body().set_q(r.follow(state.q));
  r.body().refresh();
  r.body().set_v(r.follow_velocity(state.v));
}

void World::command(int robot, const std::vector<JointCommand>& commands) { impl_->at(robot).drives().command(commands); }

void World::set_friction(int robot, int link, Real mu) {
  require(mu >= 0 && std::isfinite(mu), "friction", mu, ">= 0");
  impl_->at(robot).set_friction(link, mu);
}

namespace {
std::pair<LinkId, LinkId> ordered(int robot_a, int link_a, int robot_b, int link_b) {
  return std::minmax(LinkId(robot_a, link_a), LinkId(robot_b, link_b));
}
}  // namespace
bool World::may_touch(int robot_a, int link_a, int robot_b, int link_b) const {
  return !impl_->physics.apart.contains(ordered(robot_a, link_a, robot_b, link_b));
}
void World::set_contact(int robot_a, int link_a, int robot_b, int link_b, bool on) {
  const std::pair<LinkId, LinkId> pair = ordered(robot_a, link_a, robot_b, link_b);
  if (on)
    impl_->physics.apart.erase(pair);
  else
    impl_->physics.apart.insert(pair);
}

void World::step(Real dt, const std::vector<VecX>& tau, const std::function<void(Real)>& before) {
  require(dt > 0 && std::isfinite(dt), "dt", dt, "> 0 s");
  if (!tau.empty() && static_cast<int>(tau.size()) != robots()) throw InputError("world: a step needs one external force for each robot");
  std::vector<VecX> forces;
  for (int robot = 0; robot < robots(); ++robot) {
    const std::size_t i = static_cast<std::size_t>(robot);
    forces.push_back(tau.empty() || tau[i].size() == 0 ? VecX::Zero(dof(robot)) : tau[i]);
    if (forces.back().size() != dof(robot) || !forces.back().allFinite())
      throw InputError("robot " + model(robot).name + ": an external force needs one finite number for each degree of freedom");
    DrivenRobot& r = impl_->at(robot);
    for (VecX* impulse : {&r.drive_impulse, &r.friction_impulse, &r.limit_impulse}) impulse->setZero();
  }
  impl_->physics.unsettled = 0;
  impl_->contacts.clear();
  const int count = substeps(dt, impl_->params.substep);
  const Real h = dt / count;
  for (int s = 0; s < count; ++s) {
    if (before) before((s + 1) * h);
    impl_->physics.substep(h, forces);
    impl_->physics.add_contacts(h, dt, impl_->contacts);
  }
  impl_->last_dt = dt;
}

Snapshot World::save() const {
  std::vector<Real> n;
  for (const auto& robot : impl_->physics.robots()) robot->save(n);
  n.push_back(static_cast<Real>(impl_->physics.apart.size()));
  for (const auto& [a, b] : impl_->physics.apart)
    for (const int i : {a.first, a.second, b.first, b.second}) n.push_back(i);
  return {n};
}

void World::restore(const Snapshot& snapshot) {
  std::size_t expected = 0;
  for (const auto& robot : impl_->physics.robots()) expected += robot->saved_size();
  const std::size_t size = snapshot.numbers.size();
  if (size < expected + 1 || size != expected + 1 + 4 * static_cast<std::size_t>(snapshot.numbers[expected]))
    throw InputError(fmt::format("world: a snapshot of {} numbers is not one of these robots", size));
  const Real* n = snapshot.numbers.data();
  for (const auto& robot : impl_->physics.robots()) robot->restore(n);
  impl_->physics.apart.clear();
  for (std::size_t pairs = static_cast<std::size_t>(*n++); pairs > 0; --pairs, n += 4) {
    const auto i = [n](int k) { return static_cast<int>(n[k]); };
    impl_->physics.apart.insert({{i(0), i(1)}, {i(2), i(3)}});
  }
  impl_->last_dt = 0;
  impl_->contacts.clear();
  impl_->physics.unsettled = 0;
}

Pose World::link_pose(int robot, int link) const { return impl_->at(robot).body().X_WL(link); }

MatX World::jacobian(int robot, int link) const {
  const Pose X_WL = link_pose(robot, link);
  return impl_->at(robot).body().jacobian(link, X_WL.translation());
}

VecX World::link_velocity(int robot, int link) const { return jacobian(robot, link) * impl_->at(robot).body().v(); }
MatX World::mass_matrix(int robot) const { return impl_->at(robot).body().mass_matrix(); }
VecX World::generalized_momentum(int robot) const { return mass_matrix(robot) * impl_->at(robot).body().v(); }

VecX World::acceleration(int robot, const VecX& tau) const {
  DrivenRobot& r = impl_->at(robot);
  std::vector<Real> before;
  r.body().save(before);  // Bullet's algorithm reads the velocity from the body
  VecX a = r.body().acceleration(r.body().v(), tau, impl_->params.gravity);
  const Real* n = before.data();
  r.body().restore(n);
  return a;
}

MatX World::motions(int robot) const { return impl_->at(robot).motions(); }
MatX World::response(int robot, Real dt, bool drives) const {
  const int count = substeps(dt, impl_->params.substep);
  return impl_->at(robot).response(dt / count, count, drives);
}

VecX World::drive_effort(int robot) const {
  const VecX& impulse = impl_->at(robot).drive_impulse;
  return impl_->last_dt > 0 ? VecX(impulse / impl_->last_dt) : VecX::Zero(impulse.size());
}
std::vector<JointHold> World::holds(int robot) const {
  const DrivenRobot& r = impl_->at(robot);
  return impl_->last_dt > 0 ? r.holds(impl_->last_dt)
                            : std::vector<JointHold>(static_cast<std::size_t>(r.motions().cols() - r.body().base_dof()));
}
VecX World::effort_limit(int robot) const { return impl_->at(robot).drives().limits(); }
std::vector<int> World::saturation(int robot) const { return impl_->at(robot).drives().saturation(); }
std::vector<Contact> World::contacts() const { return impl_->contacts; }
std::vector<Contact> World::overlaps() const { return impl_->physics.overlaps(); }
int World::unsettled_substeps() const { return impl_->physics.unsettled; }
}  // namespace robot
