#include "tape/step/world.hpp"

#include <algorithm>

#include "tape/bodies/free_flight.hpp"
#include "tape/contact/containment.hpp"
#include "tape/contact/intersection.hpp"
#include "tape/core/hash.hpp"
#include "tape/math/rotation.hpp"
#include "tape/model/motion.hpp"
#include "tape/step/cut.hpp"
#include "tape/step/reduce.hpp"
#include "tape/step/roll_gaps.hpp"

namespace tape {
SurfaceMesh make_surface(const Scene& scene, const Assembly& a);  // surface_mesh.cpp

namespace {
/// Effects that find their pairs through contact are off with it, unless the scene forces them: that is refused.
template <class T>
void follow_contact(const std::vector<PlanLine>& plan, const Setup& setup, PlanLine& line) {
  if (!(Remembers<T> || std::is_same_v<T, Friction> || std::is_same_v<T, Seat>) || !line.on) return;
  for (const PlanLine& other : plan) {
    if (other.name != Barrier::name || other.on) continue;
    if (setup.forced.contains(line.name)) throw InputError("effects." + line.name + " = on: it works on contact, and barrier is off");
    line.on = false;
    line.why = "it works on contact, and barrier is off";
  }
}

std::vector<PlanLine> make_plan(const Setup& setup) {
  std::vector<PlanLine> plan;
  for_each_effect([&]<class T>(std::type_identity<T>) {
    PlanLine line{.name = std::string(T::name), .on = false, .why = T::needed(setup.scene, params<T>(setup.effects))};
    line.on = !line.why.empty();
    if (!line.on) line.why = "nothing in the scene asks for it";
    if (const auto forced = setup.forced.find(line.name); forced != setup.forced.end()) {
      line.on = forced->second;
      line.why = "effects." + line.name;
    }
    follow_contact<T>(plan, setup, line);
    plan.push_back(line);
  });
  for (const auto& [name, on] : setup.forced) {
    bool known = false;
    for (const PlanLine& line : plan) known |= line.name == name;
    if (!known) throw InputError("effects." + name + ": there is no effect of this name");
  }
  return plan;
}
}  // namespace

World World::build(Setup setup) {
  World world;
  for_each_effect([&]<class T>(std::type_identity<T>) { require_valid(params<T>(setup.effects), std::string(T::name)); });
  require_valid(setup.scene.time, "time");
  require_valid(setup.scene.contact, "contact");
  require_valid(setup.newton, "solver");
  require_valid(setup.linear, "solver");
  require_valid(setup.cutting, "cutting");
  world.plan = make_plan(setup);
  world.setup = std::move(setup);
  world.lay_out();
  require_blades(world);
  check_rolls(world.setup.scene, world.assembly, world.surface, world.assembly.x);
  check_start(world.assembly.x, world.surface, world.setup.scene.dhat());
  check_nothing_inside(world.assembly.x, world.surface);
  return world;
}

void World::lay_out() {
  assembly = assemble(setup.scene);
  surface = make_surface(setup.scene, assembly);
  graphs.clear();
  for (const StripPart& strip : assembly.strips) graphs.emplace_back(assembly, strip);
}

World World::with(const Remnants& remnants) const {
  World world;
  world.setup = setup;
  world.plan = plan;
  for (std::size_t s = 0; s < remnants.size(); ++s) world.setup.scene.strips[s].remnant = remnants[s];
  world.lay_out();
  return world;
}

bool World::is_on(std::string_view effect) const {
  return std::ranges::any_of(plan, [&](const PlanLine& line) { return line.name == effect && line.on; });
}

State State::start(const World& world) {
  State state;
  for (const StripPart& strip : world.assembly.strips) {
    const auto first = strip.first_vertex, last = strip.first_vertex + strip.vertices;
    state.x.insert(state.x.end(), world.assembly.x.begin() + first, world.assembly.x.begin() + last);
    state.v.insert(state.v.end(), world.assembly.v.begin() + first, world.assembly.v.begin() + last);
  }
  state.memory = world.setup.memory;
  state.triggers.resize(world.setup.scene.blades.size());
  state.remnants.resize(world.assembly.strips.size());
  state.events.assign(static_cast<std::size_t>(world.setup.scene.events), std::numeric_limits<Real>::infinity());
  for (const BodyPart& body : world.assembly.bodies) {
    if (body.cluster_of >= 0) {
      form_cluster(world, state);
      continue;
    }
    const Mat3& R = body.start.rotation;
    state.bodies.push_back({body.start, body.velocity, R * inertia_tensor(body.mass.second) * R.transpose() * body.angular_velocity});
  }
  for (const Assembly::GripPart& grip : world.assembly.grips) {
    for (int v : grip.vertices) state.grip_base.push_back(world.assembly.x[static_cast<std::size_t>(v)]);
    state.grip_closed.push_back(0);
  }
  return state;
}

std::string State::hash() const {
  Hash hash;
  hash.add(&step, sizeof step);
  hash.add(&time, sizeof time);
  hash.add(x.data(), x.size() * sizeof(Vec3));
  hash.add(v.data(), v.size() * sizeof(Vec3));
  for (const BodyState& b : bodies) {
    hash.add(b.pose.rotation.data(), sizeof(Mat3));
    hash.add(b.pose.position.data(), sizeof(Vec3));
    hash.add(b.velocity.data(), sizeof(Vec3));
    hash.add(b.angular_momentum.data(), sizeof(Vec3));
  }
  hash.add(grip_base.data(), grip_base.size() * sizeof(Vec3));
  hash.add(grip_closed.data(), grip_closed.size() * sizeof(int));
  hash.add(outside.data(), outside.size() * sizeof(Real));
  hash.add(events.data(), events.size() * sizeof(Real));
  hash.add(triggers.data(), triggers.size() * sizeof(CutTrigger));
  for (const auto& mesh : remnants) {
    if (!mesh) continue;
    hash.add(mesh->rest.data(), mesh->rest.size() * sizeof(Vec2));
    hash.add(mesh->triangles.data(), mesh->triangles.size() * sizeof(Index3));
  }
  const auto add_memory = [&](EffectMemory copy) {
    for_each_memory(copy, [&](auto& pairs) {
      for (auto& pair : pairs) pair.visit([&](auto& value) { hash.add(&value, sizeof value); });
    });
  };
  add_memory(memory);
  for (const Cluster& c : clusters) {
    hash.add(c.local->data(), c.local->size() * sizeof(Vec3));
    hash.add(c.distance->data(), c.distance->size() * sizeof(int));
    for (int vertex : c.released) hash.add(&vertex, sizeof vertex);
    if (c.rest) {
      Rest rest = *c.rest;
      rest.visit([&](auto& value) { hash.add(&value, sizeof value); });
    }
    add_memory(*c.asleep);
  }
  if (sleepers) {
    hash.add(sleepers->body.data(), sleepers->body.size() * sizeof(int));
    hash.add(sleepers->local.data(), sleepers->local.size() * sizeof(Vec3));
    add_memory(sleepers->asleep);
  }
  if (glance) {
    hash.add(glance->x.data(), glance->x.size() * sizeof(Vec3));
    for (const Pose& pose : glance->body) hash.add(pose.rotation.data(), sizeof(Mat3)), hash.add(pose.position.data(), sizeof(Vec3));
    hash.add(glance->frame.data(), glance->frame.size() * sizeof(int));
  }
  return hash.text();
}

const BodyMass& body_mass(const World& world, const State& state, std::size_t body) {
  const auto first = static_cast<std::size_t>(world.first_cluster());
  return body < first ? world.assembly.bodies[body].mass : state.clusters[body - first].mass;
}

Vec3 vertex_position(const World& world, const State& state, std::size_t v) {
  if (v < state.x.size()) return state.x[v];
  const int b = world.assembly.owner[v].body;
  return b < 0 ? world.assembly.x[v] : apply(state.bodies[static_cast<std::size_t>(b)].pose, world.assembly.local[v]);
}
std::vector<Vec3> vertex_positions(const World& world, const State& state) {
  std::vector<Vec3> x;
  x.reserve(world.assembly.x.size());
  x.assign(state.x.begin(), state.x.end());
  for (std::size_t v = x.size(); v < world.assembly.x.size(); ++v) x.push_back(vertex_position(world, state, v));
  return x;
}

void close_grips(const World& world, State& state) {
  const Scene& scene = world.setup.scene;
  std::size_t spring = 0;
  for (std::size_t g = 0; g < scene.grips.size(); ++g) {
    const bool closes = state.grip_closed[g] == 0 && state.time >= scene.grips[g].start.at(state.events);
    if (closes) state.grip_closed[g] = 1;
    for (int v : world.assembly.grips[g].vertices) {
      if (closes) state.grip_base[spring] = vertex_position(world, state, static_cast<std::size_t>(v));
      ++spring;
    }
  }
}

Drive Drive::at(const World& world, const State& state, Real end, Real dt) {
  const Scene& scene = world.setup.scene;
  Drive drive;
  for (std::size_t g = 0; g < scene.grips.size(); ++g) {
    const Grip& grip = scene.grips[g];
    const Assembly::GripPart& part = world.assembly.grips[g];
    const bool closed = state.grip_closed[g] != 0 && end <= grip.end.at(state.events);
    for (std::size_t k = 0; k < part.vertices.size(); ++k) {
      drive.grip_target.push_back(state.grip_base[drive.grip_target.size()] + grip_offset(grip, end, state.events));
      drive.grip_stiffness.push_back(closed ? part.stiffness : 0);
    }
  }
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    const BodyPart& part = world.assembly.bodies[b];
    const BodyState& body = state.bodies[b];
    Pose target = body.pose;
    if (part.motion == Motion::driven) {
      const Pose mesh = driven_pose(scene.bodies[b], end);
      target = {mesh.rotation, apply(mesh, part.mesh_offset)};
    } else if (part.motion == Motion::dynamic) {
      target = {free_flight(body.pose.rotation, body.angular_momentum, body_mass(world, state, b).second, dt),
                body.pose.position + dt * body.velocity};
    }
    drive.body_target.push_back(target);
  }
  return drive;
}
}  // namespace tape
