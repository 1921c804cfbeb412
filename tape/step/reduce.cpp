#include "tape/step/reduce.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "tape/bodies/free_flight.hpp"
#include "tape/cutting/transfer.hpp"
#include "tape/reduction/front.hpp"

namespace tape {
namespace {
/// A cluster of a state and what belongs to it.
struct ClusterPlace {
  std::size_t cluster, body;
  const BodyPart& part;
  const StripPart& strip;
  const StripGraph& graph;
  const Strip& roll;
};
ClusterPlace place_of(const World& world, std::size_t cluster) {
  const std::size_t body = static_cast<std::size_t>(world.first_cluster()) + cluster;
  const BodyPart& part = world.assembly.bodies[body];
  const auto strip = static_cast<std::size_t>(part.cluster_of);
  return {cluster, body, part, world.assembly.strips[strip], world.graphs[strip], world.setup.scene.strips[strip]};
}
int samples(const World& world) { return params<CohesiveZone>(world.setup.effects).samples; }
int collar(const World& world) { return world.setup.scene.cluster.collar; }

Mat3 inertia_in_world(const BodyMass& mass, const Mat3& R) { return R * inertia_tensor(mass.second) * R.transpose(); }

/// [nv] 0: one of these bodies carries it, else -1.
std::vector<int> as_one(const Carriage& carriage, const std::vector<int>& bodies) {
  std::vector<int> out;
  for (const VertexOwner& owner : carriage.owner) out.push_back(std::ranges::count(bodies, owner.body) > 0 ? 0 : -1);
  return out;
}
void put_to_sleep(const World& world, const ClusterPlace& at, State& state) {
  const Carriage c = carry(world, state);
  Cluster& cluster = state.clusters[at.cluster];
  EffectMemory asleep = *cluster.asleep;
  std::vector<int> bodies{static_cast<int>(at.body)};
  if (cluster.rest) bodies.push_back(at.roll.winding->hub);
  sort_pairs(world.assembly, as_one(c, bodies), samples(world), state.memory, asleep);
  cluster.asleep = std::make_shared<const EffectMemory>(std::move(asleep));
}

/// [m] about its centre.
Real hub_radius(const World& world, std::size_t hub) {
  const BodyPart& part = world.assembly.bodies[hub];
  Real radius = 0;
  for (int v = part.first_vertex; v < part.first_vertex + part.vertices; ++v)
    radius = std::max(radius, world.assembly.local[static_cast<std::size_t>(v)].norm());
  return radius;
}

/// Gives a cluster the momentum of its members.
void take_motion(const World& world, const ClusterPlace& at, const std::vector<bool>& member, State& state) {
  BodyState& body = state.bodies[at.body];
  const Real mass = state.clusters[at.cluster].mass.mass;
  body.velocity.setZero(), body.angular_momentum.setZero();
  for (int v = 0; v < at.strip.vertices; ++v) {
    if (!member[static_cast<std::size_t>(v)]) continue;
    const auto k = static_cast<std::size_t>(at.strip.first_vertex + v);
    body.velocity += world.assembly.mass[k] / mass * state.v[k];
    body.angular_momentum += world.assembly.mass[k] * (state.x[k] - body.pose.position).cross(state.v[k]);
  }
}

/// Gives back the members that the cluster no longer has. @param was  its members before
void let_go(const World& world, const ClusterPlace& at, const std::vector<bool>& was, State& state) {
  Cluster& cluster = state.clusters[at.cluster];
  BodyState& body = state.bodies[at.body];
  const std::vector<bool> is = members(world.assembly, at.strip, cluster, collar(world));
  const Vec3 spin = inertia_in_world(cluster.mass, body.pose.rotation).inverse() * body.angular_momentum;
  bool any = false;
  for (int v = 0; v < at.strip.vertices; ++v) {
    const auto i = static_cast<std::size_t>(v);
    any |= is[i];
    if (!was[i] || is[i]) continue;
    const auto k = static_cast<std::size_t>(at.strip.first_vertex + v);
    state.v[k] = body.velocity + spin.cross(state.x[k] - body.pose.position);
  }
  const Vec3 centre = cluster.centre;
  weigh(world.assembly, at.strip, is, cluster);
  const Vec3 shift = body.pose.rotation * (cluster.centre - centre);
  body.pose.position += shift;
  body.velocity = any ? Vec3(body.velocity + spin.cross(shift)) : Vec3(Vec3::Zero());
  body.angular_momentum = any ? Vec3(inertia_in_world(cluster.mass, body.pose.rotation) * spin) : Vec3(Vec3::Zero());
}
}  // namespace

Carriage carry(const World& world, const State& state) {
  return carry(world.assembly, state.clusters, state.sleepers.get(), collar(world));
}

SurfaceCarriage surface_carriage(const World& world, const State& state, const Carriage& carriage) {
  SurfaceCarriage out{.owner = {carriage.owner.begin(), carriage.owner.begin() + world.assembly.surface_vertices},
                      .follows = world.surface.follows,
                      .home = {},
                      .clusters = {},
                      .resting = {}};
  if (!state.clusters.empty()) out.home.resize(out.owner.size(), Vec3::Zero());
  for (std::size_t k = 0; k < state.clusters.size(); ++k) {
    const ClusterPlace at = place_of(world, k);
    if (carriage.mass[static_cast<std::size_t>(at.part.centre)] == 0) continue;  // without members
    const auto hub = world.assembly.strips.size() + static_cast<std::size_t>(at.roll.winding->hub);
    out.follows[static_cast<std::size_t>(at.part.cluster_of)] = out.follows[hub] = static_cast<int>(at.body);
    out.clusters[static_cast<int>(at.body)] = state.clusters[k].centre;
    if (state.clusters[k].rest) out.resting[at.roll.winding->hub] = static_cast<int>(at.body);
    std::ranges::copy(*state.clusters[k].local, out.home.begin() + at.strip.first_vertex);
  }
  return out;
}

std::vector<Vec3> velocities(const World& world, const State& state) {
  std::vector<Vec3> v = state.v;
  for (std::size_t k = 0; k < state.clusters.size(); ++k) {
    const ClusterPlace at = place_of(world, k);
    const BodyState& body = state.bodies[at.body];
    const std::vector<bool> member = members(world.assembly, at.strip, state.clusters[k], collar(world));
    const Vec3 spin = inertia_in_world(state.clusters[k].mass, body.pose.rotation).inverse() * body.angular_momentum;
    for (std::size_t i = 0; i < member.size(); ++i)
      if (const std::size_t w = static_cast<std::size_t>(at.strip.first_vertex) + i; member[i])
        v[w] = body.velocity + spin.cross(state.x[w] - body.pose.position);
  }
  return v;
}

void cut_cluster(const World& before, const World& world, std::size_t strip, const CutInWorld& cut, State& state) {
  for (std::size_t k = 0; k < state.clusters.size(); ++k) {
    const ClusterPlace at = place_of(world, k);
    Cluster& cluster = state.clusters[k];
    cluster.asleep = std::make_shared<const EffectMemory>(carried_over(cut, *cluster.asleep));
    if (static_cast<std::size_t>(at.part.cluster_of) != strip) continue;
    const ClusterPlace old = place_of(before, k);
    const std::vector<bool> was_old = members(before.assembly, old.strip, cluster, collar(before));
    const auto n = static_cast<std::size_t>(at.strip.vertices);
    std::vector<bool> was(n, false);
    std::vector<int> distance(n, 0), free;
    for (std::size_t v = 0; v < was_old.size(); ++v) {
      const int now = cut.cut.new_vertex[v];
      if (now < 0) continue;
      was[static_cast<std::size_t>(now)] = was_old[v];
      distance[static_cast<std::size_t>(now)] = (*cluster.distance)[v];
    }
    for (std::size_t v = 0; v < n; ++v)
      if (distance[v] == 0) free.push_back(static_cast<int>(v));
    at.graph.spread(free, distance);
    std::set<int> released;
    for (int v : cluster.released)
      if (const int now = cut.cut.new_vertex[static_cast<std::size_t>(v)]; now >= 0 && distance[static_cast<std::size_t>(now)] > 0)
        released.insert(now);
    if (cluster.rest) {
      Rest rest = *cluster.rest;
      for (int& v : rest.vertices) v = cut.cut.new_vertex[static_cast<std::size_t>(v)];
      if (std::erase_if(rest.vertices, [](int v) { return v < 0; }) > 0) rest.reach = 0;
      cluster.rest = std::make_shared<const Rest>(std::move(rest));
    }
    cluster.local = std::make_shared<const std::vector<Vec3>>(interpolated(cut.old_mesh, cut.cut, *cluster.local));
    cluster.distance = std::make_shared<const std::vector<int>>(std::move(distance));
    cluster.released = std::move(released);
    take_motion(world, at, was, state);
    let_go(world, at, was, state);
    put_to_sleep(world, at, state);
  }
}

void form_cluster(const World& world, State& state) {
  const ClusterPlace at = place_of(world, state.clusters.size());
  state.clusters.push_back(
      form_cluster(world.assembly, at.strip, at.graph, world.setup.memory, world.assembly.x, samples(world), collar(world)));
  Cluster& cluster = state.clusters.back();
  const std::vector<bool> is = members(world.assembly, at.strip, cluster, collar(world));
  weigh(world.assembly, at.strip, is, cluster);
  state.bodies.push_back({.pose = {Mat3::Identity(), cluster.centre}});
  take_motion(world, at, is, state);
  if (std::ssize(state.clusters) == world.clusters())
    for (std::size_t k = 0; k < state.clusters.size(); ++k) put_to_sleep(world, place_of(world, k), state);
}

Seat::Element seat_of(const World& world, const State& state, std::size_t k, const Rest& rest) {
  const ClusterPlace at = place_of(world, k);
  const int hub = at.roll.winding->hub;
  return {.hub = hub,
          .cluster = static_cast<int>(at.body),
          .hub_block = world.assembly.bodies[static_cast<std::size_t>(hub)].block,
          .cluster_block = at.part.block,
          .arm = rest.at.foot - state.clusters[k].centre,
          .turn = rest.at.turn,
          .form = rest.form};
}

std::vector<Seat::Element> seats(const World& world, const State& state) {
  std::vector<Seat::Element> out;
  for (std::size_t k = 0; k < state.clusters.size(); ++k)
    if (const auto& rest = state.clusters[k].rest) out.push_back(seat_of(world, state, k, *rest));
  return out;
}

Real off_its_rest(const World& world, const Carriage& carriage, const State& state, std::size_t k) {
  const ClusterPlace at = place_of(world, k);
  const Cluster& cluster = state.clusters[k];
  const auto has_left = [&](int v) {
    return carriage.owner[static_cast<std::size_t>(at.strip.first_vertex + v)].body != static_cast<int>(at.body);
  };
  if (cluster.rest->reach == 0 || std::ranges::any_of(cluster.rest->vertices, has_left)) return std::numeric_limits<Real>::infinity();
  const Pose& hub = state.bodies[static_cast<std::size_t>(at.roll.winding->hub)].pose;
  return displaced(cluster.rest->at, cluster.rest->radius, hub, state.bodies[at.body].pose, cluster.centre) / cluster.rest->reach;
}

bool stays_on_hub(const World& world, const State& before, const State& after, std::size_t k, Real far) {
  const ClusterPlace at = place_of(world, k);
  const auto hub = static_cast<std::size_t>(at.roll.winding->hub);
  const OnHub stood = on_hub(before.bodies[hub].pose, before.bodies[at.body].pose, before.clusters[k].centre);
  return displaced(stood, hub_radius(world, hub), after.bodies[hub].pose, after.bodies[at.body].pose, after.clusters[k].centre) <= far;
}

std::optional<Rest> place_of_rest(const World& world, const State& state, std::size_t k, const std::vector<ContactPair>& pairs) {
  const ClusterPlace at = place_of(world, k);
  const auto hub = static_cast<std::size_t>(at.roll.winding->hub);
  const Carriage carriage = carry(world, state);
  if (world.assembly.bodies[hub].block < 0 || carriage.mass[static_cast<std::size_t>(at.part.centre)] == 0) return {};
  EffectMemory awake = state.memory, joins;
  sort_pairs(world.assembly, as_one(carriage, {static_cast<int>(at.body), static_cast<int>(hub)}), samples(world), awake, joins);
  std::vector<int> touch = vertices_of(world.assembly, samples(world), joins);
  if (touch.empty()) return {};  // friction alone holds it, and gives way
  Rest rest{.at = on_hub(state.bodies[hub].pose, state.bodies[at.body].pose, state.clusters[k].centre),
            .form = {},
            .reach = world.setup.scene.dhat(),
            .radius = hub_radius(world, hub),
            .vertices = {}};
  const auto is_of_roll = [&](int v) {
    const int body = carriage.owner[static_cast<std::size_t>(v)].body;
    return body == static_cast<int>(at.body) || body == static_cast<int>(hub);
  };
  for (const ContactPair& pair : pairs) {
    if (!std::ranges::all_of(pair.v, is_of_roll)) continue;
    Vec3 x[4];
    for (int i = 0; i < 4; ++i) x[i] = vertex_position(world, state, static_cast<std::size_t>(pair.v[i]));
    rest.reach = std::min(rest.reach, combine(closest(pair.kind, x).weight, x).norm() - pair.xi);
    touch.insert(touch.end(), std::begin(pair.v), std::end(pair.v));
  }
  rest.reach *= world.setup.scene.cluster.seat;
  for (int v : touch)
    if (v < world.assembly.strip_vertices) rest.vertices.push_back(v - at.strip.first_vertex);
  std::ranges::sort(rest.vertices);
  rest.vertices.erase(std::ranges::unique(rest.vertices).begin(), rest.vertices.end());
  return rest;
}

void put_to_rest(const World& world, std::size_t k, Rest rest, State& state) {
  state.clusters[k].rest = std::make_shared<const Rest>(std::move(rest));
  put_to_sleep(world, place_of(world, k), state);
}

RestingPairs resting_pairs(const World& world, const Carriage& carriage, const State& state, std::size_t k) {
  const ClusterPlace at = place_of(world, k);
  const Cluster& cluster = state.clusters[k];
  RestingPairs out{.with_hub = {}, .of_members = *cluster.asleep, .x = vertex_positions(world, state)};
  sort_pairs(world.assembly, as_one(carriage, {static_cast<int>(at.body)}), samples(world), out.with_hub, out.of_members);
  const Pose stood = stands(cluster.rest->at, state.bodies[static_cast<std::size_t>(at.roll.winding->hub)].pose, cluster.centre);
  for (int v = at.strip.first_vertex; v < at.strip.first_vertex + at.strip.vertices; ++v)
    if (const auto i = static_cast<std::size_t>(v); carriage.owner[i].body == static_cast<int>(at.body))
      out.x[i] = apply(stood, carriage.local[i]);
  return out;
}

void wake(const World& world, const Carriage& carriage, std::size_t k, EffectMemory of_members, EffectMemory with_hub, State& state) {
  state.clusters[k].rest = nullptr;
  state.clusters[k].asleep = std::make_shared<const EffectMemory>(std::move(of_members));
  sort_pairs(world.assembly, as_one(carriage, {}), samples(world), state.memory, with_hub);
}

std::vector<TapePart> tape_parts(const World& world, const State& state) {
  std::vector<TapePart> parts(state.x.size(), TapePart::free);
  for (std::size_t k = 0; k < state.clusters.size(); ++k) {
    const ClusterPlace at = place_of(world, k);
    const Cluster& cluster = state.clusters[k];
    const std::vector<bool> member = members(world.assembly, at.strip, cluster, collar(world));
    for (std::size_t v = 0; v < member.size(); ++v)
      if (member[v] || (*cluster.distance)[v] > 0)
        parts[static_cast<std::size_t>(at.strip.first_vertex) + v] = member[v] ? TapePart::cluster : TapePart::collar;
  }
  for (std::size_t v = 0; state.sleepers && v < parts.size(); ++v)
    if (state.sleepers->body[v] >= 0) parts[v] = TapePart::asleep;
  return parts;
}

bool advance_fronts(const World& world, const Carriage& carriage, const State& before, State& after) {
  bool moved = false;
  for (std::size_t k = 0; k < after.clusters.size(); ++k) {
    const ClusterPlace at = place_of(world, k);
    Cluster& cluster = after.clusters[k];
    if (carriage.mass[static_cast<std::size_t>(at.part.centre)] == 0) continue;  // without members
    const auto hub = static_cast<std::size_t>(at.roll.winding->hub);
    const FrontView view{world.assembly, at.strip, world.assembly.bodies[hub], after.x, after.bodies[at.body].pose, after.bodies[hub].pose};
    const bool bonded = world.setup.scene.adhesion(at.roll.material, at.roll.material).law == AdhesionLaw::bond;
    const std::vector<Bonds::Memory>& bonds = std::get<MemoryOf<Bonds>>(after.memory).pairs;
    if (bonded) mark_released(view, std::get<MemoryOf<Bonds>>(before.memory).pairs, bonds, cluster);
    const Real delta = world.setup.scene.cluster.gate_distance * world.setup.scene.dhat();
    const auto pass = [&](const std::vector<int>& next) {
      return pass_front(view, cluster, next, world.setup.scene.cluster.gate, delta, bonded ? &bonds : nullptr);
    };
    std::vector<int> free = pass(carriage.next[k]);
    if (free.empty()) continue;
    moved = true;
    const std::vector<bool> was = members(world.assembly, at.strip, cluster, collar(world));
    for (; !free.empty(); free = pass(next_to_free(cluster, was))) {  // as far as tape could bend in the step
      std::vector<int> distance = *cluster.distance;
      at.graph.spread(free, distance);
      cluster.distance = std::make_shared<const std::vector<int>>(std::move(distance));
      for (int v : free) cluster.released.erase(v);
    }
    let_go(world, at, was, after);
    put_to_sleep(world, at, after);
  }
  return moved;
}
}  // namespace tape
