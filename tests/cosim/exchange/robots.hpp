#pragma once
#include <memory>

#include "cosim/exchange/exchange.hpp"
#include "robot/model/primitives.hpp"
#include "tests/support/simulation.hpp"

/// Robots and worlds of the tests of the exchange.
namespace cosim::test {
using robot::RobotModel;

inline robot::Link box_link(const std::string& name, double mass, const robot::Vec3& size,
                            const robot::Vec3& centre = robot::Vec3::Zero()) {
  const robot::Vec3 s = size.cwiseAbs2();
  robot::Link link{.name = name};
  link.inertial = {mass, centre, mass / 12 * robot::Vec3(s.y() + s.z(), s.x() + s.z(), s.x() + s.y()).asDiagonal()};
  link.collision = {robot::box_shape(size, robot::Pose(Eigen::Translation3d(centre)))};
  return link;
}
inline robot::Joint joint(const std::string& name, robot::JointType type, const robot::Vec3& axis, const robot::Vec3& at) {
  robot::Joint j;
  j.name = name, j.type = type, j.axis = axis, j.X_PJ = robot::Pose(Eigen::Translation3d(at));
  return j;
}
inline RobotPart part(const std::string& name, RobotModel model, const robot::Vec3& at, bool fixed_base = true) {
  const auto joints = static_cast<Eigen::Index>(model.joints.size());
  for (std::size_t k = 0; k < model.joints.size(); ++k) model.may_overlap.emplace_back(model.joints[k].parent, static_cast<int>(k) + 1);
  RobotPart out{.name = name, .model = std::make_shared<const RobotModel>(std::move(model)), .start = robot::VecX::Zero(joints)};
  out.params.X_WB.translation() = at;
  out.params.fixed_base = fixed_base;
  return out;
}

/// One joint held at a position from the beginning.
inline RobotMotion stand(const std::string& joint, double position) {
  return {[=](const robot::VecX&) {
    return robot::JointTrajectory{.joints = {joint}, .times = {0}, .knots = {robot::VecX::Constant(1, position)}};
  }};
}

/// Both worlds of a scene, in step.
struct Coupled {
  std::unique_ptr<tape::World> world;
  tape::State state;
  std::unique_ptr<CoupledStepper> stepper;
  tape::StepReport report = {};
  Coupled(tape::Setup setup, const RobotScene& robots) {
    add_links(robots, setup.scene);
    world = std::make_unique<tape::World>(tape::World::build(std::move(setup)));
    state = tape::State::start(*world);
    stepper = std::make_unique<CoupledStepper>(robots, *world, make_stepper(tape::Backend::cpu, *world));
  }
  bool step() {
    report = stepper->step(state);
    return report.ok;
  }
  const robot::World& bullet() const { return stepper->bullet(); }
  const tape::LinkReport& link(std::size_t articulation, std::size_t l) const { return report.articulations[articulation].links[l]; }
};
}  // namespace cosim::test
