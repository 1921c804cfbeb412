#include "cosim/exchange/robots.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cosim/exchange/exchange.hpp"
#include "cosim/exchange/proxy.hpp"

namespace cosim {
namespace {
constexpr double kNever = std::numeric_limits<double>::infinity();
}
RobotScript::RobotScript(const RobotPart& robot, const std::vector<double>& events) : robot_(&robot) {
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
}  // namespace cosim
