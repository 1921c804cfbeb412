#include "tape/model/mesh_check.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "tape/core/error.hpp"
#include "tape/core/settings.hpp"
#include "tape/model/mass_properties.hpp"

namespace tape {
namespace {
class Checker {
 public:
  Checker(const TriangleMesh& mesh, const std::string& name) : mesh_(mesh), name_(name) {}

  void vertices() const {
    if (mesh_.triangles.empty()) fail("has no triangles");
    for (std::size_t v = 0; v < mesh_.vertices.size(); ++v)
      if (!mesh_.vertices[v].allFinite()) fail("vertex " + std::to_string(v) + " is not finite: " + text(mesh_.vertices[v]));
    std::vector<bool> used(mesh_.vertices.size(), false);
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
      for (int v : mesh_.triangles[t]) {
        if (v < 0 || v >= static_cast<int>(used.size()))
          fail(triangle(t) + " names vertex " + std::to_string(v) + " of " + std::to_string(used.size()));
        used[v] = true;
      }
    if (const auto it = std::find(used.begin(), used.end(), false); it != used.end())
      fail("vertex " + std::to_string(it - used.begin()) + " belongs to no triangle");
  }
  void areas() const {
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const Vec3 a = corner(t, 0), ab = corner(t, 1) - a, ac = corner(t, 2) - a, bc = ac - ab;
      const Real side2 = std::max({ab.squaredNorm(), ac.squaredNorm(), bc.squaredNorm()});
      if (!(ab.cross(ac).norm() > 1e-9 * side2)) fail(triangle(t) + " is degenerate: no area, near " + text(a));
    }
  }
  void duplicates() const {
    std::vector<std::array<int, 4>> faces;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      Index3 v = mesh_.triangles[t];
      std::sort(v.begin(), v.end());
      faces.push_back({v[0], v[1], v[2], static_cast<int>(t)});
    }
    std::sort(faces.begin(), faces.end());
    for (std::size_t i = 0; i + 1 < faces.size(); ++i)
      if (std::equal(faces[i].begin(), faces[i].begin() + 3, faces[i + 1].begin()))
        fail(triangle(faces[i + 1][3]) + " is the same as triangle " + std::to_string(faces[i][3]));
  }
  void edges(bool closed) const {
    struct Side {
      int low, high, triangle;
      bool forward;
    };
    std::vector<Side> sides;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const int a = mesh_.triangles[t][k], b = mesh_.triangles[t][(k + 1) % 3];
        sides.push_back({std::min(a, b), std::max(a, b), static_cast<int>(t), a < b});
      }
    const auto key = [](const Side& s) { return std::array{s.low, s.high, s.triangle}; };
    std::sort(sides.begin(), sides.end(), [&](const Side& a, const Side& b) { return key(a) < key(b); });
    for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
      while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high) ++end;
      const std::string where = triangle(sides[i].triangle), edge = "the edge at " + text(mesh_.vertices[sides[i].low]);
      if (end - i > 2) fail(where + ": " + edge + " is not manifold: " + std::to_string(end - i) + " triangles meet there");
      if (end - i == 2 && sides[i].forward == sides[i + 1].forward)
        fail(where + " is oriented against its neighbour, triangle " + std::to_string(sides[i + 1].triangle));
      if (closed && end - i == 1) fail(where + ": " + edge + " is open; a body with a mass needs a closed surface");
    }
  }
  void volume() const {
    if (const Real volume = mass_properties(mesh_).volume; !(volume > 0))
      fail("triangle 0 and all others face inward: volume " + to_text(volume) + " m^3");
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const { throw InputError(name_ + ": " + reason); }
  static std::string triangle(std::size_t t) { return "triangle " + std::to_string(t); }
  static std::string text(const Vec3& v) { return "[" + to_text(v.x()) + ", " + to_text(v.y()) + ", " + to_text(v.z()) + "]"; }
  const Vec3& corner(std::size_t t, int k) const { return mesh_.vertices[mesh_.triangles[t][k]]; }
  const TriangleMesh& mesh_;
  const std::string& name_;
};
}  // namespace

void check_mesh(const TriangleMesh& mesh, const std::string& name, bool closed) {
  const Checker check(mesh, name);
  check.vertices();
  check.areas();
  check.duplicates();
  check.edges(closed);
  if (closed) check.volume();
}
}  // namespace tape
