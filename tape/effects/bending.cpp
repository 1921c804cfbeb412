#include "tape/effects/bending.hpp"

#include <map>
#include <utility>

#include "tape/effects/bending_stiffness.hpp"

namespace tape {
namespace {
/// The triangles of a strip with their neighbours.
struct StripPatch {
  std::vector<Bending::Element> elements;  ///< without stiffness
  std::vector<FlatTriangle> flat;
  int edges = 0;
};

StripPatch find_neighbours(const Assembly& assembly, const StripPart& strip) {
  const auto corner = [&](int t, int k) { return assembly.triangles[static_cast<std::size_t>(t)][k % 3]; };
  const auto X = [&](int v) { return assembly.rest[static_cast<std::size_t>(v)]; };
  const int end = strip.first_triangle + strip.triangles;
  std::map<std::pair<int, int>, int> apex;  // of the triangle on the left of a directed edge
  for (int t = strip.first_triangle; t < end; ++t)
    for (int k = 0; k < 3; ++k) apex[{corner(t, k + 1), corner(t, k + 2)}] = corner(t, k);
  StripPatch patch;
  std::map<std::pair<int, int>, int> edge;  // id of an edge by its smaller and larger vertex
  for (int t = strip.first_triangle; t < end; ++t) {
    Bending::Element e{};
    FlatTriangle f{};
    for (int k = 0; k < 3; ++k) {
      const int a = corner(t, k + 1), b = corner(t, k + 2);
      const auto across = apex.find({b, a});
      f.inner[k] = across != apex.end();
      e.v[k] = corner(t, k);
      e.v[3 + k] = f.inner[k] ? across->second : e.v[k];
      f.X[k] = X(e.v[k]), f.apex[k] = X(e.v[3 + k]);
      f.edge[k] = edge.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(edge.size())).first->second;
      f.side[k] = a < b ? 1 : -1;
    }
    patch.elements.push_back(e);
    patch.flat.push_back(f);
  }
  patch.edges = static_cast<int>(edge.size());
  return patch;
}

std::vector<Mat3> stiffness_of(const StripPatch& patch, BendingLaw law) {
  if (law == BendingLaw::shape_operator) return plate_stiffness(patch.flat, patch.edges);
  std::vector<Mat3> K;
  for (const FlatTriangle& t : patch.flat) K.push_back(hinge_stiffness(t));
  return K;
}
}  // namespace

std::string Bending::needed(const Scene& scene, const Params&) {
  for (const Strip& s : scene.strips)
    if (scene.films[static_cast<std::size_t>(s.film)].bending_modulus > 0) return "film.bending_modulus";
  return "";
}

Bending Bending::build(const Scene& scene, const Assembly& assembly, const Params& params, std::vector<Element>& elements) {
  for (const StripPart& strip : assembly.strips) {
    const Film& film = scene.films[static_cast<std::size_t>(strip.film)];
    if (film.bending_modulus == 0) continue;
    StripPatch patch = find_neighbours(assembly, strip);
    const std::vector<Mat3> K = stiffness_of(patch, params.law);
    for (std::size_t t = 0; t < K.size(); ++t) {
      Eigen::Map<Mat3>(&patch.elements[t].K[0][0]) = film.plate_stiffness() * K[t];
      elements.push_back(patch.elements[t]);
    }
  }
  return {};
}
}  // namespace tape
