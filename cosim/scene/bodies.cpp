#include "cosim/scene/bodies.hpp"

#include "cosim/scene/pose.hpp"
#include "cosim/scene/shapes.hpp"
#include "tape/model/mesh_check.hpp"

namespace cosim {
namespace {
using tape::Body;
using tape::Motion;

/// Poses to be reached after the start pose; what one leaves out stays as in the one before.
void read_waypoints(const Reader& list, Body& body) {
  if (!list) return;
  if (body.motion != Motion::driven) list.fail("only a driven body has waypoints; this one is " + to_text(body.motion));
  body.waypoints.push_back({0, body.pose});
  for (const Reader& entry : list.items()) {
    const tape::Waypoint& last = body.waypoints.back();
    const Reader time = entry["time"];
    tape::Waypoint next{time.number(Range::above(0, 1e6), "s"), read_pose(entry, last.pose), entry["ease"].flag_or(false)};
    if (!(next.time > last.time)) time.fail("not after the waypoint ahead of it, at " + tape::to_text(last.time) + " s");
    body.waypoints.push_back(next);
  }
}

void read_velocities(const Reader& section, Body& body) {
  for (const char* key : {"velocity", "angular_velocity_deg"}) {
    const Reader value = section[key];
    if (value && body.motion == Motion::fixed) value.fail("a static body does not move");
    if (value && !body.waypoints.empty()) value.fail("the body follows its waypoints");
  }
  body.velocity = section["velocity"].vector_or(body.velocity, kPlace, "m/s");
  body.angular_velocity = kRadian * section["angular_velocity_deg"].vector_or(Vec3::Zero(), Range::closed(-1e6, 1e6), "deg/s");
}
}  // namespace

Body read_body(const Reader& section, const std::string& name, const std::filesystem::path& scene_file) {
  Body body;
  body.name = name;
  if (const Reader motion = section["motion"]) {
    body.motion = motion.choice<Motion>();
    if (body.motion == Motion::linked) motion.fail("only links of robots are; a body of the scene is static, driven or dynamic");
  }
  body.pose = read_pose(section);
  read_waypoints(section["waypoints"], body);
  read_velocities(section, body);
  const Reader density = section["density"], mass = section["mass"];
  if (density && mass) mass.fail("give either density or mass");
  body.density = density.number_or(body.density, Range::above(0, 1e6), "kg/m^3");
  body.mass = mass.number_or(body.mass, Range::above(0, 1e6), "kg");
  body.xi = section["xi"].number_or(body.xi, Range::closed(0, 0.1), "m");
  body.mesh = read_shape(section, scene_file);
  const Reader file = section["file"];
  const std::string mesh_name = section.where() + ": " + section.path() + (file ? " (" + file.text() + ")" : "");
  check_mesh(body.mesh, mesh_name, body.motion == Motion::dynamic);
  return body;
}
}  // namespace cosim
