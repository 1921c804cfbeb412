#include "cosim/exchange/pinching.hpp"

#include <algorithm>
#include <array>

#include "tape/math/distance.hpp"

namespace cosim {
namespace {
using tape::Index3;
using tape::Pose;
using tape::Real;
using tape::Vec3;
using Box = Eigen::AlignedBox<double, 3>;

constexpr Real kNear = 2e-3;  // [m] from tape

using Corners = std::array<Vec3, 3>;
struct Placed {
  Corners corners;
  Box box;
};
/// The triangles of a mesh that come near a box, both in the frame of the box.
std::vector<Placed> triangles_near(const tape::TriangleMesh& mesh, const Pose& pose, const Box& box) {
  std::vector<Placed> out;
  for (const Index3& t : mesh.triangles) {
    Placed p;
    for (int k = 0; k < 3; ++k) {
      p.corners[static_cast<std::size_t>(k)] = apply(pose, mesh.vertices[static_cast<std::size_t>(t[k])]);
      p.box.extend(p.corners[static_cast<std::size_t>(k)]);
    }
    if (p.box.intersects(box)) out.push_back(p);
  }
  return out;
}

Real distance(tape::PairKind kind, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 x[4] = {a, b, c, d};
  return tape::combine(closest(kind, x).weight, x).norm();
}
/// Of two triangles that do not cross.
Real distance(const Corners& a, const Corners& b) {
  Real least = std::numeric_limits<Real>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    least = std::min(least, distance(tape::PairKind::vertex_triangle, a[i], b[0], b[1], b[2]));
    least = std::min(least, distance(tape::PairKind::vertex_triangle, b[i], a[0], a[1], a[2]));
    for (std::size_t j = 0; j < 3; ++j)
      least = std::min(least, distance(tape::PairKind::edge_edge, a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]));
  }
  return least;
}
Pose inverse_times(const Pose& a, const Pose& b) {
  return {a.rotation.transpose() * b.rotation, a.rotation.transpose() * (b.position - a.position)};
}
}  // namespace

Pinching::Pinching(const RobotScene& robots, const tape::World& world, const robot::World& start) : world_(world) {
  const tape::Scene& scene = world.setup.scene;
  for (std::size_t r = 0; r < robots.robots.size(); ++r) {
    for (int link = 0; link < static_cast<int>(robots.robots[r].model->links.size()); ++link) {
      const auto body = std::ranges::find(scene.bodies, body_name(robots.robots[r], link), &tape::Body::name);
      if (body == scene.bodies.end()) continue;
      Link& added = links_.emplace_back(Link{static_cast<int>(r), link, static_cast<int>(body - scene.bodies.begin()), body->mesh, {}});
      for (const Vec3& v : added.mesh.vertices) added.box.extend(v);
    }
  }
  const auto moves = [&](const Link& l) { return scene.bodies[static_cast<std::size_t>(l.body)].motion == tape::Motion::linked; };
  for (int a = 0; a < std::ssize(links_); ++a) {
    for (int b = a + 1; b < std::ssize(links_); ++b) {
      const Link &first = links_[static_cast<std::size_t>(a)], &second = links_[static_cast<std::size_t>(b)];
      if (!start.may_touch(first.robot, first.link, second.robot, second.link) || (!moves(first) && !moves(second))) continue;
      candidates_.push_back({first.robot, first.link, second.robot, second.link, {first.body, second.body}});
      of_candidates_.emplace_back(a, b);
    }
  }
}

/// [m] No point of a strip, as it may have been cut, is farther from its vertices.
double Pinching::between_vertices() const {
  const tape::Assembly& a = world_.assembly;
  double longest = 0;
  for (const Index3& v : a.triangles) {
    if (v[0] >= a.strip_vertices) break;  // those of strips come first
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, (a.rest[static_cast<std::size_t>(v[k])] - a.rest[static_cast<std::size_t>(v[(k + 1) % 3])]).norm());
  }
  return longest / std::sqrt(3.0);
}

/// Vertices of strips within `reach` [m] of a link, over a step.
std::vector<int> Pinching::tape_near(const Link& link, double reach, const Pose& pose, const robot::World& bullet, const tape::State& state,
                                     const std::vector<Vec3>& x) const {
  const Real dt = world_.setup.scene.time.dt;
  const robot::VecX v = bullet.link_velocity(link.robot, link.link);
  const Real farthest = link.box.center().norm() + link.box.sizes().norm() / 2;
  reach += dt * (v.head<3>().norm() + v.tail<3>().norm() * farthest);
  const Box box(link.box.min() - Vec3::Constant(reach), link.box.max() + Vec3::Constant(reach));
  std::vector<int> near;
  for (int i = 0; i < world_.assembly.strip_vertices; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Vec3 at = pose.rotation.transpose() * (x[k] - pose.position);
    if (box.exteriorDistance(at) <= dt * state.v[k].norm()) near.push_back(i);
  }
  return near;
}

/// Whether the barrier does not act between two links. A pair that went over nearer would be thrown apart by a barrier that nothing had
/// pressed, and held by friction that goes by it.
bool Pinching::apart(const Link& a, const Pose& X_a, const Link& b, const Pose& X_b) const {
  const auto& bodies = world_.setup.scene.bodies;
  const Real least = world_.setup.scene.dhat() + bodies[static_cast<std::size_t>(a.body)].xi + bodies[static_cast<std::size_t>(b.body)].xi;
  const Vec3 margin = Vec3::Constant(least);
  const std::vector<Placed> of_b = triangles_near(b.mesh, inverse_times(X_a, X_b), {a.box.min() - margin, a.box.max() + margin});
  Box around;
  for (const Placed& t : of_b) around.extend(t.box);
  if (of_b.empty()) return true;
  around.min() -= margin, around.max() += margin;
  for (const Placed& t : triangles_near(a.mesh, {}, around)) {
    const Box wide(t.box.min() - margin, t.box.max() + margin);
    for (const Placed& u : of_b)
      if (wide.intersects(u.box) && distance(t.corners, u.corners) < least) return false;
  }
  return true;
}

std::vector<LinkPair> Pinching::find(const tape::State& state, const robot::World& bullet) const {
  const std::vector<Vec3> x = vertex_positions(world_, state);
  const auto pose = [&](const Link& l) { return state.bodies[static_cast<std::size_t>(l.body)].pose; };
  const double reach = kNear + between_vertices();
  std::vector<std::vector<int>> near;
  for (const Link& link : links_) near.push_back(tape_near(link, reach, pose(link), bullet, state, x));
  const auto share = [](const std::vector<int>& a, const std::vector<int>& b) {
    return std::ranges::any_of(a, [&](int v) { return std::ranges::binary_search(b, v); });
  };
  std::vector<LinkPair> found;
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    const auto a = static_cast<std::size_t>(of_candidates_[k][0]), b = static_cast<std::size_t>(of_candidates_[k][1]);
    const LinkPair& pair = candidates_[k];
    if (near[a].empty() || near[b].empty() || !share(near[a], near[b])) continue;
    const bool in_bullet = bullet.may_touch(pair.robot_a, pair.link_a, pair.robot_b, pair.link_b);
    if (!in_bullet || apart(links_[a], pose(links_[a]), links_[b], pose(links_[b]))) found.push_back(pair);
  }
  return found;
}
}  // namespace cosim
