#pragma once
#include <set>
#include <utility>

#include "robot/world/driven_robot.hpp"

namespace robot {
/// What names a link in the world: robot and link.
using LinkId = std::pair<int, int>;

/// Bullet's world of articulations, with what is ours in a substep (README.md): drives and contacts see each other, and nothing is
/// remembered from one substep to the next but configuration, velocity and the drives' active sets.
class Physics {
 public:
  explicit Physics(const WorldParams& params);
  ~Physics();
  DrivenRobot& add(const std::shared_ptr<const RobotModel>& model, const RobotParams& params);
  void substep(Real h, const std::vector<VecX>& tau);

  std::vector<std::unique_ptr<DrivenRobot>>& robots() { return robots_; }
  const std::vector<std::unique_ptr<DrivenRobot>>& robots() const { return robots_; }
  /// Pairs of links that never touch, each sorted.
  std::set<std::pair<LinkId, LinkId>> apart;
  /// Adds the contacts of the last substep, of length h, to those of a step of length dt.
  void add_contacts(Real h, Real dt, std::vector<Contact>& contacts) const;
  std::vector<Contact> overlaps();
  int unsettled = 0;  ///< substeps so far in which drives' limits, joints' friction and contacts did not agree

 private:
  class Dispatcher;
  class Solver;
  class BulletWorld;
  void forget_contacts();
  std::vector<Contact> points(Real h) const;
  WorldParams params_;
  std::unique_ptr<btDefaultCollisionConfiguration> configuration_;
  std::unique_ptr<Dispatcher> dispatcher_;
  std::unique_ptr<btSimpleBroadphase> broadphase_;  // all pairs, no history
  std::unique_ptr<Solver> solver_;
  std::vector<std::unique_ptr<DrivenRobot>> robots_;
  std::unique_ptr<BulletWorld> world_;  // last: it reaches for the colliders when it goes
};
}  // namespace robot
