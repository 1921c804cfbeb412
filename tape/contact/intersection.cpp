#include "tape/contact/intersection.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>

#include "tape/contact/gap.hpp"
#include "tape/contact/search.hpp"
#include "tape/core/error.hpp"
#include "tape/core/settings.hpp"
#include "tape/math/predicates.hpp"

namespace tape {
namespace {
const Vec3& at(const std::vector<Vec3>& x, int v) { return x[static_cast<std::size_t>(v)]; }

Box box_of(const std::vector<Vec3>& x, std::span<const int> v) {
  Box b{at(x, v[0]), at(x, v[0])};
  for (int w : v) b = joined(b, {at(x, w), at(x, w)});
  return b;
}

/// [objects] whether one may meet another, by their boxes, or itself. A robot far from any tape has none to meet.
std::vector<bool> in_company(const SurfaceMesh& mesh, const std::vector<Vec3>& x, const on_cpu::detail::Carriers& carriers) {
  const std::size_t n = mesh.objects.size();
  std::vector<std::optional<Box>> box(n);
  std::vector<bool> company(n, false);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto object = static_cast<std::size_t>(mesh.vertices[static_cast<std::size_t>(mesh.triangles[i].v[0])].object);
    const Box b = box_of(x, mesh.triangles[i].v);
    box[object] = box[object] ? joined(*box[object], b) : b;
    if (carriers.triangle[i] == on_cpu::detail::kFree) company[object] = true;
  }
  for (std::size_t o = 0; o < n; ++o)
    for (std::size_t p = 0; p < n && !company[o]; ++p)
      company[o] = p != o && box[o] && box[p] && !mesh.kept_apart(static_cast<int>(o), static_cast<int>(p)) &&
                   (box[o]->low.array() <= box[p]->high.array()).all() && (box[p]->low.array() <= box[o]->high.array()).all();
  return company;
}

/// Triangles of one body that has many, or of all the others.
struct Planted {
  int carrier = on_cpu::detail::kFree;
  on_cpu::BoxTree tree;
};
template <class Alone>
std::vector<Planted> plant(const SurfaceMesh& mesh, const std::vector<Vec3>& x, const on_cpu::detail::Carriers& carriers,
                           const Alone& alone) {
  constexpr std::size_t kMany = 1000;
  std::map<int, std::vector<int>> of_carrier;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (!alone(mesh.triangles[i].v[0])) of_carrier[std::max(carriers.triangle[i], on_cpu::detail::kFree)].push_back(static_cast<int>(i));
  std::vector<int>& rest = of_carrier[on_cpu::detail::kFree];
  for (auto& [carrier, ids] : of_carrier)
    if (carrier >= 0 && ids.size() < kMany) rest.insert(rest.end(), ids.begin(), ids.end()), ids.clear();
  std::vector<Planted> out;
  for (const auto& [carrier, ids] : of_carrier) {
    if (ids.empty()) continue;
    std::vector<Lanes> boxes;
    for (int i : ids) {
      const auto k = static_cast<std::size_t>(i);
      boxes.push_back(stored_box(box_of(x, mesh.triangles[k].v), i, carriers.triangle[k] == on_cpu::detail::kFixed));
    }
    out.push_back({carrier, {}});
    const on_cpu::Buffer<Lanes> stored(boxes);
    const on_cpu::Buffer<int> stored_ids(ids);
    out.back().tree.build(stored.span(), stored_ids.span());
  }
  return out;
}

/// Where the edge comes closest to the triangle: good enough to find the place.
Vec3 meeting_point(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const Real hp = std::fabs(n.dot(p - a)), hq = std::fabs(n.dot(q - a));
  return hp + hq > 0 ? Vec3((hq * p + hp * q) / (hp + hq)) : Vec3(0.5 * (p + q));
}

std::string position_text(const Vec3& p) { return "(" + to_text(p.x()) + ", " + to_text(p.y()) + ", " + to_text(p.z()) + ") m"; }

/// "table triangle 0-1-2", vertices numbered from the first of the object.
std::string primitive_text(const SurfaceMesh& mesh, std::span<const int> v) {
  constexpr const char* kNames[] = {"vertex", "edge", "triangle"};
  const int object = mesh.vertices[static_cast<std::size_t>(v[0])].object;
  const auto first = std::ranges::find(mesh.vertices, object, &SurfaceVertex::object) - mesh.vertices.begin();
  std::string text = mesh.objects[static_cast<std::size_t>(object)] + " " + kNames[v.size() - 1];
  for (std::size_t k = 0; k < v.size(); ++k) text += (k == 0 ? " " : "-") + std::to_string(v[k] - first);
  return text;
}

void require_finite(const std::vector<Vec3>& x, const SurfaceMesh& mesh) {
  for (std::size_t v = 0; v < x.size(); ++v)
    if (const int id[] = {static_cast<int>(v)}; !x[v].allFinite())
      throw InputError("start: " + primitive_text(mesh, id) + " is at " + position_text(x[v]));
}
}  // namespace

Intersections find_intersections(const SurfaceMesh& mesh, const std::vector<Vec3>& x, int keep) {
  return find_intersections(mesh, mesh.owner, x, keep);
}

Intersections find_intersections(const SurfaceMesh& mesh, const std::vector<VertexOwner>& owner, const std::vector<Vec3>& x, int keep) {
  const on_cpu::detail::Carriers carriers(mesh, owner);
  const std::vector<bool> company = in_company(mesh, x, carriers);
  const auto object = [&](int v) { return mesh.vertices[static_cast<std::size_t>(v)].object; };
  const auto alone = [&](int v) { return !company[static_cast<std::size_t>(object(v))]; };
  const std::vector<Planted> trees = plant(mesh, x, carriers, alone);

  std::vector<std::vector<int>> met(mesh.edges.size());  // triangles
  on_cpu::parallel_for(static_cast<int>(met.size()), [&](int i) {
    const auto& e = mesh.edges[static_cast<std::size_t>(i)].v;
    if (alone(e[0])) return;
    const int carrier = carriers.edge[static_cast<std::size_t>(i)];
    const Vec3 &p = at(x, e[0]), &q = at(x, e[1]);
    std::vector<int>& triangles = met[static_cast<std::size_t>(i)];
    const auto meets = [&](int j) {
      const auto& t = mesh.triangles[static_cast<std::size_t>(j)].v;
      const bool shared = std::ranges::any_of(t, [&](int v) { return v == e[0] || v == e[1]; });
      const bool together = carrier != on_cpu::detail::kFree && carrier == carriers.triangle[static_cast<std::size_t>(j)];
      return !shared && !together && !mesh.kept_apart(object(e[0]), object(t[0])) &&
             segment_meets_triangle(p, q, at(x, t[0]), at(x, t[1]), at(x, t[2]));
    };
    const Lanes query = query_box(box_of(x, e), 0, carrier == on_cpu::detail::kFixed);
    for (const Planted& planted : trees)
      if (carrier < 0 || carrier != planted.carrier)
        planted.tree.view().visit(query, [&](int j) {
          if (meets(j)) triangles.push_back(j);
        });
    std::ranges::sort(triangles);
  });

  Intersections found;
  for (std::size_t i = 0; i < met.size(); ++i) {
    for (int j : met[i]) {
      if (found.count++ >= keep) continue;
      const auto& e = mesh.edges[i].v;
      const auto& t = mesh.triangles[static_cast<std::size_t>(j)].v;
      found.first.push_back({static_cast<int>(i), j, meeting_point(at(x, e[0]), at(x, e[1]), at(x, t[0]), at(x, t[1]), at(x, t[2]))});
    }
  }
  return found;
}

std::string description(const SurfaceMesh& mesh, const Crossing& crossing) {
  return primitive_text(mesh, mesh.edges[static_cast<std::size_t>(crossing.edge)].v) + " and " +
         primitive_text(mesh, mesh.triangles[static_cast<std::size_t>(crossing.triangle)].v) + " at " + position_text(crossing.where);
}

std::string description(const SurfaceMesh& mesh, const ContactPair& pair, const std::vector<Vec3>& x) {
  const std::size_t n = pair.kind == PairKind::vertex_triangle ? 1 : 2;
  const std::span<const int> v = pair.v;
  const Vec3 y[4] = {at(x, v[0]), at(x, v[1]), at(x, v[2]), at(x, v[3])};
  const Closest c = closest(pair.kind, y);
  Vec3 where = Vec3::Zero();  // weights of the first primitive sum to one
  for (std::size_t k = 0; k < n; ++k) where += c.weight[k] * y[k];
  return primitive_text(mesh, v.first(n)) + " and " + primitive_text(mesh, v.subspan(n)) + " at " + position_text(where);
}

void check_start(const std::vector<Vec3>& x, const SurfaceMesh& mesh, Real dhat, const std::vector<VertexTriangle>& bonded) {
  require_finite(x, mesh);
  if (const Intersections found = find_intersections(mesh, x, 1); found.count > 0)
    throw InputError("start: " + std::to_string(found.count) + (found.count == 1 ? " intersection: " : " intersections, the first: ") +
                     description(mesh, found.first[0]));
  using on_cpu::Buffer;
  const Buffer<Vec3> positions(x);
  const Buffer<VertexOwner> owner(std::vector<VertexOwner>(x.size()));  // as if nothing moved
  on_cpu::ContactSearch search(mesh, dhat, dhat);
  search.set_bonded(bonded);
  search.update({positions.span(), owner.span(), {}, {}}, 0);
  const SmallestGap smallest = on_cpu::smallest_gap(search.candidates(), positions.span());
  if (smallest.gap > 0) return;
  const ContactPair& pair = search.candidates()[smallest.pair];
  throw InputError("start: gap " + to_text(smallest.gap) + " m (distance less both half-thicknesses, " + to_text(pair.xi) + " m) between " +
                   description(mesh, pair, x));
}
}  // namespace tape
