#include "tape/cutting/pressure.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace tape {
BladePressureProbe::BladePressureProbe(const std::vector<Index3>& triangles, const std::vector<Real>& area, const std::vector<char>& sharp)
    : triangles_(triangles), area_(area), sharp_(sharp) {
  TAPE_CHECK(triangles.size() == area.size());
  int vertices = 0;
  for (const Index3& t : triangles) vertices = std::max(vertices, t.maxCoeff() + 1);
  begin_.assign(static_cast<std::size_t>(vertices) + 1, 0);
  for (const Index3& t : triangles)
    for (int v : t) ++begin_[v + 1];
  for (int v = 0; v < vertices; ++v) begin_[v + 1] += begin_[v];
  around_.resize(static_cast<std::size_t>(begin_.back()));
  std::vector<int> next = begin_;
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t)
    for (int v : triangles[t]) around_[next[v]++] = t;
}

BladePressure BladePressureProbe::measure(const std::vector<ContactPair>& pairs, const std::vector<Real>& force, const std::vector<Vec3>& x,
                                          Real threshold) const {
  TAPE_CHECK(pairs.size() == force.size());
  std::map<std::vector<int>, Real> load;  // by the sorted vertices of an element
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const int split = pairs[i].kind == PairKind::vertex_triangle ? 1 : 2;
    for (const auto& [first, end] : {std::pair(0, split), std::pair(split, 4)}) {
      if (!is_of_strip(pairs[i].v[first])) continue;
      const Real part = first == 0 ? sharp_part(pairs[i], x, split, 4) : sharp_part(pairs[i], x, 0, split);
      if (part == 0) continue;
      std::vector<int> element(pairs[i].v + first, pairs[i].v + end);
      std::sort(element.begin(), element.end());
      load[element] += part * force[i];
    }
  }
  BladePressure out;
  std::set<int> above;
  for (const auto& [element, newtons] : load) {
    const std::vector<int> triangles = triangles_at(element);
    TAPE_CHECK(!triangles.empty());
    Real area = 0;
    for (int t : triangles) area += element.size() == 3 ? area_[t] : area_[t] / 3;
    const Real pressure = newtons / area;
    if (out.triangle < 0 || pressure > out.peak) out.peak = pressure, out.triangle = triangles.front();
    if (pressure >= threshold) above.insert(triangles.begin(), triangles.end());
  }
  out.above.assign(above.begin(), above.end());
  return out;
}

std::vector<int> BladePressureProbe::triangles_at(const std::vector<int>& vertices) const {
  std::vector<int> found;
  for (int t : around(vertices.front())) {
    const Index3& corners = triangles_[t];
    const auto has = [&](int v) { return std::find(corners.begin(), corners.end(), v) != corners.end(); };
    if (std::all_of(vertices.begin(), vertices.end(), has)) found.push_back(t);
  }
  return found;
}

/// Share of the pair's force that sharp ones of its vertices [first, end) carry.
Real BladePressureProbe::sharp_part(const ContactPair& pair, const std::vector<Vec3>& x, int first, int end) const {
  const Vec3 at[4] = {x[pair.v[0]], x[pair.v[1]], x[pair.v[2]], x[pair.v[3]]};
  Real sum = 0;
  for (int k = first; k < end; ++k)
    if (sharp_[pair.v[k]]) sum += std::fabs(closest(pair.kind, at).weight[k]);
  return sum;
}
}  // namespace tape
