#include "tape/model/scene.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tape {
Real Scene::dhat() const {
  if (contact.dhat > 0) return contact.dhat;
  Real smallest = 1e-3;
  for (const Strip& s : strips) smallest = std::min(smallest, films[static_cast<std::size_t>(s.film)].dhat);
  return smallest;
}

namespace {
Real value_or(const std::vector<MaterialPair>& pairs, int a, int b, Real fallback) {
  for (const MaterialPair& p : pairs)
    if ((p.a == a && p.b == b) || (p.a == b && p.b == a)) return p.value;
  return fallback;
}
}  // namespace

Real Scene::mu(int a, int b) const {
  return value_or(frictions, a, b, std::sqrt(materials[static_cast<std::size_t>(a)].mu * materials[static_cast<std::size_t>(b)].mu));
}

Real Scene::kappa(int a, int b) const { return value_or(barriers, a, b, contact.kappa); }

Adhesion Scene::adhesion(int first, int second) const {
  for (const AdhesivePair& p : adhesives) {
    if (p.a == first && p.b == second) return p.adhesion;
    if (p.a != second || p.b != first) continue;
    Adhesion turned = p.adhesion;
    std::swap(turned.sticks[0][1], turned.sticks[1][0]);
    return turned;
  }
  return {};
}

bool Scene::reduces(const Strip& strip) const { return strip.winding && model && is_reduced(*model); }

bool Scene::uses(AdhesionLaw law) const {
  return std::ranges::any_of(adhesives, [&](const AdhesivePair& p) { return p.adhesion.law == law; });
}
}  // namespace tape
