#include "tape/bodies/assembly.hpp"

#include <algorithm>
#include <cmath>

#include "tape/core/error.hpp"
#include "tape/model/mass_properties.hpp"

namespace tape {
namespace {
template <class T>
const T& at(const std::vector<T>& values, int i) {
  return values[static_cast<std::size_t>(i)];
}

int add_vertex(Assembly& a, const Vec3& x, VertexOwner owner, const Vec3& local = Vec3::Zero()) {
  a.x.push_back(x);
  a.v.push_back(Vec3::Zero());
  a.rest.push_back(Vec2::Zero());
  a.owner.push_back(owner);
  a.local.push_back(local);
  a.mass.push_back(0);
  return static_cast<int>(a.x.size()) - 1;
}

void add_strip(Assembly& a, const Scene& scene, const Strip& strip) {
  const Film& film = at(scene.films, strip.film);
  const StripMesh whole = make_strip_mesh(strip.mesh, film.width, scene.seed);
  const StripMesh& mesh = strip.remnant ? *strip.remnant : whole;
  const std::vector<Vec3> placed = place(whole, strip);
  const std::vector<int> now = survivors(whole, mesh);
  std::vector<Vec3> x(mesh.rest.size(), Vec3::Zero());
  for (std::size_t v = 0; v < placed.size(); ++v)
    if (now[v] >= 0) x[static_cast<std::size_t>(now[v])] = placed[v];
  StripPart part{.film = strip.film,
                 .first_vertex = static_cast<int>(a.x.size()),
                 .first_triangle = static_cast<int>(a.triangles.size()),
                 .vertices = static_cast<int>(x.size()),
                 .triangles = static_cast<int>(mesh.triangles.size()),
                 .columns = mesh.columns,
                 .hub = strip.winding ? strip.winding->hub : -1};
  for (std::size_t i = 0; i < x.size(); ++i) {
    const int v = add_vertex(a, x[i], {.block = a.blocks++, .body = -1});
    a.v[static_cast<std::size_t>(v)] = strip.velocity;
    a.rest[static_cast<std::size_t>(v)] = mesh.rest[i];
  }
  for (const Index3& t : mesh.triangles) {
    a.triangles.push_back(t.array() + part.first_vertex);
    const Vec2 e1 = at(mesh.rest, t[1]) - at(mesh.rest, t[0]), e2 = at(mesh.rest, t[2]) - at(mesh.rest, t[0]);
    const Real third = (e1.x() * e2.y() - e1.y() * e2.x()) / 6 * film.thickness * film.density;
    for (int i : t) a.mass[static_cast<std::size_t>(part.first_vertex + i)] += third;
  }
  a.strips.push_back(part);
}

BodyMass body_mass(const Body& body, Vec3& centre) {
  const MassProperties unit = body.solid ? *body.solid : mass_properties(body.mesh);
  if (!(unit.volume > 0)) throw InputError("body '" + body.name + "': a dynamic body needs a closed mesh with outward normals");
  centre = unit.centre;
  const Real density = body.mass > 0 ? body.mass / unit.volume : body.density;
  return {density * unit.volume, density * unit.second};
}

int index_of(const Scene& scene, const std::string& body) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    if (scene.bodies[b].name == body) return static_cast<int>(b);
  return -1;
}

/// First block of each body of the scene, -1 if it is fixed, then of the cluster of each reduced strip.
std::vector<int> number_bodies(Assembly& a, const Scene& scene) {
  std::vector<int> first;
  const auto number = [&](bool moves) {
    first.push_back(moves ? a.blocks : -1);
    a.blocks += moves ? 2 : 0;
  };
  for (const Body& body : scene.bodies) number(body.motion != Motion::fixed);
  for (const Strip& strip : scene.strips)
    if (scene.reduces(strip)) number(true);
  return first;
}

/// @throws InputError if a link is no linked body, is one of two articulations, or none has it
void add_articulations(Assembly& a, const Scene& scene) {
  std::vector<bool> free(scene.bodies.size());
  for (std::size_t b = 0; b < free.size(); ++b) free[b] = scene.bodies[b].motion == Motion::linked;
  for (const Articulation& articulation : scene.articulations) {
    ArticulationPart part{articulation.coordinates, a.blocks, (articulation.coordinates + 2) / 3, {}};
    if (part.coordinates < 1) throw InputError("articulation '" + articulation.name + "' has no coordinates");
    for (const std::string& link : articulation.links) {
      const int body = index_of(scene, link);
      if (body < 0 || !free[static_cast<std::size_t>(body)])
        throw InputError("articulation '" + articulation.name + "': '" + link + "' is no linked body, or not this one's alone");
      free[static_cast<std::size_t>(body)] = false;
      part.links.push_back(body);
    }
    a.blocks += part.blocks;
    a.articulations.push_back(std::move(part));
  }
  for (std::size_t b = 0; b < free.size(); ++b)
    if (free[b]) throw InputError("body '" + scene.bodies[b].name + "' is linked, but no articulation has it");
}

void add_body(Assembly& a, const Body& body, int index, int block) {
  BodyPart part;
  part.motion = body.motion;
  part.first_vertex = static_cast<int>(a.x.size());
  part.vertices = static_cast<int>(body.mesh.vertices.size());
  part.first_triangle = static_cast<int>(a.triangles.size());
  part.triangles = static_cast<int>(body.mesh.triangles.size());
  if (body.motion == Motion::dynamic) part.mass = body_mass(body, part.mesh_offset);
  part.block = block;
  part.start = {body.pose.rotation, apply(body.pose, part.mesh_offset)};
  part.velocity = body.velocity;
  part.angular_velocity = body.angular_velocity;
  for (const Vec3& y : body.mesh.vertices)
    add_vertex(a, apply(body.pose, y), {part.block, part.block < 0 ? -1 : index}, y - part.mesh_offset);
  for (const Index3& t : body.mesh.triangles) a.triangles.push_back(t.array() + part.first_vertex);
  a.bodies.push_back(part);
}

/// A point fixed to a body that no surface has.
int add_marker(Assembly& a, int body, const Vec3& x) {
  const BodyPart& part = at(a.bodies, body);
  return add_vertex(a, x, {part.block, part.block < 0 ? -1 : body}, part.start.rotation.transpose() * (x - part.start.position));
}

/// [vertices of the whole strip] what each is now, -1: cut away
std::vector<int> numbers(const Scene& scene, const Strip& strip) {
  const StripMesh whole = make_strip_mesh(strip.mesh, at(scene.films, strip.film).width, scene.seed);
  return survivors(whole, strip.remnant ? *strip.remnant : whole);
}

/// Vertices that a grip holds, but for those that were cut away; points of bodies become markers.
std::vector<int> held_vertices(Assembly& a, const Scene& scene, const Grip& grip) {
  std::vector<int> held;
  for (std::size_t s = 0; s < scene.strips.size(); ++s) {
    if (scene.strips[s].name != grip.what.object) continue;
    const StripPart& part = a.strips[s];
    const std::vector<int> now = numbers(scene, scene.strips[s]);
    for (int v : grip.what.vertices) {
      if (v < 0 || v >= std::ssize(now))
        throw InputError("grip '" + grip.name + "': strip '" + grip.what.object + "' has no vertex " + std::to_string(v));
      if (at(now, v) >= 0) held.push_back(part.first_vertex + at(now, v));
    }
    return held;
  }
  const int body = index_of(scene, grip.what.object);
  if (body < 0) throw InputError("grip '" + grip.name + "': no strip or body is named '" + grip.what.object + "'");
  if (at(scene.bodies, body).motion != Motion::dynamic)
    throw InputError("grip '" + grip.name + "': body '" + grip.what.object + "' is not dynamic");
  for (const Vec3& p : grip.what.points) held.push_back(add_marker(a, body, apply(at(scene.bodies, body).pose, p)));
  return held;
}

void add_grip(Assembly& a, const Scene& scene, const Grip& grip) {
  Assembly::GripPart part{.vertices = held_vertices(a, scene, grip), .anchors = {}, .stiffness = 0};
  if (part.vertices.empty()) throw InputError("grip '" + grip.name + "' holds nothing");
  const int to = grip.to.empty() ? -1 : index_of(scene, grip.to);
  if (!grip.to.empty() && to < 0) throw InputError("grip '" + grip.name + "': no body is named '" + grip.to + "'");
  for (int v : part.vertices) part.anchors.push_back(to < 0 ? -1 : add_marker(a, to, at(a.x, v)));
  part.stiffness = grip.stiffness / static_cast<Real>(part.vertices.size());
  a.grips.push_back(std::move(part));
}

/// @throws InputError if there is no such body, or it cannot turn
void add_axle(Assembly& a, const Scene& scene, const AxleJoint& axle) {
  const std::string name = "axle of '" + axle.body + "'";
  const int body = index_of(scene, axle.body), to = axle.to.empty() ? -1 : index_of(scene, axle.to);
  if (body < 0) throw InputError(name + ": no body has this name");
  if (!axle.to.empty() && to < 0) throw InputError(name + ": no body is named '" + axle.to + "'");
  const Body& turning = at(scene.bodies, body);
  if (turning.motion != Motion::dynamic) throw InputError(name + ": the body is not dynamic");
  Real reach = 0;
  for (const Vec3& y : turning.mesh.vertices) reach = std::max(reach, (y - axle.point).norm());
  const Vec3 u = axle.axis.normalized(), arm = u.unitOrthogonal();
  const Vec3 first = axle.point - reach * u;
  const auto on_body = [&](const Vec3& y) { return add_marker(a, body, apply(turning.pose, y)); };
  const auto on_base = [&](const Vec3& y) {
    const Vec3 x = apply(turning.pose, y);
    return to < 0 ? add_vertex(a, x, {-1, -1}) : add_marker(a, to, x);
  };
  a.axles.push_back({.end = {on_body(first), on_body(axle.point + reach * u)},
                     .seat = {on_base(first), on_base(axle.point + reach * u)},
                     .arm = on_body(first + reach * arm),
                     .dial = {on_base(first + reach * arm), on_base(first + reach * u.cross(arm))},
                     .stiffness = axle.params.stiffness});
}

/// Stiffness [N/m] of a grip or axle that names none: the weight of all that moves shifts it by ten micrometres, and pulling on a strip
/// stretches the strip a hundred times as much. Stiffer, what a stop rule leaves of the positions would read as newtons, and a grip that
/// moves by centimetres in a step would press what is in its way to gaps of nanometres before the rest of the scene gives way.
Real default_stiffness(const Assembly& a, const Scene& scene) {
  Real total = 0, strip = 0;
  for (Real m : a.mass) total += m;
  for (const Strip& s : scene.strips) {
    const Film& film = scene.films[static_cast<std::size_t>(s.film)];
    strip = std::max(strip, film.membrane_modulus * film.thickness * film.width / s.mesh.length);
  }
  return std::max(total * 9.81 / 1e-5, 1e2 * strip);
}

void choose_stiffness(Assembly& a, const Scene& scene) {
  for (Assembly::GripPart& grip : a.grips)
    if (grip.stiffness == 0) grip.stiffness = default_stiffness(a, scene) / static_cast<Real>(grip.vertices.size());
  for (Assembly::AxlePart& axle : a.axles)
    if (axle.stiffness == 0) axle.stiffness = default_stiffness(a, scene);
}
}  // namespace

int Assembly::cluster_body(int strip) const {
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (bodies[b].cluster_of == strip) return static_cast<int>(b);
  return -1;
}

Assembly assemble(const Scene& scene) {
  Assembly a;
  const std::vector<int> block = number_bodies(a, scene);
  add_articulations(a, scene);
  a.first_strip_block = a.blocks;
  for (const Strip& strip : scene.strips) add_strip(a, scene, strip);
  a.strip_vertices = static_cast<int>(a.x.size());
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) add_body(a, scene.bodies[b], static_cast<int>(b), block[b]);
  for (std::size_t s = 0; s < scene.strips.size(); ++s) {
    if (!scene.reduces(scene.strips[s])) continue;
    BodyPart cluster;
    cluster.motion = Motion::dynamic, cluster.cluster_of = static_cast<int>(s), cluster.block = block[a.bodies.size()];
    cluster.first_vertex = static_cast<int>(a.x.size()), cluster.first_triangle = static_cast<int>(a.triangles.size());
    a.bodies.push_back(cluster);
  }
  a.surface_vertices = static_cast<int>(a.x.size());
  for (std::size_t b = 0; b < a.bodies.size(); ++b) {
    if (a.bodies[b].block < 0) continue;
    a.bodies[b].centre = add_marker(a, static_cast<int>(b), a.bodies[b].start.position);
    a.mass[static_cast<std::size_t>(a.bodies[b].centre)] = a.bodies[b].mass.mass;
  }
  for (const Grip& grip : scene.grips) add_grip(a, scene, grip);
  for (const AxleJoint& axle : scene.axles) add_axle(a, scene, axle);
  choose_stiffness(a, scene);
  return a;
}
}  // namespace tape
