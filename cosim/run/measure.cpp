#include "cosim/run/measure.hpp"

#include <algorithm>
#include <cmath>

#include "cosim/roll/roll_figures.hpp"
#include "cosim/run/attachment.hpp"

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

/// [m] of the strip, on its roll.
Real wound_length(const tape::World& world, const tape::State& state, std::size_t strip) {
  if (!world.setup.scene.strips[strip].winding) return 0;
  const auto figures = roll_figures(world, state, strip);
  return std::ranges::find(figures, "wound_length_m", [](const auto& figure) { return figure.first; })->second;
}
}  // namespace

double measure(const Claim& claim, const tape::World& world, const tape::State& state, const tape::StepReport& report,
               const JointPositions& joints) {
  const tape::Scene& scene = world.setup.scene;
  const auto thing = [&](std::size_t k) { return find_thing(claim.things[k], scene); };
  // Objects of the surface: strips, then bodies.
  const auto object = [&](std::size_t k) { return thing(k).strip ? *thing(k).strip : scene.strips.size() + *thing(k).body; };
  const auto direction = [&] { return Vec3(state.bodies[*thing(1).body].pose.rotation * claim.along); };
  switch (claim.quantity) {
    case Quantity::force:
      return force(thing(0), claim.things[0], world, report);
    case Quantity::height:
      return place(thing(0), world, state).z();
    case Quantity::speed:
      return speed(thing(0), world, state);
    case Quantity::distance:
      return (place(thing(0), world, state) - place(thing(1), world, state)).norm();
    case Quantity::joint:
      return joints.at(static_cast<std::size_t>(claim.robot))[claim.joint];
    case Quantity::attached:
      return attached_share(world, state, object(0), claim.things.size() > 1 ? std::optional(object(1)) : std::nullopt);
    case Quantity::seam:
      return covered_seam(world, state, object(0), object(1), object(2), direction());
    case Quantity::pieces:
      return pieces(world, object(0));
    case Quantity::turns:
      return attached_turns(world, state, object(0), wound_length(world, state, object(0)), place(thing(1), world, state), direction());
    case Quantity::wound:
      break;
  }
  return wound_length(world, state, object(0));
}
}  // namespace cosim
