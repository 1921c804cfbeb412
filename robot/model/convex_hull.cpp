#include "robot/model/convex_hull.hpp"

#include <LinearMath/btConvexHullComputer.h>
#include <fmt/format.h>
#include <unistd.h>

#include <Eigen/LU>
#include <fstream>
#include <optional>
#include <set>
#include <string_view>

#include "robot/model/inertia.hpp"

namespace robot {
namespace {
/// A hull as the cache keeps it: its vertices are given by their numbers in the input.
struct Hull {
  std::vector<int> points;
  std::vector<std::array<int, 3>> triangles;
};

Hull compute(const std::vector<Vec3>& points) {
  btConvexHullComputer computer;
  computer.compute(points.front().data(), sizeof(Vec3), static_cast<int>(points.size()), 0, 0);
  Hull hull;
  for (int v = 0; v < computer.original_vertex_index.size(); ++v) hull.points.push_back(computer.original_vertex_index[v]);
  for (int f = 0; f < computer.faces.size(); ++f) {
    const auto* first = &computer.edges[computer.faces[f]];
    const int apex = first->getSourceVertex();
    for (const auto* edge = first->getNextEdgeOfFace(); edge->getTargetVertex() != apex; edge = edge->getNextEdgeOfFace())
      hull.triangles.push_back({apex, edge->getSourceVertex(), edge->getTargetVertex()});
  }
  return hull;
}

/// Every edge belongs to two triangles, once in each direction.
bool is_closed(const std::vector<std::array<int, 3>>& triangles) {
  std::set<std::pair<int, int>> edges;
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (!edges.emplace(t[k], t[(k + 1) % 3]).second) return false;
  for (const auto& [a, b] : edges)
    if (!edges.contains({b, a})) return false;
  return !triangles.empty();
}

TriangleMesh mesh_of(const Hull& hull, const std::vector<Vec3>& points) {
  TriangleMesh mesh{{}, hull.triangles};
  for (int p : hull.points) mesh.vertices.push_back(points[static_cast<std::size_t>(p)]);
  return mesh;
}

std::filesystem::path file_of(const std::vector<Vec3>& points, const std::filesystem::path& cache) {
  const std::string_view bytes(reinterpret_cast<const char*>(points.data()), points.size() * sizeof(Vec3));
  return cache / fmt::format("hull-{:016x}-{}.txt", std::hash<std::string_view>{}(bytes), points.size());
}

/// Nothing if there is no such file, or it is not what `store` writes.
std::optional<Hull> stored(const std::filesystem::path& file, std::size_t point_count) {
  std::ifstream in(file);
  std::size_t nv = 0, nt = 0;
  const auto read = [&](int& i, std::size_t count) { return in >> i && i >= 0 && static_cast<std::size_t>(i) < count; };
  if (!(in >> nv >> nt) || nv > point_count || nt > 2 * nv) return {};
  Hull hull{std::vector<int>(nv), std::vector<std::array<int, 3>>(nt)};
  for (int& p : hull.points)
    if (!read(p, point_count)) return {};
  for (auto& t : hull.triangles)
    for (int& v : t)
      if (!read(v, nv)) return {};
  if (std::string end; !(in >> end) || end != "end" || !is_closed(hull.triangles)) return {};
  return hull;
}

/// Under a temporary name first, so that a reader never sees half a file. Without room for it the next call computes again.
void store(const Hull& hull, const std::filesystem::path& file) {
  std::error_code ignored;
  std::filesystem::create_directories(file.parent_path(), ignored);
  const std::filesystem::path temporary = file.parent_path() / fmt::format(".{}.{}", getpid(), file.filename().string());
  std::ofstream out(temporary);
  out << hull.points.size() << ' ' << hull.triangles.size() << '\n';
  for (int p : hull.points) out << p << '\n';
  for (const auto& [a, b, c] : hull.triangles) out << a << ' ' << b << ' ' << c << '\n';
  out << "end\n";
  out.close();
  if (out) std::filesystem::rename(temporary, file, ignored);
  std::filesystem::remove(temporary, ignored);
}

/// Bullet answers flat input with something, too.
void require_volume(const std::vector<Vec3>& points) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p / static_cast<Real>(points.size());
  if (!mean.allFinite()) throw InputError("convex hull: a point is not finite");
  Mat3 spread = Mat3::Zero();
  for (const Vec3& p : points) spread += (p - mean) * (p - mean).transpose();
  if (points.size() < 4 || principal_moments(spread).minCoeff() <= 1e-12 * spread.trace())
    throw InputError("convex hull: the points lie in one plane");
}
}  // namespace

TriangleMesh convex_hull(const std::vector<Vec3>& points) {
  require_volume(points);
  return mesh_of(compute(points), points);
}

ShrunkHull shrunk_hull(const std::vector<Vec3>& points, Real by) {
  constexpr Real kMost = 0.1;  // of the inner radius
  require_volume(points);
  btConvexHullComputer computer;
  ShrunkHull hull;
  hull.by = computer.compute(points.front().data(), sizeof(Vec3), static_cast<int>(points.size()), by, kMost);
  if (hull.by < 0 || computer.vertices.size() < 4) throw InputError("convex hull: nothing is left of it");
  for (int v = 0; v < computer.vertices.size(); ++v)
    hull.vertices.emplace_back(computer.vertices[v].x(), computer.vertices[v].y(), computer.vertices[v].z());
  return hull;
}

TriangleMesh convex_hull(const std::vector<Vec3>& points, const std::filesystem::path& cache) {
  if (cache.empty()) return convex_hull(points);
  require_volume(points);
  const std::filesystem::path file = file_of(points, cache);
  std::optional<Hull> hull = stored(file, points.size());
  if (!hull) store(hull.emplace(compute(points)), file);
  return mesh_of(*hull, points);
}
}  // namespace robot
