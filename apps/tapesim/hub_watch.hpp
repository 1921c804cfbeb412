#pragma once
#include "apps/score/score.hpp"
#include "cosim/exchange/exchange.hpp"
#include "tape/step/world.hpp"

namespace tape::tapesim {
/// A body of a scene as the ring that landmarks are of: bore and height out of its mesh.
/// @throws InputError if there is no such body, or it is no ring about its z axis
class HubShape {
 public:
  HubShape(const World& world, const std::string& name);
  score::Hub at(const State& state) const;
  score::Hub at(const Pose& X_WB) const;  ///< where the body is so
  int body() const { return body_; }

 private:
  int body_;
  Vec3 offset_;  // [m] of the mesh's frame from the centre of mass
  score::Hub shape_;
};

/// What carries a camera: the world, a body, or a link or frame "robot:link".
class Mount {
 public:
  /// @param stepper  of the robots; null where there are none, or where nobody asks `at`  @throws InputError if nothing is named so
  Mount(const std::string& name, const World& world, const cosim::RobotScene& robots, const cosim::CoupledStepper* stepper);
  Pose at(const State& state) const;
  bool is_world() const { return body_ < 0 && robot_ < 0; }

 private:
  const cosim::CoupledStepper* stepper_;
  int body_ = -1, robot_ = -1, link_ = -1;
  robot::Pose X_LF_ = robot::Pose::Identity();
};

/// Notes where the hub, and the link that carries the camera, are at the start and after each step.
class HubWatch {
 public:
  HubWatch(HubShape hub, Mount mount) : hub_(std::move(hub)), mount_(std::move(mount)) {}
  void add(const State& state);
  const score::SimulatedHub& seen() const { return seen_; }

 private:
  HubShape hub_;
  Mount mount_;
  score::SimulatedHub seen_;
};
}  // namespace tape::tapesim
