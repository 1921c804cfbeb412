#include "cosim/exchange/robots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "cosim/exchange/exchange.hpp"
#include "cosim/exchange/proxy.hpp"

namespace cosim {
namespace {
constexpr double kNever = std::numeric_limits<double>::infinity();

constexpr double kDeep = 5e-3;  // [m] of two robots: `contact_erp` of it a substep is half a metre a second
constexpr double kOwn = 1e-3;   // [m] of one robot: its model does not fit together better

/// Pairs of links, each once, that stand inside each other by more than is left to Bullet to push apart; the deepest first.
std::vector<robot::Contact> deep_overlaps(const robot::World& world) {
  std::vector<robot::Contact> deep;
  for (const robot::Contact& c : world.overlaps()) {
    const auto same = [&](const robot::Contact& d) {
      return std::tie(c.robot_a, c.link_a, c.robot_b, c.link_b) == std::tie(d.robot_a, d.link_a, d.robot_b, d.link_b);
    };
    if (c.distance < -(c.robot_a == c.robot_b ? kOwn : kDeep) && std::ranges::none_of(deep, same)) deep.push_back(c);
  }
  return deep;
}

/// Links of one robot that start inside each other are left alone, as an SRDF file would ask for; of two robots they are refused.
void settle_overlaps(robot::World& world, const RobotScene& robots) {
  for (const robot::Contact& c : deep_overlaps(world)) {
    if (c.robot_a == c.robot_b) {
      world.set_contact(c.robot_a, c.link_a, c.robot_b, c.link_b, false);
      continue;
    }
    const auto& [a, b] = std::tie(robots.robots[static_cast<std::size_t>(c.robot_a)], robots.robots[static_cast<std::size_t>(c.robot_b)]);
    throw tape::InputError(fmt::format("robots: {} starts {:.1f} mm inside {} (allowed: {:.1f} mm)", body_name(a, c.link_a),
                                       -1e3 * c.distance, body_name(b, c.link_b), 1e3 * kDeep));
  }
}

/// As it stands, before anything is made of overlaps.
robot::World place(const RobotScene& robots) {
  robot::World world(robots.world);
  for (const RobotPart& part : robots.robots) {
    const int r = world.add_robot(part.model, part.params);
    robot::VecX v = robot::VecX::Zero(world.dof(r));
    if (!part.params.fixed_base) v.head<3>() = part.velocity;
    world.set_state(r, {part.params.X_WB, part.start, v});
    world.command(r, RobotScript(part, {}).commands_at(0));
  }
  return world;
}
}  // namespace

RobotScript::RobotScript(const RobotPart& robot, const std::vector<double>& events)
    : robot_(&robot), followers_(robot::joint_map(*robot.model)) {
  for (const RobotMotion& motion : robot.motions) {
    const double start = motion.start.at(events);
    if (!std::isfinite(start)) continue;
    Motion known{motion.plan(told_at(start)), motion.until < 0 ? kNever : tape::Moment(0, motion.until).at(events), {}};
    const double begin = known.way.start(), planned = known.way.end() - begin, pace = planned > 0 ? motion.duration / planned : 1;
    for (double& time : known.way.times) time = start + pace * (time - begin);
    for (const std::string& joint : known.way.joints) known.joints.push_back(robot.model->find_joint(joint));
    motions_.push_back(std::move(known));
  }
}

std::vector<robot::JointCommand> RobotScript::commands_at(double time) const {
  std::vector<robot::JointCommand> commands;
  const robot::VecX& target = robot_->target.size() > 0 ? robot_->target : robot_->start;
  for (Eigen::Index k = 0; k < target.size(); ++k)
    commands.push_back(
        {robot::JointCommand::Kind::position, target[k], 0, robot_->push.empty() ? 0 : robot_->push[static_cast<std::size_t>(k)]});
  for (const Motion& motion : motions_) {
    if (time < motion.way.start()) continue;
    const robot::JointTrajectory::Point at = motion.way.at(std::min(time, motion.until));
    for (std::size_t k = 0; k < motion.joints.size(); ++k) {
      robot::JointCommand& command = commands[static_cast<std::size_t>(motion.joints[k])];
      command.position = at.q[static_cast<Eigen::Index>(k)],
      command.velocity = time < motion.until ? at.v[static_cast<Eigen::Index>(k)] : 0;
    }
  }
  robot::VecX q(target.size()), v(target.size());
  for (Eigen::Index k = 0; k < q.size(); ++k)
    q[k] = commands[static_cast<std::size_t>(k)].position, v[k] = commands[static_cast<std::size_t>(k)].velocity;
  q = followers_.all(followers_.independent_of(q)), v = followers_.map * followers_.independent_of(v);
  for (Eigen::Index k = 0; k < q.size(); ++k)
    commands[static_cast<std::size_t>(k)].position = q[k], commands[static_cast<std::size_t>(k)].velocity = v[k];
  return commands;
}

robot::VecX RobotScript::told_at(double time) const {
  robot::VecX q(robot_->start.size());
  const std::vector<robot::JointCommand> commands = commands_at(time);
  for (std::size_t k = 0; k < commands.size(); ++k) q[static_cast<Eigen::Index>(k)] = commands[k].position;
  return q;
}

std::string body_name(const RobotPart& robot, int link) {
  return robot.name + ":" + robot.model->links[static_cast<std::size_t>(link)].name;
}

void add_links(const RobotScene& robots, tape::Scene& scene) {
  const robot::World world = make_world(robots);
  for (std::size_t r = 0; r < robots.robots.size(); ++r) {
    const RobotPart& part = robots.robots[r];
    tape::Articulation articulation{part.name, {}, coordinates(world, static_cast<int>(r))};
    for (int link = 0; link < static_cast<int>(part.model->links.size()); ++link) {
      tape::Body body;
      body.name = body_name(part, link);
      body.mesh = make_proxy(part.model->links[static_cast<std::size_t>(link)]).mesh;
      if (body.mesh.triangles.empty()) continue;
      body.motion = link == 0 && part.params.fixed_base ? tape::Motion::fixed : tape::Motion::linked;
      body.pose = to_tape(world.link_pose(static_cast<int>(r), link));
      body.material = part.material;
      body.outside = true;
      body.xi = part.xi;
      if (body.motion == tape::Motion::linked) articulation.links.push_back(body.name);
      scene.bodies.push_back(std::move(body));
    }
    if (!articulation.links.empty()) scene.articulations.push_back(std::move(articulation));
  }
}

void place_links(const RobotScene& robots, tape::Scene& scene) {
  const robot::World world = make_world(robots);
  for (std::size_t r = 0; r < robots.robots.size(); ++r)
    for (int link = 0; link < static_cast<int>(robots.robots[r].model->links.size()); ++link) {
      const auto body = std::ranges::find(scene.bodies, body_name(robots.robots[r], link), &tape::Body::name);
      if (body != scene.bodies.end()) body->pose = to_tape(world.link_pose(static_cast<int>(r), link));
    }
}

robot::World make_world(const RobotScene& robots) {
  robot::World world = place(robots);
  settle_overlaps(world, robots);
  return world;
}

std::vector<std::string> notes_on(const RobotScene& robots) {
  std::vector<std::string> notes;
  for (const RobotPart& robot : robots.robots)
    for (const std::string& note : robot.model->notes) notes.push_back(robot.name + ": " + note);
  for (const robot::Contact& c : deep_overlaps(place(robots))) {
    const RobotPart& robot = robots.robots[static_cast<std::size_t>(c.robot_a)];
    notes.push_back(
        fmt::format("{} and {} start {:.1f} mm inside each other and do not touch in this run; an SRDF file would say so for good",
                    body_name(robot, c.link_a), body_name(robot, c.link_b), -1e3 * c.distance));
  }
  return notes;
}
}  // namespace cosim
