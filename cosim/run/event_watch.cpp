#include "cosim/run/event_watch.hpp"

#include <algorithm>
#include <cmath>

namespace cosim {
namespace {
using tape::Real;
using tape::Vec3;

constexpr Real kEdge = 1e-9;  // [m]

Vec3 place(const Thing& thing, const tape::World& world, const tape::State& state) {
  if (thing.body) {
    const tape::BodyPart& part = world.assembly.bodies[*thing.body];
    return apply(state.bodies[*thing.body].pose, -part.mesh_offset);
  }
  const tape::StripPart& part = world.assembly.strips[*thing.strip];
  const Real end = thing.tip ? world.setup.scene.strips[*thing.strip].mesh.length : 0;
  Vec3 sum = Vec3::Zero();
  int n = 0;
  for (int v = part.first_vertex; v < part.first_vertex + part.vertices; ++v) {
    if (std::fabs(world.assembly.rest[static_cast<std::size_t>(v)].x() - end) > kEdge) continue;
    sum += state.x[static_cast<std::size_t>(v)];
    ++n;
  }
  return sum / n;
}

Real speed(const Thing& thing, const tape::World& world, const tape::State& state) {
  if (thing.body) return state.bodies[*thing.body].velocity.norm();
  const tape::StripPart& part = world.assembly.strips[*thing.strip];
  Real most = 0;
  for (int v = part.first_vertex; v < part.first_vertex + part.vertices; ++v)
    most = std::max(most, state.v[static_cast<std::size_t>(v)].norm());
  return most;
}

Real force(const Thing& thing, const std::string& name, const tape::World& world, const tape::StepReport& report) {
  if (thing.grip) return report.grip_force[*thing.grip].norm();
  for (std::size_t a = 0; a < report.articulations.size(); ++a) {
    const std::vector<std::string>& links = world.setup.scene.articulations[a].links;
    const auto it = std::ranges::find(links, name);
    if (it == links.end()) continue;
    const tape::LinkReport& link = report.articulations[a].links[static_cast<std::size_t>(it - links.begin())];
    return (link.normal.force + link.friction.force + link.adhesion.force + link.hold.force).norm();
  }
  return report.body_force[*thing.body].norm();
}
}  // namespace

double value_of(const Event& event, const tape::World& world, const tape::State& state, const tape::StepReport& report) {
  const Thing thing = find_thing(event.things[0], world.setup.scene);
  switch (event.quantity) {
    case Quantity::force:
      return force(thing, event.things[0], world, report);
    case Quantity::height:
      return place(thing, world, state).z();
    case Quantity::speed:
      return speed(thing, world, state);
    case Quantity::distance:
      break;
  }
  return (place(thing, world, state) - place(find_thing(event.things[1], world.setup.scene), world, state)).norm();
}

void note_events(const std::vector<Event>& events, const tape::World& world, const tape::StepReport& report, tape::State& state) {
  const Real round_off = 1e-6 * world.setup.scene.time.dt;
  for (std::size_t k = 0; k < events.size(); ++k) {
    const Event& event = events[k];
    const Real start = event.start.at(state.events);
    if (std::isfinite(state.events[k]) || !(state.time >= start - round_off)) continue;
    const Real value = value_of(event, world, state, report);
    const bool there = event.above ? value > event.level : value < event.level;
    if (there || state.time >= start + event.timeout - round_off) state.events[k] = state.time;
  }
}

}  // namespace cosim
