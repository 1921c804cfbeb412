#include "cosim/exchange/robots.hpp"

#include "cosim/exchange/exchange.hpp"
#include "cosim/exchange/proxy.hpp"

namespace cosim {
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
    world.command(r, part.commands);
  }
  return world;
}
}  // namespace cosim
