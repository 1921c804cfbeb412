#include "cosim/exchange/robots.hpp"

#include "cosim/exchange/exchange.hpp"
#include "cosim/exchange/proxy.hpp"

namespace cosim {
std::vector<robot::JointCommand> commands_at(const RobotPart& robot, double time) {
  std::vector<robot::JointCommand> commands;
  for (Eigen::Index k = 0; k < robot.start.size(); ++k)
    commands.push_back(
        {robot::JointCommand::Kind::position, robot.start[k], 0, robot.push.empty() ? 0 : robot.push[static_cast<std::size_t>(k)]});
  for (const robot::JointTrajectory& motion : robot.motions) {
    if (time < motion.start()) continue;
    const robot::JointTrajectory::Point at = motion.at(time);
    for (std::size_t k = 0; k < motion.joints.size(); ++k) {
      robot::JointCommand& command = commands[static_cast<std::size_t>(robot.model->find_joint(motion.joints[k]))];
      command.position = at.q[static_cast<Eigen::Index>(k)], command.velocity = at.v[static_cast<Eigen::Index>(k)];
    }
  }
  return commands;
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
      body.xi = part.xi;
      if (body.motion == tape::Motion::linked) articulation.links.push_back(body.name);
      scene.bodies.push_back(std::move(body));
    }
    if (!articulation.links.empty()) scene.articulations.push_back(std::move(articulation));
  }
}

robot::World make_world(const RobotScene& robots) {
  robot::World world(robots.world);
  for (const RobotPart& part : robots.robots) {
    const int r = world.add_robot(part.model, part.params);
    robot::VecX v = robot::VecX::Zero(world.dof(r));
    if (!part.params.fixed_base) v.head<3>() = part.velocity;
    world.set_state(r, {part.params.X_WB, part.start, v});
    world.command(r, commands_at(part, 0));
  }
  return world;
}
}  // namespace cosim
