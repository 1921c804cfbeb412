#include "tape/step/sleep.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "tape/math/rotation.hpp"
#include "tape/step/engagement.hpp"
#include "tape/step/reduce.hpp"

namespace tape {
namespace {
template <class T>
const T& at(const std::vector<T>& values, int i) {
  return values[static_cast<std::size_t>(i)];
}
int samples(const World& world) { return params<CohesiveZone>(world.setup.effects).samples; }

/// [nv] the body that each vertex is of, also where it is fixed; -1: of a strip.
std::vector<int> bodies_of_vertices(const World& world) {
  std::vector<int> out(world.assembly.x.size(), -1);
  for (std::size_t b = 0; b < world.assembly.bodies.size(); ++b) {
    const BodyPart& part = world.assembly.bodies[b];
    std::fill_n(out.begin() + part.first_vertex, part.vertices, static_cast<int>(b));
  }
  return out;
}

/// How far things have moved since a glance.
class Moves {
 public:
  Moves(const World& world, const Glance& then, const State& now) : world_(world), then_(then), now_(now) {}
  /// [m] as a body sees it.
  Real seen_from(int body, int v) const {
    const auto v_now = vertex_position(world_, now_, static_cast<std::size_t>(v));
    const Pose &before = at(then_.body, body), &after = now_.bodies[static_cast<std::size_t>(body)].pose;
    return (after.rotation.transpose() * (v_now - after.position) - before.rotation.transpose() * (position_then(v) - before.position))
        .norm();
  }

 private:
  Vec3 position_then(int v) const {
    if (v < std::ssize(then_.x)) return at(then_.x, v);
    const int body = at(world_.assembly.owner, v).body;
    return body < 0 ? at(world_.assembly.x, v) : apply(at(then_.body, body), at(world_.assembly.local, v));
  }
  const World& world_;
  const Glance& then_;
  const State& now_;
};

/// The body that each strip vertex adheres to by most of the pairs that name it; -1: by none, or one of them is not yet as engaged as it
/// will be.
std::vector<int> held_by(const World& world, const State& before, const State& after) {
  constexpr Real kSettled = 1e-3;  // [1/s] rate at which engagement may change
  const Real settled = kSettled * world.setup.scene.time.dt;
  const auto n = static_cast<std::size_t>(world.assembly.strip_vertices);
  const std::vector<int> body = bodies_of_vertices(world);
  std::vector<std::map<int, int>> votes(n);
  std::vector<char> changes(n, 0);
  const auto count = [&]<class T>(const MemoryOf<T>& was, const MemoryOf<T>& is) {
    if constexpr (Remembers<T>) {
      auto known = was.pairs.begin();
      for (const auto& pair : is.pairs) {
        while (known != was.pairs.end() && known->key() < pair.key()) ++known;
        const Adhesion law = adhesion_of(world, pair);
        const bool still =
            known != was.pairs.end() && known->key() == pair.key() && std::fabs(pair.engagement(law) - known->engagement(law)) <= settled;
        const SurfaceTriangle& triangle = at(world.surface.triangles, pair.triangle);
        const auto vote = [&](int v, int other) {
          if (v >= world.assembly.strip_vertices) return;
          ++votes[static_cast<std::size_t>(v)][at(body, other)];
          if (!still) changes[static_cast<std::size_t>(v)] = 1;
        };
        const std::vector<int> own = sticking_vertices(world, pair);
        for (int v : own) vote(v, triangle.v[0]);
        for (int v : triangle.v) vote(v, own[0]);
      }
    }
  };
  std::apply([&](const auto&... is) { (count(std::get<std::remove_cvref_t<decltype(is)>>(before.memory), is), ...); }, after.memory);
  std::vector<int> held(n, -1);
  for (std::size_t v = 0; v < n; ++v) {
    if (votes[v].empty() || changes[v] != 0) continue;
    held[v] = std::ranges::max_element(votes[v], {}, [](const auto& vote) { return vote.second; })->first;
  }
  for (const StripPart& strip : world.assembly.strips)  // tape on its own hub is part of its roll
    for (int v = strip.first_vertex; v < strip.first_vertex + strip.vertices; ++v)
      if (int& on = held[static_cast<std::size_t>(v)]; on == strip.hub) on = -1;
  return held;
}

/// Of tape on these bodies [strip vertices] that which nothing disturbs: nothing near it, nor what it hangs together with for some edges,
/// has moved there. -1 for the rest.
std::vector<int> undisturbed(const World& world, const std::vector<ContactPair>& near, const State& state, std::vector<int> on) {
  const SleepParams& sleep = world.setup.scene.sleep;
  const Real far = sleep.move * world.setup.scene.dhat();
  const Moves moves(world, *state.glance, state);
  const std::vector<int>& frame = state.glance->frame;
  std::vector<char> restless(on.size(), 0);
  for (const ContactPair& pair : near)
    for (int v : pair.v) {
      if (v >= std::ssize(on) || at(on, v) < 0) continue;
      for (int w : pair.v)
        if (at(world.assembly.owner, w).body != at(on, v) && moves.seen_from(at(on, v), w) > far) restless[static_cast<std::size_t>(v)] = 1;
    }
  std::size_t spring = 0;
  const Drive drive = Drive::at(world, state, state.time, 0);
  for (const Assembly::GripPart& grip : world.assembly.grips)
    for (int v : grip.vertices)
      if (drive.grip_stiffness[spring++] > 0 && v < std::ssize(on)) restless[static_cast<std::size_t>(v)] = 1;
  for (std::size_t s = 0; s < world.graphs.size(); ++s) {
    const int first = world.assembly.strips[s].first_vertex;
    std::vector<int> sources, distance(static_cast<std::size_t>(world.graphs[s].vertices()), sleep.edges);
    for (int i = 0; i < world.graphs[s].vertices(); ++i) {
      const int v = first + i, body = at(frame, v);
      bool moved = body < 0 || at(restless, v) != 0 || moves.seen_from(body, v) > far;
      for (int w : world.graphs[s].neighbours(i)) moved = moved || (at(frame, first + w) != body && moves.seen_from(body, first + w) > far);
      if (moved) sources.push_back(i);
    }
    world.graphs[s].spread(sources, distance);
    for (int i = 0; i < world.graphs[s].vertices(); ++i)
      if (at(distance, i) < sleep.edges) on[static_cast<std::size_t>(first + i)] = -1;
  }
  return on;
}

Glance look(const World& world, const State& state, std::vector<int> held) {
  Glance out{.x = state.x, .body = {}, .frame = std::move(held)};
  for (const BodyState& body : state.bodies) out.body.push_back(body.pose);
  const std::vector<TapePart> parts = tape_parts(world, state);
  const auto is_wound = [&](std::size_t v) { return parts[v] == TapePart::collar || parts[v] == TapePart::cluster; };
  for (std::size_t s = 0; s < world.graphs.size(); ++s) {
    const auto begin = out.frame.begin() + world.assembly.strips[s].first_vertex, end = begin + world.assembly.strips[s].vertices;
    std::vector<int> frame(begin, end);
    world.graphs[s].flood(frame);
    std::ranges::copy(frame, begin);
  }
  for (std::size_t v = 0; v < out.frame.size(); ++v)
    if (is_wound(v)) out.frame[v] = -1;
  return out;
}

/// Gives tape to these bodies [strip vertices], -1: to none.
void carry_tape(const World& world, const std::vector<int>& on, State& state) {
  auto next = std::make_shared<Sleepers>();
  if (state.sleepers) *next = *state.sleepers;
  next->local.resize(on.size(), Vec3::Zero());
  for (std::size_t v = 0; v < on.size(); ++v) {
    if (on[v] < 0) {
      next->local[v].setZero();
    } else if (!state.sleepers || state.sleepers->body[v] != on[v]) {
      const Pose& pose = state.bodies[static_cast<std::size_t>(on[v])].pose;
      next->local[v] = pose.rotation.transpose() * (state.x[v] - pose.position);
    }
  }
  next->body = on;
  std::vector<int> as_one = bodies_of_vertices(world);
  std::ranges::copy(on, as_one.begin());
  sort_pairs(world.assembly, as_one, samples(world), state.memory, next->asleep);
  const bool any = std::ranges::any_of(on, [](int body) { return body >= 0; });
  state.sleepers = any ? std::shared_ptr<const Sleepers>(std::move(next)) : nullptr;
}

/// Whether it is time for the next look.
bool looks(const World& world, const State& after) {
  const Real steps = std::round(world.setup.scene.sleep.after / world.setup.scene.time.dt);
  return after.step % std::max(1, static_cast<int>(std::min(steps, 1e9))) == 0;
}
}  // namespace

bool is_to_look_at_tape(const World& world, const State& after) {
  return world.setup.scene.sleep.after > 0 && (after.sleepers || looks(world, after));
}

bool settle_tape(const World& world, const State& before, const std::vector<ContactPair>& near, State& after) {
  const bool anew = looks(world, after);
  const std::vector<int> slept = after.sleepers ? after.sleepers->body : std::vector<int>(after.x.size(), -1);
  std::vector<int> on = slept, held;
  if (anew) {
    held = held_by(world, before, after);
    for (std::size_t v = 0; v < held.size(); ++v) {
      if (slept[v] >= 0) held[v] = slept[v];
      if (after.glance && after.glance->frame[v] == held[v]) on[v] = held[v];
    }
  }
  const bool any = std::ranges::any_of(on, [](int body) { return body >= 0; });
  if (after.glance && any) on = undisturbed(world, near, after, std::move(on));
  const bool changes = on != slept;
  if (changes) carry_tape(world, on, after);
  if (anew) after.glance = std::make_shared<const Glance>(look(world, after, std::move(held)));
  return changes;
}

bool grip_wakes_tape(const World& world, const State& state) {
  if (!state.sleepers || std::ranges::count(state.grip_closed, 0) == 0) return false;
  State closed = state;
  close_grips(world, closed);
  for (std::size_t g = 0; g < world.assembly.grips.size(); ++g) {
    const auto sleeps = [&](int v) { return v < std::ssize(state.sleepers->body) && at(state.sleepers->body, v) >= 0; };
    if (closed.grip_closed[g] != state.grip_closed[g] && std::ranges::any_of(world.assembly.grips[g].vertices, sleeps)) return true;
  }
  return false;
}

void wake_tape(const World& world, State& state) {
  if (state.sleepers) carry_tape(world, std::vector<int>(state.x.size(), -1), state);
  state.glance = nullptr;
}

int sleeping(const State& state) {
  if (!state.sleepers) return 0;
  return static_cast<int>(std::ranges::count_if(state.sleepers->body, [](int body) { return body >= 0; }));
}
}  // namespace tape
