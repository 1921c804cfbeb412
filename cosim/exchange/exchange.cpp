#include "cosim/exchange/exchange.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "robot/kinematics/joint_map.hpp"
#include "tape/core/error.hpp"
#include "tape/core/stopwatch.hpp"

namespace cosim {
namespace {
using Eigen::MatrixXd;
using Eigen::VectorXd;
using robot::RobotState;
using robot::Vec3;

constexpr double kBare = 0.5;            // of the bare robot's inertia, that limited drives leave at least
constexpr double kHold = 1e5;            // times the bare robot's inertia: as stiff as what friction, a limit or a contact holds
constexpr double kCommandPeriod = 0.01;  // [s] at most from one command to the next
constexpr double kHeavy = 1e6;           // times the inertia: a link that feels nothing
/// [N/m] of the hold that closes the gap between the two worlds, as stiff as that of driven bodies.
constexpr double kClosing = 1e9;

/// Change of a pose over a step: translation of the origin and rotation vector, in the world.
VectorXd twist(const tape::Pose& from, const robot::Pose& to) {
  const Eigen::AngleAxisd turn(robot::Mat3(to.linear() * from.rotation.transpose()));
  VectorXd out(6);
  out << to.translation() - from.position, turn.angle() * turn.axis();
  return out;
}

/// How far a robot came, by its velocities' coordinates.
VectorXd change(const RobotState& from, const RobotState& to, bool free_base) {
  VectorXd joints = to.q - from.q;
  if (!free_base) return joints;
  VectorXd out(6 + joints.size());
  out << twist({from.X_WB.linear(), from.X_WB.translation()}, to.X_WB), joints;
  return out;
}

VectorXd wrench_of(const tape::LinkReport& link) {
  VectorXd sum = VectorXd::Zero(6);
  for (const tape::Wrench* w : {&link.normal, &link.friction, &link.adhesion, &link.hold}) {
    sum.head<3>() += w->force;
    sum.tail<3>() += w->torque;
  }
  return sum;
}
}  // namespace

int coordinates(const robot::World& world, int robot) { return static_cast<int>(world.motions(robot).cols()) + 1; }

tape::Pose to_tape(const robot::Pose& pose) { return {pose.linear(), pose.translation()}; }

CoupledStepper::CoupledStepper(const RobotScene& robots, const tape::World& world, std::unique_ptr<tape::Stepper> tape)
    : robots_(robots), world_(world), tape_(std::move(tape)), bullet_(make_world(robots)), pinching_(robots, world, bullet_) {
  const tape::Scene& scene = world.setup.scene;
  for (const tape::Articulation& articulation : scene.articulations) {
    const auto named = [&](const RobotPart& part) { return part.name == articulation.name; };
    const auto found = std::ranges::find_if(robots_.robots, named);
    TAPE_CHECK(found != robots_.robots.end());
    Part part{static_cast<int>(found - robots_.robots.begin()), {}, {}, robot::joint_map(*found->model).independent};
    for (int link = 0; link < static_cast<int>(found->model->links.size()); ++link) {
      const auto body = std::ranges::find(scene.bodies, body_name(*found, link), &tape::Body::name);
      if (body == scene.bodies.end() || body->motion != tape::Motion::linked) continue;
      part.links.push_back(link);
      part.bodies.push_back(static_cast<int>(body - scene.bodies.begin()));
    }
    parts_.push_back(std::move(part));
  }
  start_ = bullet_.save();
}

/// Takes out of the inertia what it owes to drives that have limits: on the diagonal, as each works on its own joint, and so much that what
/// is left is not less than the bare robot's.
/// @param held  joints that something else holds (`add_holds`)
void CoupledStepper::add_drives(const Part& part, const MatrixXd& bare, const std::vector<bool>& held, tape::ArticulationStep& step) const {
  const Eigen::Index n = bare.rows();
  const VectorXd limit = bullet_.effort_limit(part.robot), effort = bullet_.drive_effort(part.robot);
  const MatrixXd driven = step.inertia.topLeftCorner(n, n);
  std::vector<tape::LimitedSpring> drives;
  VectorXd diagonal = VectorXd::Zero(n);
  for (Eigen::Index k = n - std::ssize(part.independent), u = 0; k < n; ++k, ++u) {
    const int joint = part.independent[static_cast<std::size_t>(u)];
    if (held[static_cast<std::size_t>(u)] || !std::isfinite(limit[joint]) || driven(k, k) <= bare(k, k)) continue;
    diagonal[k] = driven(k, k) - bare(k, k);
    drives.push_back({VectorXd::Unit(n + 1, k), diagonal[k], effort[joint] - limit[joint], effort[joint] + limit[joint]});
  }
  for (const double share : {1.0, 0.9, 0.7, 0.5}) {
    const MatrixXd left = driven - MatrixXd(share * diagonal.asDiagonal());
    if ((left - kBare * bare).llt().info() != Eigen::Success) continue;
    step.inertia.topLeftCorner(n, n) = left;
    for (tape::LimitedSpring& drive : drives) drive.stiffness *= share;
    step.springs.insert(step.springs.end(), drives.begin(), drives.end());
    return;
  }
}

/// Gives joints that stick, or stand at a limit, what holds them, as stiff as kHold times the bare robot. Of a joint that sticks and has a
/// drive with limits, the stiffer drive matters.
/// @return [independent joints] whether they are held
std::vector<bool> CoupledStepper::add_holds(const Part& part, const MatrixXd& bare, tape::ArticulationStep& step) const {
  const std::vector<robot::JointHold> holds = bullet_.holds(part.robot);
  const VectorXd limit = bullet_.effort_limit(part.robot);
  std::vector<bool> held;
  for (Eigen::Index k = bare.rows() - std::ssize(part.independent), u = 0; k < bare.rows(); ++k, ++u) {
    const robot::JointHold& hold = holds[static_cast<std::size_t>(u)];
    const bool driven = std::isfinite(limit[part.independent[static_cast<std::size_t>(u)]]) && step.inertia(k, k) > 2 * bare(k, k);
    held.push_back(hold.least < hold.most && (hold.stopped || !driven));
    if (!held.back()) continue;
    step.springs.push_back({VectorXd::Unit(bare.rows() + 1, k), kHold * bare(k, k), hold.effort - hold.most, hold.effort - hold.least});
  }
  return held;
}

/// S of the independent motions: change of coordinates over dt by a force held over it.
MatrixXd CoupledStepper::independent_response(int robot, double dt, bool drives) const {
  const auto inverse = bullet_.motions(robot).completeOrthogonalDecomposition();
  return inverse.solve(inverse.solve(bullet_.response(robot, dt, drives)).transpose());
}

/// [3, independent motions] of a point of a link.
MatrixXd CoupledStepper::point_motion(int robot, int link, const Vec3& point) const {
  const MatrixXd J = bullet_.jacobian(robot, link);
  const Vec3 arm = point - bullet_.link_pose(robot, link).translation();
  MatrixXd of_point = J.topRows(3);
  for (Eigen::Index k = 0; k < J.cols(); ++k) of_point.col(k) += Vec3(J.col(k).tail<3>()).cross(arm);
  return of_point * bullet_.motions(robot);
}

/// Gives a robot what its contacts in Bullet hold it by: across a contact no motion inwards, and outwards up to the force that presses;
/// along one that sticks, up to its friction. A link of the same robot goes along as the coordinates say; another robot's gives way as that
/// robot alone would.
void CoupledStepper::add_contacts(const Part& part, double dt, const MatrixXd& bare, tape::ArticulationStep& step) const {
  constexpr double kAny = std::numeric_limits<double>::infinity(), kSticks = 0.99, kFelt = 1e-9;
  const Eigen::LLT<MatrixXd> bare_llt(bare);
  for (const robot::Contact& c : bullet_.contacts()) {
    MatrixXd motion = MatrixXd::Zero(3, bare.rows());
    robot::Mat3 give = robot::Mat3::Zero();  // of the other robot
    const auto add_side = [&](int robot, int link, double sign) {
      if (bullet_.dof(robot) == 0) return;
      const MatrixXd J = point_motion(robot, link, c.point);
      if (robot == part.robot)
        motion += sign * J;
      else
        give += J * independent_response(robot, dt, true) * J.transpose() / (dt * dt);
    };
    if (c.robot_a != part.robot && c.robot_b != part.robot) continue;
    add_side(c.robot_a, c.link_a, 1), add_side(c.robot_b, c.link_b, -1);
    const auto hold = [&](const Vec3& direction, double least, double most) {
      VectorXd along = VectorXd::Zero(bare.rows() + 1);
      along.head(bare.rows()) = motion.transpose() * direction;
      if (along.norm() < kFelt) return;
      const double own = along.head(bare.rows()).dot(bare_llt.solve(along.head(bare.rows())));
      step.springs.push_back({along, 1 / (own / kHold + direction.dot(give * direction)), least, most});
    };
    const double pressed = c.force.dot(c.normal), friction = c.mu * pressed;
    if (pressed <= 0) continue;
    hold(c.normal, -kAny, pressed);
    if ((c.force - pressed * c.normal).norm() > kSticks * friction) continue;
    const Vec3 across = c.normal.unitOrthogonal();
    for (const Vec3& t : {across, Vec3(c.normal.cross(across))}) hold(t, c.force.dot(t) - friction, c.force.dot(t) + friction);
  }
}

/// What Bullet, which has just made the step under a load, says of a robot: where it would be without the load is taken from how it gives
/// way to it now. A drive that stands at its limit under the load might not if the robot were let go.
tape::ArticulationStep CoupledStepper::predicted(const Part& part, const tape::State& state, const RobotState& before, double dt,
                                                 const VectorXd& load) const {
  const MatrixXd T = bullet_.motions(part.robot);
  const Eigen::Index n = T.cols(), dof = T.rows();
  tape::ArticulationStep step;
  step.predicted = VectorXd(n + 1), step.inertia = MatrixXd::Zero(n + 1, n + 1);
  step.predicted.head(n) = T.completeOrthogonalDecomposition().solve(change(before, bullet_.state(part.robot), dof > before.q.size()));
  step.predicted[n] = 1;
  const VectorXd loaded = step.predicted.head(n);
  auto unloaded = step.predicted.head(n);
  const auto inertia = [&](bool drives) -> MatrixXd {
    const MatrixXd full = dt * dt * independent_response(part.robot, dt, drives).llt().solve(MatrixXd::Identity(n, n));
    return (full + full.transpose()) / 2;
  };
  step.inertia.topLeftCorner(n, n) = inertia(true);
  if (robots_.exchange.schedule == Schedule::inertial) {
    const MatrixXd bare = inertia(false);
    const std::vector<bool> held = add_holds(part, bare, step);
    add_contacts(part, dt, bare, step);
    MatrixXd whole = step.inertia.topLeftCorner(n, n);
    for (const tape::LimitedSpring& s : step.springs) whole += s.stiffness * s.along.head(n) * s.along.head(n).transpose();
    const VectorXd given = dt * dt * whole.llt().solve(T.transpose() * load);
    add_drives(part, bare, held, step);
    for (tape::LimitedSpring& s : step.springs) {  // what the load has added to them
      const double by_load = s.stiffness * s.along.head(n).dot(given) / (dt * dt);
      s.least += by_load, s.most += by_load;
    }
    unloaded -= given;
  } else {
    step.inertia *= kHeavy;
  }
  double gap2 = 0;
  for (std::size_t l = 0; l < part.links.size(); ++l) {
    const tape::Pose& now = state.bodies[static_cast<std::size_t>(part.bodies[l])].pose;
    MatrixXd J(6, n + 1);
    J.leftCols(n) = bullet_.jacobian(part.robot, part.links[l]) * T;
    J.col(n) = twist(now, bullet_.link_pose(part.robot, part.links[l])) - J.leftCols(n) * loaded;
    gap2 = std::max(gap2, J.col(n).squaredNorm());
    step.jacobian.push_back(std::move(J));
  }
  step.inertia(n, n) = gap2 > 0 ? dt * dt * kClosing * gap2 : 1;
  return step;
}

/// External forces [robots][dof] from what the tape side exerts on the links.
std::vector<robot::VecX> CoupledStepper::forces(const tape::StepReport& report) const {
  std::vector<robot::VecX> tau;
  for (int r = 0; r < bullet_.robots(); ++r) tau.push_back(VectorXd::Zero(bullet_.dof(r)));
  for (std::size_t a = 0; a < parts_.size(); ++a) {
    VectorXd& sum = tau[static_cast<std::size_t>(parts_[a].robot)];
    for (std::size_t l = 0; l < parts_[a].links.size(); ++l)
      sum += bullet_.jacobian(parts_[a].robot, parts_[a].links[l]).transpose() * wrench_of(report.articulations[a].links[l]);
  }
  return tau;
}

tape::StepReport CoupledStepper::step(tape::State& state, const tape::Exchange&) {
  double whole = 0;
  tape::StepReport report;
  {
    const tape::Stopwatch watch(whole);
    report = step_both(state);
  }
  report.stages.push_back({"bullet", report_.bullet_ms});
  report.stages.push_back({"exchange", whole - report_.bullet_ms - report_.tape_ms});
  report.wall_ms = whole;
  report.exchange_residual = report_.residual;
  report.unsettled_substeps = bullet_.unsettled_substeps();
  report.link_mismatch = report_.mismatch;
  return report;
}

tape::StepReport CoupledStepper::step_both(tape::State& state) {
  const double dt = world_.setup.scene.time.dt;
  report_ = {};
  standing_.reset();  // wherever a step that fails leaves Bullet
  restore(state);
  see_to_pinching(state);
  follow_script(state);
  const robot::Snapshot start = bullet_.save();
  tape::State next = state;
  tape::StepReport report = robots_.exchange.schedule == Schedule::iterated ? step_in_turns(next, dt, start) : step_once(next, dt, start);
  if (!report.ok) return report;
  next.outside = bullet_.save().numbers;
  for (const VectorXd& of : load_) next.outside.insert(next.outside.end(), of.begin(), of.end());
  exerted_ = report.articulations;
  state = std::move(next);
  standing_ = state.outside;
  note_mismatch(state);
  return report;
}

/// Whether its base is a fixed body there.
bool CoupledStepper::rests_on_tape_side(const RobotPart& robot) const {
  const auto& bodies = world_.setup.scene.bodies;
  const auto base = std::ranges::find(bodies, body_name(robot, 0), &tape::Body::name);
  return base != bodies.end() && base->motion == tape::Motion::fixed;
}

/// Does nothing where the last step has led to this state.
void CoupledStepper::stand_at(const tape::State& state) {
  if (standing_ == state.outside) return;
  restore(state);
  follow_script(state);
  time_ = state.step * world_.setup.scene.time.dt;
  exerted_.clear();
  standing_ = state.outside;
}

std::vector<RobotRecord> CoupledStepper::records(const tape::State& state) {
  stand_at(state);
  std::vector<RobotRecord> records;
  for (int r = 0; r < bullet_.robots(); ++r) {
    const RobotPart& robot = robots_.robots[static_cast<std::size_t>(r)];
    const RobotState at = bullet_.state(r);
    const auto links = robot.model->links.size();
    RobotRecord record{at.q, at.v.tail(at.q.size()), scripts_[static_cast<std::size_t>(r)].told_at(time_), bullet_.drive_effort(r), {}};
    for (std::size_t l = 0; l < links; ++l) record.links.push_back(bullet_.link_pose(r, static_cast<int>(l)));
    record.wrench.assign(links, Eigen::Matrix<double, 6, 1>::Zero());
    if (rests_on_tape_side(robot)) record.wrench[0].setConstant(std::numeric_limits<double>::quiet_NaN());
    records.push_back(std::move(record));
  }
  for (std::size_t a = 0; a < exerted_.size(); ++a)
    for (std::size_t l = 0; l < parts_[a].links.size(); ++l)
      records[static_cast<std::size_t>(parts_[a].robot)].wrench[static_cast<std::size_t>(parts_[a].links[l])] =
          wrench_of(exerted_[a].links[l]);
  return records;
}

JointPositions CoupledStepper::joints() const {
  JointPositions q;
  for (int r = 0; r < bullet_.robots(); ++r) q.push_back(bullet_.state(r).q);
  return q;
}

void CoupledStepper::restore(const tape::State& state) {
  load_.clear();
  for (int r = 0; r < bullet_.robots(); ++r) load_.push_back(VectorXd::Zero(bullet_.dof(r)));
  if (state.outside.empty()) return bullet_.restore(start_);
  std::vector<double> numbers = state.outside;
  for (auto of = load_.rbegin(); of != load_.rend(); ++of) {
    const auto size = static_cast<std::size_t>(of->size());
    if (numbers.size() < size) break;
    *of = Eigen::Map<const VectorXd>(numbers.data() + numbers.size() - size, of->size());
    numbers.resize(numbers.size() - size);
  }
  try {
    bullet_.restore({numbers});
  } catch (const robot::InputError& e) {
    throw tape::InputError(std::string("the state holds other robots than the scene: ") + e.what());
  }
}

void CoupledStepper::follow_script(const tape::State& state) {
  if (scripts_.empty() || events_ != state.events) {
    scripts_.clear();
    for (const RobotPart& robot : robots_.robots) scripts_.emplace_back(robot, state.events);
    events_ = state.events;
  }
  time_ = (state.step + 1) * world_.setup.scene.time.dt;
}

/// Pairs that may have tape between them touch on the tape side, all others in Bullet.
void CoupledStepper::see_to_pinching(const tape::State& state) {
  const std::vector<LinkPair> pairs = pinching_.find(state, bullet_);
  for (const LinkPair& p : pinching_.candidates()) bullet_.set_contact(p.robot_a, p.link_a, p.robot_b, p.link_b, true);
  pinched_.clear();
  for (const LinkPair& p : pairs) {
    bullet_.set_contact(p.robot_a, p.link_a, p.robot_b, p.link_b, false);
    pinched_.push_back(p.bodies);
  }
  report_.pinching = static_cast<int>(pinched_.size());
}

/// The drives are told where to be at the end of the step; where that is far off, at the end of each of its parts.
void CoupledStepper::advance_bullet(const robot::Snapshot& start, double dt, const std::vector<robot::VecX>& tau) {
  constexpr double kRoundOff = 1e-9;
  const tape::Stopwatch watch(report_.bullet_ms);
  bullet_.restore(start);
  const int parts = static_cast<int>(std::ceil(dt / kCommandPeriod - kRoundOff));
  int told = 0;
  bullet_.step(dt, tau, [&](double end) {
    const int part = static_cast<int>(std::ceil(parts * end / dt - kRoundOff));
    if (part == told) return;
    told = part;
    const double time = time_ - dt * (parts - part) / parts;
    for (std::size_t r = 0; r < scripts_.size(); ++r) bullet_.command(static_cast<int>(r), scripts_[r].commands_at(time));
  });
}

/// Sets the joints to where they are told to be at the end of the step.
void CoupledStepper::pose_bullet(double dt) {
  const tape::Stopwatch watch(report_.bullet_ms);
  for (int r = 0; r < bullet_.robots(); ++r) {
    const RobotState before = bullet_.state(r);
    const VectorXd q = scripts_[static_cast<std::size_t>(r)].told_at(time_);
    bullet_.set_state(r, {before.X_WB, q, (q - before.q) / dt});
  }
}

std::vector<RobotState> CoupledStepper::robot_states() const {
  std::vector<RobotState> out;
  for (int r = 0; r < bullet_.robots(); ++r) out.push_back(bullet_.state(r));
  return out;
}

tape::StepReport CoupledStepper::step_once(tape::State& state, double dt, const robot::Snapshot& start) {
  const std::vector<RobotState> before = robot_states();
  const Schedule schedule = robots_.exchange.schedule;
  if (schedule == Schedule::posed)
    pose_bullet(dt);
  else
    advance_bullet(start, dt, load_);
  tape::Exchange exchange{.articulations = {}, .pinching = pinched_};
  for (const Part& part : parts_) {
    const auto robot = static_cast<std::size_t>(part.robot);
    exchange.articulations.push_back(predicted(part, state, before[robot], dt, load_[robot]));
  }
  std::vector<robot::Vec3> loaded = momenta();
  tape::StepReport report = tape_->step(state, exchange);
  report_.tape_ms += report.wall_ms;
  if (!report.ok || schedule == Schedule::kinematic || schedule == Schedule::posed) return report;
  const std::vector<robot::VecX> tau = forces(report);
  if (tau != load_) advance_bullet(start, dt, tau);  // else it has made the step already
  book_momentum(report, loaded, dt);
  load_ = tau;
  return report;
}

/// Gauss-Seidel: the tape against links that go their way, then Bullet under what that exerts, with Aitken's relaxation of the forces.
tape::StepReport CoupledStepper::step_in_turns(tape::State& state, double dt, const robot::Snapshot& start) {
  const std::vector<RobotState> before = robot_states();
  const tape::State first = state;
  std::vector<robot::VecX> tau, last_residual;
  double relaxation = 1;
  tape::StepReport report;
  for (int turn = 1; turn <= robots_.exchange.iterations; ++turn) {
    report_.iterations = turn;
    advance_bullet(start, dt, tau);
    state = first;
    tape::Exchange exchange{.articulations = {}, .pinching = pinched_};
    for (const Part& part : parts_)
      exchange.articulations.push_back(predicted(part, state, before[static_cast<std::size_t>(part.robot)], dt, {}));
    report = tape_->step(state, exchange);
    report_.tape_ms += report.wall_ms;
    if (!report.ok) return report;
    std::vector<robot::VecX> residual = forces(report);
    double size = 0, left = 0, along = 0, change2 = 0;
    for (std::size_t r = 0; r < residual.size(); ++r) {
      if (residual[r].size() == 0) continue;
      size += residual[r].squaredNorm();
      if (!tau.empty()) residual[r] -= tau[r];
      left += residual[r].squaredNorm();
      if (last_residual.empty()) continue;
      const VectorXd difference = residual[r] - last_residual[r];
      along += last_residual[r].dot(difference), change2 += difference.squaredNorm();
    }
    if (left <= robots_.exchange.tolerance * robots_.exchange.tolerance * size) return report;
    if (change2 > 0) relaxation *= -along / change2;
    if (tau.empty()) {
      tau = residual;
    } else {
      for (std::size_t r = 0; r < tau.size(); ++r) tau[r] += relaxation * residual[r];
    }
    last_residual = std::move(residual);
  }
  report.ok = false;
  report.failure = "the worlds did not agree in " + std::to_string(robots_.exchange.iterations) + " turns (exchange.iterations)";
  return report;
}

/// Linear momentum of each robot with a free base.
std::vector<robot::Vec3> CoupledStepper::momenta() const {
  std::vector<robot::Vec3> out;
  for (const Part& part : parts_) {
    const bool free = !robots_.robots[static_cast<std::size_t>(part.robot)].params.fixed_base;
    out.push_back(free ? robot::Vec3(bullet_.generalized_momentum(part.robot).head<3>()) : robot::Vec3(robot::Vec3::Zero()));
  }
  return out;
}

void CoupledStepper::book_momentum(const tape::StepReport& report, const std::vector<robot::Vec3>& loaded, double dt) {
  const std::vector<robot::Vec3> now = momenta();
  double given = 0, lost = 0;
  for (std::size_t a = 0; a < parts_.size(); ++a) {
    robot::Vec3 force = robot::Vec3::Zero();
    for (const tape::LinkReport& link : report.articulations[a].links) {
      force += wrench_of(link).head<3>();
      report_.momentum_given += dt * wrench_of(link).head<3>().norm();
    }
    if (robots_.robots[static_cast<std::size_t>(parts_[a].robot)].params.fixed_base) continue;
    given += dt * force.norm();
    const robot::Vec3 before = load_[static_cast<std::size_t>(parts_[a].robot)].head<3>();
    lost += (now[a] - loaded[a] - dt * (force - before)).norm();
  }
  if (given > 0) report_.residual = lost / given;
}

void CoupledStepper::note_mismatch(const tape::State& state) {
  for (const Part& part : parts_) {
    for (std::size_t l = 0; l < part.links.size(); ++l) {
      const auto body = static_cast<std::size_t>(part.bodies[l]);
      const robot::Pose& there = bullet_.link_pose(part.robot, part.links[l]);
      for (const tape::Vec3& p : world_.setup.scene.bodies[body].mesh.vertices)
        report_.mismatch = std::max(report_.mismatch, (tape::apply(state.bodies[body].pose, p) - there * p).norm());
    }
  }
}

std::unique_ptr<tape::Stepper> make_stepper(tape::Backend backend, const tape::World& world, const RobotScene& robots) {
  std::unique_ptr<tape::Stepper> tape = tape::make_stepper(backend, world);
  if (robots.robots.empty()) return tape;
  return std::make_unique<CoupledStepper>(robots, world, std::move(tape));
}
}  // namespace cosim
