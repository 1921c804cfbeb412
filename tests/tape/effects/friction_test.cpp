#include "tape/effects/friction.inl"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <sstream>

#include "tape/math/rotation.hpp"
#include "tests/support/derivatives.hpp"
using namespace tape;

namespace {
/// One published state of contact with its lagged friction (tests/data/friction_reference.txt).
struct Published {
  Real mu, eps2, dhat2, kappa, energy;
  std::vector<Vec3> start, lagged, end;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
  struct Pair {
    ContactPair pair;
    int multiplicity;
    Real normal_force;
  };
  std::vector<Pair> pairs;
};

Vec3 read_vector(std::istream& in) {
  Vec3 v;
  in >> v.x() >> v.y() >> v.z();
  return v;
}

Published read_state(std::istream& in) {
  Published p;
  int vertices, pairs, entries;
  in >> p.mu >> p.eps2 >> p.dhat2 >> p.kappa >> p.energy >> vertices >> pairs >> entries;
  p.gradient.resize(3 * vertices);
  p.hessian = Eigen::MatrixXd::Zero(3 * vertices, 3 * vertices);
  for (int v = 0; v < vertices; ++v) {
    p.start.push_back(read_vector(in));
    p.lagged.push_back(read_vector(in));
    p.end.push_back(read_vector(in));
    p.gradient.segment<3>(3 * v) = read_vector(in);
  }
  for (int k = 0; k < pairs; ++k) {
    Published::Pair q{{{0, 0, 0, 0}, PairKind::vertex_triangle, 0, 0, std::sqrt(p.dhat2), 1, 1, 0, {}}, 1, 0};
    int edge_edge;
    for (int& v : q.pair.v) in >> v;
    in >> edge_edge >> q.multiplicity >> q.normal_force;
    if (edge_edge) q.pair.kind = PairKind::edge_edge;
    p.pairs.push_back(q);
  }
  for (int k = 0; k < entries; ++k) {
    int row, column;
    in >> row >> column;
    in >> p.hessian(row, column);
    p.hessian(column, row) = p.hessian(row, column);
  }
  return p;
}

std::vector<Published> published() {
  std::ifstream file(TAPE_SOURCE_DIR "/tests/data/friction_reference.txt");
  std::vector<Published> all;
  for (std::string word; file >> word;) {
    if (word == "state") {
      all.push_back(read_state(file));
    } else {
      file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');  // a comment
    }
  }
  return all;
}

Span<const Vec3> span(const std::vector<Vec3>& v) { return {v.data(), static_cast<int>(v.size())}; }

/// -db/dd of the barrier of the published states, b = -kappa (d^2 - dhat^2)^2 ln(d^2/dhat^2), once per multiplicity.
Real published_normal_force(const Published& p, int multiplicity, Real d) {
  const Real s = d * d, q = p.dhat2;
  const Real slope = -2 * (s - q) * std::log(s / q) - (s - q) * (s - q) / s;
  return -p.kappa * slope * 2 * d * multiplicity;
}

/// Friction elements of a published state with its normal forces, and where to evaluate them.
struct Lagged {
  std::vector<Friction::Element> elements;
  Friction friction;
  StateView view{};
  explicit Lagged(const Published& p) : friction{{}, std::sqrt(p.eps2), SlipFrame::fixed, {}} {
    view.dt = 1;
    view.x = view.x_start = span(p.lagged);
    view.mu = {&p.mu, 1};
    for (const Published::Pair& q : p.pairs) {
      Friction::Element e;
      EXPECT_TRUE(friction.lag(q.pair, view, e));
      e.limit = p.mu * q.normal_force;
      elements.push_back(e);
    }
    friction.elements = {elements.data(), static_cast<int>(elements.size())};
    view.x_start = span(p.start);
    view.x = span(p.end);
  }
  Lagged(const Lagged&) = delete;
  Lagged& operator=(const Lagged&) = delete;
};

/// One pair that slides by `slip` [m] along x over a triangle in the plane z = 0.
struct Slider {
  std::vector<Vec3> start, x;
  Real mu = 0.5;
  ContactPair pair{{0, 1, 2, 3}, PairKind::vertex_triangle, 0, 0, 1e-3, 1e6, 1e-6, 0, {}};
  std::vector<Friction::Element> elements;
  Friction friction{{}, 1e-4, SlipFrame::turning, {}};
  explicit Slider(Real slip) : start{{2e-4, 2e-4, 5e-4}, {0, 0, 0}, {1e-3, 0, 0}, {0, 1e-3, 0}}, x(start) {
    Friction::Element e;
    if (friction.lag(pair, view(1), e)) elements.push_back(e);
    friction.elements = {elements.data(), static_cast<int>(elements.size())};
    x[0].x() += slip;
  }
  StateView view(Real dt) const {
    StateView s{};
    s.dt = dt;
    s.x = span(x), s.x_start = span(start), s.mu = {&mu, 1};
    return s;
  }
  Real normal_force() const { return -BarrierLaw{1e6, 1e-3}.at(5e-4, 0, 1e-6).slope; }
};
}  // namespace

TEST(Friction, MatchesThePublishedStates) {
  const std::vector<Published> all = published();
  ASSERT_EQ(all.size(), 10u);
  for (std::size_t n = 0; n < all.size(); ++n) {
    SCOPED_TRACE(n);
    const Published& p = all[n];
    const Lagged l(p);
    Real energy = 0;
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(p.gradient.size());
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(p.gradient.size(), p.gradient.size());
    for (int i = 0; i < static_cast<int>(l.elements.size()); ++i) {
      const int(&v)[4] = l.elements[static_cast<std::size_t>(i)].lagged.v;
      energy += l.friction.energy(l.view, i);
      const VecN<12> g = l.friction.gradient(l.view, i);
      const MatN<12, 12> h = l.friction.hessian(l.view, i, HessianMode::exact);
      for (int a = 0; a < 4; ++a) {
        gradient.segment<3>(3 * v[a]) += g.segment<3>(3 * a);
        for (int b = 0; b < 4; ++b) hessian.block<3, 3>(3 * v[a], 3 * v[b]) += h.block<3, 3>(3 * a, 3 * b);
      }
    }
    EXPECT_NEAR(energy, p.energy, 1e-10 * std::abs(p.energy));
    EXPECT_LT((gradient - p.gradient).norm(), 1e-8 * p.gradient.norm() + 1e-14);
    EXPECT_LT((hessian - test::psd_part(p.hessian)).norm(), 1e-6 * p.hessian.norm());
  }
}
TEST(Friction, DistancesGiveThePublishedNormalForces) {
  for (const Published& p : published()) {
    for (const Published::Pair& q : p.pairs) {
      const Real d = PairState::at(q.pair, span(p.lagged)).d;
      EXPECT_NEAR(published_normal_force(p, q.multiplicity, d), q.normal_force, 1e-9 * q.normal_force);
    }
  }
}

TEST(Friction, AfterAnOvershootItsParabolaLiesAboveTheEnergyAndTouchesItWhereItIs) {
  for (const Real from : {2e-7, 5e-6, 1e-4}) {  // eps is 1e-6 m
    const Slider at(from);
    StateView s = at.view(0.01);
    s.overshot = true;
    const Real here = at.friction.energy(s, 0), slope = at.friction.gradient(s, 0)[0],
               curvature = at.friction.hessian(s, 0, HessianMode::exact)(0, 0);
    EXPECT_GE(test::smallest_eigenvalue(at.friction.hessian(s, 0, HessianMode::exact)), -1e-12 * curvature);
    for (const Real to : {-2e-4, -5e-6, -1e-7, 0.0, 3e-7, 2e-6, 3e-4}) {
      const Slider there(to);
      const Real step = to - from, parabola = here + slope * step + curvature / 2 * step * step;
      EXPECT_GE(parabola, there.friction.energy(there.view(0.01), 0) * (1 - 1e-12)) << from << " to " << to;
    }
  }
}
TEST(Friction, SlidingCostsMuTimesTheNormalForceWhateverTheTimeStep) {
  for (Real dt : {0.02, 0.01, 0.001}) {
    for (Real slip : {2.1e-6, 1e-4}) {  // beyond eps_v dt
      const Slider s(slip);
      const VecN<12> g = s.friction.gradient(s.view(dt), 0);
      EXPECT_NEAR(g[0], 0.5 * s.normal_force(), 1e-12 * s.normal_force());
      EXPECT_NEAR(s.friction.energy(s.view(dt), 0), 0.5 * s.normal_force() * slip, 1e-12 * s.normal_force() * slip);
    }
  }
}
TEST(Friction, APairThatTurnsAsAWholeDoesNotSlipInItsOwnFrame) {  // two layers of a roll that turns by 0.05 rad in a step
  for (SlipFrame frame : {SlipFrame::turning, SlipFrame::fixed}) {
    Slider s(0);
    s.friction.frame = frame;
    const Pose by{rotation_exp(Vec3(0, 0.05, 0)), Vec3(1e-3, 0, 2e-3)};
    for (Vec3& p : s.x) p = apply(by, p);
    const Vec2 slip = s.friction.slip(s.view(0.01), 0);
    EXPECT_NEAR(slip.norm(), frame == SlipFrame::turning ? 0 : 5e-4 * std::sin(0.05), 1e-15) << "distance times angle";
  }
}
TEST(Friction, BelowTheSmoothingSpeedTheForceGrowsFromNothing) {  // f1 = 2 r - r^2, r = speed/eps_v
  for (Real r : {0.0, 0.1, 0.5, 0.9}) {
    const Slider s(r * 1e-4 * 0.01);
    EXPECT_NEAR(s.friction.gradient(s.view(0.01), 0)[0], 0.5 * s.normal_force() * (2 * r - r * r), 1e-9 * s.normal_force()) << r;
  }
}
TEST(Friction, WithoutMuOrContactOrBetweenParallelEdgesThereIsNone) {
  Friction::Element e;
  Slider s(0);
  s.mu = 0;
  EXPECT_FALSE(s.friction.lag(s.pair, s.view(1), e));
  s.mu = 0.5;
  EXPECT_TRUE(s.friction.lag(s.pair, s.view(1), e));
  s.x[0].z() = 1.001e-3;
  EXPECT_FALSE(s.friction.lag(s.pair, s.view(1), e));
  s.x = {{0, 0, 5e-4}, {1e-3, 1e-5, 5e-4}, {0, 0, 0}, {1e-3, 0, 0}};
  const ContactPair edges{{0, 1, 2, 3}, PairKind::edge_edge, 0, 0, 1e-3, 1e6, 1e-6, 1e-3 * 1e-6 * 1e-6, {}};
  EXPECT_FALSE(s.friction.lag(edges, s.view(1), e));
}
TEST(Friction, IsNeededOnlyWhereSomethingCanTouchAndRub) {
  Scene scene;
  scene.strips.resize(1);
  EXPECT_NE(Friction::needed(scene, {}), "");
  scene.materials[0].mu = 0;
  EXPECT_EQ(Friction::needed(scene, {}), "");
  scene.frictions.push_back({0, 0, 0.3});
  EXPECT_NE(Friction::needed(scene, {}), "");
  scene.strips.clear();
  EXPECT_EQ(Friction::needed(scene, {}), "");
}
