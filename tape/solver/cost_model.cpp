#include "tape/solver/cost_model.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "tape/solver/host_blocks.hpp"
#include "tape/solver/rigid_groups.hpp"

namespace tape {
namespace {
// Measured by tests/bench/solver_bench.cpp on one thread of a 2.4-GHz core with AVX2, g++ 12, OpenBLAS 0.3.21 (README: cost model).
constexpr Real kBandRate = 14e9;            // [flop/s] band factorisation, kd near 50
constexpr Real kBorderRate = 4e9;           // [flop/s] couplings to the dense border: triangular solves, Schur complement
constexpr Real kStreamRate = 3e9;           // [flop/s] SpMV and triangular solves
constexpr Real kAnalysisPerBlock = 1e-6;    // [s] ordering and symbolic analysis per stored block
constexpr Real kFactorPerEntry = 40e-9;     // [s] Cholesky per entry of the envelope: assembly and small supernodes
constexpr Real kDenseRate = 60e9;           // [flop/s] Cholesky per flop of the envelope, of which dissection needs about half
constexpr Real kJacobiIterations = 800;     // typical of strips and rolls
constexpr Real kTwoLevelIterations = 60;    // of scenes with strips: 46 (drape), 47 (drum), 62 (capstan), 70 (peel_table)
constexpr Real kCoarsePerBlock = 100e-9;    // [s] P' A P per stored block of A
constexpr Real kExactIterations = 2;        // strip preconditioner, nothing dropped
constexpr Real kDropIterations = 8;         // ... some blocks dropped: so many,
constexpr Real kDropShareIterations = 500;  // ... and so many times the dropped share of all blocks

std::size_t at(int i) { return static_cast<std::size_t>(i); }

struct Graph {
  std::vector<int> begin, to;
};
/// @param for_edges  calls its argument with both directions of each edge, in the same order each time
template <class ForEdges>
Graph make_graph(int n, const ForEdges& for_edges) {
  Graph g;
  g.begin.assign(at(n) + 1, 0);
  for_edges([&](int i, int) { ++g.begin[at(i) + 1]; });
  for (int i = 0; i < n; ++i) g.begin[at(i) + 1] += g.begin[at(i)];
  g.to.resize(at(g.begin[at(n)]));
  std::vector<int> next(g.begin.begin(), g.begin.end() - 1);
  for_edges([&](int i, int j) { g.to[at(next[at(i)]++)] = j; });
  return g;
}

/// All blocks but those of bodies as a graph; bodies couple to many and are eliminated last.
Graph graph_without_bodies(const HostBlocks& a, const SystemLayout& layout) {
  std::vector<bool> body(at(a.n), false);
  for (int b : layout.body_blocks) body[at(b)] = body[at(b + 1)] = true;
  return make_graph(a.n, [&](auto&& f) {
    for (int i = 0; i < a.n; ++i)
      for (int k = a.row_begin[at(i)]; k < a.row_begin[at(i) + 1]; ++k)
        if (const int j = a.col[at(k)]; j != i && !body[at(i)] && !body[at(j)]) f(i, j), f(j, i);
  });
}

/// The same of the coarse space: its groups.
Graph graph_of_groups(const HostBlocks& a, const std::vector<RigidGroup>& groups) {
  const std::vector<int> group = group_of_blocks(groups, a.n);
  return make_graph(static_cast<int>(groups.size()), [&](auto&& f) {
    std::vector<int> last(groups.size(), -1);  // row of groups that met this one last
    for (int i = 0; i < a.n; ++i) {
      const int g = group[at(i)];
      if (g < 0 || groups[at(g)].body) continue;
      for (int k = a.row_begin[at(i)]; k < a.row_begin[at(i) + 1]; ++k)
        if (const int h = group[at(a.col[at(k)])]; h > g && !groups[at(h)].body && last[at(h)] != g) last[at(h)] = g, f(g, h), f(h, g);
    }
  });
}

/// Breadth-first order of the component of `root`, appended to `order`; place[i] is set for each.
void visit(const Graph& g, int root, std::vector<int>& order, std::vector<int>& place) {
  std::size_t head = order.size();
  place[at(root)] = static_cast<int>(order.size());
  order.push_back(root);
  for (; head < order.size(); ++head)
    for (int e = g.begin[at(order[head])]; e < g.begin[at(order[head]) + 1]; ++e)
      if (const int j = g.to[at(e)]; place[at(j)] < 0) {
        place[at(j)] = static_cast<int>(order.size());
        order.push_back(j);
      }
}

struct Envelope {
  Real seconds = 0, entries = 0;
};
/// Cholesky factorisation inside the envelope of the Cuthill-McKee order: near that of nested dissection on graphs that are long
/// and thin, as strips, folds and rolls are.
/// @param unknowns  of each node
Envelope envelope(const Graph& g, int unknowns) {
  const std::size_t n = g.begin.size() - 1;
  std::vector<int> order, place(n, -1);
  for (std::size_t i = 0; i < n; ++i) {
    if (place[i] >= 0) continue;
    const std::size_t first = order.size();
    visit(g, static_cast<int>(i), order, place);
    const int far = order.back();  // start again from the far end: a pseudo-peripheral block
    for (std::size_t k = first; k < order.size(); ++k) place[at(order[k])] = -1;
    order.resize(first);
    visit(g, far, order, place);
  }
  Envelope e;
  for (std::size_t i = 0; i < n; ++i) {
    int reach = 0;
    for (int k = g.begin[i]; k < g.begin[i + 1]; ++k) reach = std::max(reach, place[i] - place[at(g.to[at(k)])]);
    const Real width = unknowns * reach + unknowns - 1;
    e.entries += unknowns * width;
    e.seconds += unknowns * width * (kFactorPerEntry + width / kDenseRate);
  }
  return e;
}

struct Sizes {
  Real unknowns = 0, border = 0;  // of the strips, of the rest
  Real touched = 0;               // of the rest, those that couple to strips
  Real band_flops = 0, band_entries = 0;
  Real dropped = 0;  // blocks of the upper triangle outside the bands
};
Sizes strip_sizes(const HostBlocks& a, const SystemLayout& layout, const std::vector<int>& strip_of) {
  std::vector<int> end(at(a.n));  // of the profile of each row of a strip
  std::vector<bool> touched(at(a.n));
  Sizes s;
  for (const StripLayout& strip : layout.strips) {
    const std::vector<int> profile = fixed_profile(a, strip.first_block, strip.first_block + strip.blocks);
    for (int k = 0; k < strip.blocks; ++k) {
      end[at(strip.first_block + k)] = strip.first_block + profile[at(k)];
      const Real kd = 3.0 * (profile[at(k)] - 1 - k) + 2;
      s.band_flops += 3 * kd * kd;
      s.band_entries += 3 * kd;
    }
    s.unknowns += 3.0 * strip.blocks;
  }
  for (int i = 0; i < a.n; ++i)
    for (int k = a.row_begin[at(i)]; k < a.row_begin[at(i) + 1]; ++k) {
      const int j = a.col[at(k)], strip = strip_of[at(i)], other = strip_of[at(j)];
      if (strip >= 0 && other >= 0)
        s.dropped += strip != other || j >= end[at(i)];
      else if (strip >= 0 || other >= 0)
        touched[at(strip >= 0 ? j : i)] = true;
    }
  s.border = 3.0 * a.n - s.unknowns;
  s.touched = 3.0 * static_cast<Real>(std::ranges::count(touched, true));
  return s;
}
}  // namespace

LinearCosts linear_costs(const HostBlocks& a, const SystemLayout& layout) {
  std::vector<int> strip_of(at(a.n), -1);
  for (std::size_t s = 0; s < layout.strips.size(); ++s)
    for (int i = 0; i < layout.strips[s].blocks; ++i) strip_of[at(layout.strips[s].first_block + i)] = static_cast<int>(s);
  const Sizes s = strip_sizes(a, layout, strip_of);
  const Real blocks = static_cast<Real>(a.col.size()), multiply = 36 * blocks;
  const auto dense_border = [&](Real m, Real all) {
    return s.unknowns * m * m + all * all * all / 3;
  };  // [flop] Schur complement, its factor
  const Real sweep = 4 * (s.band_entries + s.unknowns * s.touched + s.border * s.border);
  const Real coarse_border = 6.0 * static_cast<Real>(layout.body_blocks.size());
  LinearCosts costs;
  costs.cholesky = kAnalysisPerBlock * blocks + envelope(graph_without_bodies(a, layout), 3).seconds +
                   dense_border(coarse_border, coarse_border) / kBorderRate;
  costs.pcg_jacobi = kJacobiIterations * (multiply + 18.0 * a.n) / kStreamRate;
  const Real iterations = s.dropped > 0 ? kDropIterations + kDropShareIterations * s.dropped / blocks : kExactIterations;
  costs.pcg_strip = s.band_flops / kBandRate + (2 * s.band_entries * s.touched + dense_border(s.touched, s.border)) / kBorderRate +
                    iterations * (multiply + sweep) / kStreamRate;
  const std::vector<RigidGroup> groups = rigid_groups(layout);
  const Real coarse_unknowns = 6.0 * static_cast<Real>(groups.size());
  const Envelope coarse = envelope(graph_of_groups(a, groups), 6);
  const Real coarse_solve = 4 * (coarse.entries + coarse_unknowns * coarse_border);
  costs.pcg_two_level = kCoarsePerBlock * blocks + coarse.seconds + coarse_unknowns * coarse_border * coarse_border / kBorderRate +
                        kTwoLevelIterations * (multiply + 66.0 * a.n + coarse_solve) / kStreamRate;
  return costs;
}

LinearKind choose(const HostBlocks& pattern, const SystemLayout& layout, bool strip_available) {
  const LinearCosts costs = linear_costs(pattern, layout);
  std::pair best(costs.cholesky, LinearKind::cholesky);
  best = std::min(best, {costs.pcg_jacobi, LinearKind::pcg_jacobi});
  if (layout.strips.empty()) return best.second;
  best = std::min(best, {costs.pcg_two_level, LinearKind::pcg_two_level});
  if (strip_available) best = std::min(best, {costs.pcg_strip, LinearKind::pcg_strip});
  return best.second;
}
}  // namespace tape
