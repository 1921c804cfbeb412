#include "tape/model/scene.hpp"

#include <algorithm>
#include <cmath>

namespace tape {
Real Scene::dhat() const {
  if (contact.dhat > 0) return contact.dhat;
  Real smallest = 1e-3;
  for (const Strip& s : strips) smallest = std::min(smallest, films[static_cast<std::size_t>(s.film)].dhat);
  return smallest;
}

Real Scene::mu(int a, int b) const {
  for (const FrictionPair& f : frictions)
    if ((f.a == a && f.b == b) || (f.a == b && f.b == a)) return f.mu;
  return std::sqrt(materials[static_cast<std::size_t>(a)].mu * materials[static_cast<std::size_t>(b)].mu);
}
}  // namespace tape
