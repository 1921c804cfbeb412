#include "apps/render/vertices.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tape/core/error.hpp"

namespace tape::render {
namespace {
std::uint8_t to_byte(Real value) { return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0))); }
std::array<std::uint8_t, 4> to_bytes(const Vec3& c, Real fourth) {
  return {to_byte(c.x()), to_byte(c.y()), to_byte(c.z()), to_byte(fourth)};
}
std::array<float, 3> to_floats(const Vec3& v) { return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())}; }

/// Triangles at each vertex: those of vertex v are list[start[v]] to list[start[v + 1]].
struct Fans {
  std::vector<std::size_t> start, list;
  explicit Fans(const Mesh& m) : start(m.vertices.size() + 1, 0), list(3 * m.triangles.size()) {
    for (const Index3& t : m.triangles)
      for (int v : t) ++start[static_cast<std::size_t>(v) + 1];
    for (std::size_t v = 0; v < m.vertices.size(); ++v) start[v + 1] += start[v];
    std::vector<std::size_t> next(start.begin(), start.end() - 1);
    for (std::size_t t = 0; t < m.triangles.size(); ++t)
      for (int v : m.triangles[t]) list[next[static_cast<std::size_t>(v)]++] = t;
  }
};

/// Normals of triangles, as long as twice their area [m^2].
std::vector<Vec3> face_normals(const Mesh& m) {
  std::vector<Vec3> normals;
  normals.reserve(m.triangles.size());
  const auto at = [&](int v) -> const Vec3& { return m.vertices[static_cast<std::size_t>(v)]; };
  for (const Index3& t : m.triangles) normals.push_back((at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])));
  return normals;
}

Vec3 corner_normal(const Fans& fans, const std::vector<Vec3>& normals, std::size_t triangle, std::size_t vertex, Real cos_crease) {
  const Vec3& own = normals[triangle];
  Vec3 sum = own;
  for (std::size_t k = fans.start[vertex]; k < fans.start[vertex + 1]; ++k) {
    const Vec3& other = normals[fans.list[k]];
    if (fans.list[k] != triangle && own.dot(other) >= cos_crease * own.norm() * other.norm()) sum += other;
  }
  return sum.squaredNorm() > 0 ? Vec3(sum.normalized()) : Vec3(Vec3::UnitZ());
}

void append(std::vector<DrawVertex>& corners, const Mesh& m, const Vec3& origin) {
  if (m.colors.size() != 1 && m.colors.size() != m.vertices.size())
    throw InputError("render: " + std::to_string(m.colors.size()) + " colours for " + std::to_string(m.vertices.size()) +
                     " vertices; allowed is 1 or one per vertex");
  const Fans fans(m);
  const std::vector<Vec3> normals = face_normals(m);
  const Real cos_crease = m.crease > 0 ? std::cos(m.crease * std::numbers::pi / 180) : 2;  // 2: no neighbour qualifies
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    for (int index : m.triangles[t]) {
      const auto v = static_cast<std::size_t>(index);
      const Vec3& front = m.colors[m.colors.size() == 1 ? 0 : v];
      corners.push_back({to_floats(m.vertices[v] - origin), to_floats(corner_normal(fans, normals, t, v, cos_crease)),
                         to_bytes(front, m.gloss), to_bytes(m.back_color.value_or(front), 0)});
    }
}
}  // namespace

Bounds bounds_of(const std::vector<Mesh>& meshes) {
  Bounds bounds;
  for (const Mesh& m : meshes)
    for (const Vec3& x : m.vertices) bounds.extend(x);
  return bounds.isEmpty() ? Bounds(Vec3(Vec3::Zero())) : bounds;
}

std::vector<DrawVertex> corners_of(const std::vector<Mesh>& meshes, const Vec3& origin) {
  std::vector<DrawVertex> corners;
  std::size_t triangles = 0;
  for (const Mesh& m : meshes) triangles += m.triangles.size();
  corners.reserve(3 * triangles);
  for (const Mesh& m : meshes) append(corners, m, origin);
  return corners;
}
}  // namespace tape::render
