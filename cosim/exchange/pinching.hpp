#pragma once
#include <vector>

#include "cosim/exchange/robots.hpp"
#include "tape/step/world.hpp"

namespace cosim {
/// Two links, and the bodies that they are on the tape side.
struct LinkPair {
  int robot_a, link_a, robot_b, link_b;
  tape::Index2 bodies;
};

/// Finds links that may have tape between them: some of it lies within 2 mm of both, or gets there in a step. In Bullet, which knows
/// nothing of tape, they would meet before the tape is loaded; so they touch in the tape solver as long as that holds.
class Pinching {
 public:
  /// @param start  Bullet's world then: links that may not touch in it never pinch
  Pinching(const RobotScene& robots, const tape::World& world, const robot::World& start);
  /// All pairs that could: one of them moves, and they may touch.
  const std::vector<LinkPair>& candidates() const { return candidates_; }
  /// Those that do over a step that starts at `state`. Pairs that touch in Bullet so far go over only while they are apart.
  std::vector<LinkPair> find(const tape::State& state, const robot::World& bullet) const;

 private:
  struct Link {
    int robot, link, body;
    tape::TriangleMesh mesh;  ///< [m] in the link's frame
    Eigen::AlignedBox<double, 3> box;
  };
  double between_vertices() const;
  std::vector<int> tape_near(const Link& link, double reach, const tape::Pose& pose, const robot::World& bullet, const tape::State& state,
                             const std::vector<tape::Vec3>& x) const;
  bool apart(const Link& a, const tape::Pose& X_a, const Link& b, const tape::Pose& X_b) const;

  const tape::World& world_;
  std::vector<Link> links_;
  std::vector<LinkPair> candidates_;
  std::vector<tape::Index2> of_candidates_;  ///< indices into links_
};
}  // namespace cosim
