#include "tape/step/cut.hpp"

#include <algorithm>
#include <cmath>

#include "tape/contact/intersection.hpp"
#include "tape/cutting/adhesion.hpp"
#include "tape/cutting/transfer.hpp"
#include "tape/effects/barrier.inl"
#include "tape/step/reduce.hpp"
#include "tape/step/sleep.hpp"

namespace tape {
namespace {
std::size_t body_of(const World& world, const Blade& blade) {
  const std::vector<Body>& bodies = world.setup.scene.bodies;
  const auto it = std::ranges::find(bodies, blade.body, &Body::name);
  if (it == bodies.end()) throw InputError("cutting: no body is named '" + blade.body + "'");
  return static_cast<std::size_t>(it - bodies.begin());
}

std::vector<Vec3> edge_in_world(const World& world, const State& state, const Blade& blade) {
  const std::size_t b = body_of(world, blade);
  std::vector<Vec3> out;
  for (const Vec3& y : blade.edge) out.push_back(apply(state.bodies[b].pose, y - world.assembly.bodies[b].mesh_offset));
  return out;
}

StripMesh mesh_of(const World& world, const StripPart& part) {
  StripMesh mesh;
  const auto first = world.assembly.rest.begin() + part.first_vertex;
  mesh.rest.assign(first, first + part.vertices);
  for (int t = part.first_triangle; t < part.first_triangle + part.triangles; ++t)
    mesh.triangles.emplace_back(world.assembly.triangles[static_cast<std::size_t>(t)].array() - part.first_vertex);
  return mesh;
}

/// The kerf in a strip. No part of what is left may feel another, nor a cell its neighbours.
Kerf kerf_in(const World& world, int film) {
  constexpr Real kMore = 1.05;  // of the distance at which a film begins to feel itself
  const Scene& scene = world.setup.scene;
  Kerf out = world.setup.cutting.kerf;
  out.clearance = std::max(out.clearance, kMore * (2 * scene.films[static_cast<std::size_t>(film)].xi + scene.dhat()));
  return out;
}

/// Energy of motion [J] of the strips.
Real kinetic(const World& world, const State& state) {
  Real sum = 0;
  for (std::size_t v = 0; v < state.v.size(); ++v) sum += world.assembly.mass[v] * state.v[v].squaredNorm() / 2;
  return sum;
}

template <class T>
std::vector<T> replaced(const std::vector<T>& all, const StripPart& part, const std::vector<T>& values) {
  std::vector<T> out(all.begin(), all.begin() + part.first_vertex);
  out.insert(out.end(), values.begin(), values.end());
  out.insert(out.end(), all.begin() + part.first_vertex + part.vertices, all.end());
  return out;
}

/// One cut of one strip.
class Surgery {
 public:
  Surgery(const World& world, const State& state, std::size_t strip, CutReport& report)
      : world_(world), state_(state), strip_(strip), part_(world.assembly.strips[strip]), report_(report), mesh_(mesh_of(world, part_)) {}

  /// @return whether `world` and `state` are those after the cut; else the report says why not
  bool cut(const std::vector<int>& targets, World& world, State& state) {
    const CuttingParams& params = world_.setup.cutting;
    const auto first = state_.x.begin() + part_.first_vertex;
    const std::vector<Vec3> x(first, first + part_.vertices);
    const auto project = [&](const std::vector<int>& on) {
      return project_blade(mesh_, x, report_.where, on, params.kerf.width, params.project);
    };
    try {
      Projection line = project(targets);
      if (!line) line = project({targets[0]});  // of several strands under the blade that which it presses most
      if (!line) return refuse(line.refusal);
      cut_ = cut_kerf(mesh_, line.line, kerf_in(world_, part_.film), params.mesh, targets[0]);
      if (!cut_) return refuse(cut_.refusal);
      if (touches_cluster()) return refuse("the blade is on tape that is wound");
      move_on(x, world, state);
      check_start(vertex_positions(world, state), world.surface, world.setup.scene.dhat(), pairs_out_of_contact(state.memory));
    } catch (const InputError& e) {
      return refuse(e.what());
    }
    report_.pieces = cut_.pieces, report_.kerf_area = cut_.kerf_area, report_.kerf_mass = cut_.kerf_area * per_area();
    report_.smallest_angle = cut_.smallest_angle, report_.deviation = cut_.deviation;
    report_.kinetic = kinetic(world, state) - kinetic(world_, state_);
    return true;
  }

 private:
  bool refuse(const std::string& why) {
    report_.refusal = why;
    return false;
  }
  const Film& film() const { return world_.setup.scene.films[static_cast<std::size_t>(part_.film)]; }
  Real per_area() const { return film().thickness * film().density; }
  bool touches_cluster() const {
    const std::vector<TapePart> parts = tape_parts(world_, state_);
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
      if (cut_.new_triangle[t] < 0)
        for (int v : mesh_.triangles[t])
          if (parts[static_cast<std::size_t>(part_.first_vertex + v)] == TapePart::cluster) return true;
    return false;
  }

  void move_on(const std::vector<Vec3>& x, World& world, State& state) {
    const std::vector<Vec3> all_v = velocities(world_, state_);
    const std::vector<Vec3> v(all_v.begin() + part_.first_vertex, all_v.begin() + part_.first_vertex + part_.vertices);
    const MovedOn moved = tape::move_on(mesh_, cut_, x, v, per_area());
    report_.largest_change = moved.largest_change;
    state = state_;
    state.x = replaced(state_.x, part_, moved.x);
    state.v = replaced(state_.v, part_, moved.v);
    state.remnants[strip_] = std::make_shared<const StripMesh>(cut_.mesh);
    keep_grips(state);
    world = world_.with(state.remnants);
    std::size_t springs = 0;
    for (const Assembly::GripPart& grip : world.assembly.grips) springs += grip.vertices.size();
    if (springs != state.grip_base.size()) throw InputError("a new vertex would stand where a gripped one was");
    const CutInWorld in_world{.cut = cut_,
                              .old_mesh = mesh_,
                              .first_vertex = part_.first_vertex,
                              .first_triangle = part_.first_triangle,
                              .old_triangles = world_.assembly.triangles,
                              .triangles = world.assembly.triangles,
                              .old_x = vertex_positions(world_, state_),
                              .x = vertex_positions(world, state),
                              .samples = params<CohesiveZone>(world_.setup.effects).samples};
    state.memory = carried_over(in_world, state_.memory);
    cut_cluster(world_, world, strip_, in_world, state);
  }

  /// Springs whose vertices are gone go too.
  void keep_grips(State& state) const {
    std::vector<Vec3> kept;
    std::size_t spring = 0;
    for (const Assembly::GripPart& grip : world_.assembly.grips)
      for (int v : grip.vertices) {
        const int local = v - part_.first_vertex;
        const bool here = local >= 0 && local < part_.vertices;
        if (!here || cut_.new_vertex[static_cast<std::size_t>(local)] >= 0) kept.push_back(state_.grip_base[spring]);
        ++spring;
      }
    state.grip_base = std::move(kept);
  }

  const World& world_;
  const State& state_;
  std::size_t strip_;
  const StripPart& part_;
  CutReport& report_;
  StripMesh mesh_;
  Cut cut_;
};

/// The strip that a triangle is of.
std::size_t strip_of(const World& world, int triangle) {
  const auto it =
      std::ranges::find_if(world.assembly.strips, [&](const StripPart& p) { return triangle < p.first_triangle + p.triangles; });
  return static_cast<std::size_t>(it - world.assembly.strips.begin());
}

CutReport cut_by(World& world, State& state, const Blade& blade, const BladePressure& pressure) {
  const std::size_t strip = strip_of(world, pressure.triangle);
  const StripPart& part = world.assembly.strips[strip];
  CutReport report{.blade = blade.body, .strip = world.setup.scene.strips[strip].name, .pressure = pressure.peak};
  report.where = edge_in_world(world, state, blade);
  std::vector<int> targets{pressure.triangle - part.first_triangle};
  for (int t : pressure.above)
    if (t != pressure.triangle && strip_of(world, t) == strip) targets.push_back(t - part.first_triangle);
  World next;
  State awake = state, after;
  wake_tape(world, awake);
  if (Surgery(world, awake, strip, report).cut(targets, next, after)) {
    world = std::move(next);
    state = std::move(after);
  }
  return report;
}
}  // namespace

std::vector<int> sharp_vertices(const World& world, const Blade& blade) {
  constexpr Real kOn = 1e-6;  // [m]
  const std::size_t b = body_of(world, blade);
  const std::vector<Vec3>& vertices = world.setup.scene.bodies[b].mesh.vertices;
  std::vector<int> out;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    bool on = false;
    for (std::size_t k = 0; k + 1 < blade.edge.size() && !on; ++k) {
      const Vec3 along = blade.edge[k + 1] - blade.edge[k], from = vertices[v] - blade.edge[k];
      const Real at = std::clamp(from.dot(along) / std::max(along.squaredNorm(), 1e-30), 0.0, 1.0);
      on = (from - at * along).norm() < kOn;
    }
    if (on) out.push_back(world.assembly.bodies[b].first_vertex + static_cast<int>(v));
  }
  if (out.size() < 2) throw InputError("cutting: the edge of blade '" + blade.body + "' does not run through vertices of its mesh");
  return out;
}

void require_blades(const World& world) {
  const Scene& scene = world.setup.scene;
  for (const Blade& blade : scene.blades) sharp_vertices(world, blade);
  if (scene.blades.empty()) return;
  for (const Strip& strip : scene.strips)
    if (const Kerf kerf = kerf_in(world, strip.film); !(kerf.width > kerf.clearance))
      throw InputError("cutting.width = " + to_text(kerf.width) + ": the sides of a cut in strip '" + strip.name +
                       "' would touch (allowed: above " + to_text(kerf.clearance) +
                       " m, which is cutting.clearance or 1.05 (2 xi + dhat))");
}

BladeWatch::BladeWatch(const World& world) : world_(world), sharp_(world.assembly.x.size(), 0) {
  std::vector<Index3> triangles;
  std::vector<Real> area;
  for (const StripPart& part : world.assembly.strips)
    for (int t = part.first_triangle; t < part.first_triangle + part.triangles; ++t) {
      triangles.push_back(world.assembly.triangles[static_cast<std::size_t>(t)]);
      area.push_back(world.surface.triangles[static_cast<std::size_t>(t)].area);
    }
  for (const Blade& blade : world.setup.scene.blades) {
    std::vector<char> sharp(world.assembly.x.size(), 0);
    for (int v : sharp_vertices(world, blade)) sharp[static_cast<std::size_t>(v)] = sharp_[static_cast<std::size_t>(v)] = 1;
    probes_.emplace_back(triangles, area, sharp);
  }
}

std::vector<BladePressure> BladeWatch::pressures(const std::vector<ContactPair>& pairs, const std::vector<Vec3>& x) const {
  std::vector<ContactPair> near;
  std::ranges::copy_if(pairs, std::back_inserter(near), [&](const ContactPair& pair) {
    return std::ranges::any_of(pair.v, [&](int v) { return sharp_[static_cast<std::size_t>(v)] != 0; });
  });
  std::vector<typename Barrier::Element> none;
  Barrier barrier = Barrier::build(world_.setup.scene, world_.assembly, params<Barrier>(world_.setup.effects), none);
  barrier.elements = {near.data(), static_cast<int>(near.size())};
  StateView s{};
  s.x = {x.data(), static_cast<int>(x.size())};
  std::vector<Real> force(near.size(), 0);
  for (int i = 0; i < barrier.elements.size; ++i) {
    if (!barrier.active(s, i)) continue;
    const VecN<12> g = barrier.gradient(s, i);
    const bool face = near[static_cast<std::size_t>(i)].kind == PairKind::vertex_triangle;
    force[static_cast<std::size_t>(i)] = face ? g.head<3>().norm() : (g.head<3>() + g.segment<3>(3)).norm();
  }
  std::vector<BladePressure> out;
  for (const BladePressureProbe& probe : probes_) out.push_back(probe.measure(near, force, x, world_.setup.cutting.trigger.threshold));
  return out;
}

std::vector<CutReport> cut_strips(World& world, State& state, const std::vector<BladePressure>& pressures) {
  const TriggerParams params = world.setup.cutting.trigger;
  std::vector<CutReport> out;
  for (std::size_t b = 0; b < pressures.size(); ++b) {
    CutTrigger& trigger = state.triggers[b];
    if (!trigger.update(pressures[b].peak, params)) continue;
    if (!out.empty()) {
      trigger = {params.steps - 1, 0};
      continue;
    }
    out.push_back(cut_by(world, state, world.setup.scene.blades[b], pressures[b]));
    if (!out.back().refusal.empty()) state.triggers[b].waiting = params.retry;
  }
  return out;
}
}  // namespace tape
