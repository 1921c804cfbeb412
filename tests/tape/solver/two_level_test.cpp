#include "tape/solver/two_level.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "tape/core/execution.hpp"
#include "tape/math/rotation.hpp"
#include "tape/solver/linear_solver.hpp"
#include "tests/support/loaded_system.hpp"
using namespace tape;
using namespace tape::on_cpu;
using test::StripSystem;
using Loaded = test::LoadedSystem;

namespace {
using VectorMap = Eigen::Map<const Eigen::VectorXd>;

/// Inverses of the diagonal blocks: 6x6 for bodies, 3x3 for the rest.
Eigen::MatrixXd block_jacobi(const StripSystem& s, const Eigen::MatrixXd& a) {
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(3 * s.n, 3 * s.n);
  for (int i = 0; i < s.n; ++i) d.block<3, 3>(3 * i, 3 * i) = a.block<3, 3>(3 * i, 3 * i).inverse();
  for (int b : s.layout.body_blocks) d.block<6, 6>(3 * b, 3 * b) = a.block<6, 6>(3 * b, 3 * b).inverse();
  return d;
}

/// P (P' A P)^-1 P' with an orthonormal basis of the rigid motions of each group, whatever their number.
Eigen::MatrixXd coarse_correction(const StripSystem& s, const Eigen::MatrixXd& a) {
  const std::vector<RigidGroup> groups = rigid_groups(s.layout);
  Eigen::MatrixXd modes = Eigen::MatrixXd::Zero(3 * s.n, 6 * static_cast<Eigen::Index>(groups.size()));
  Eigen::Index column = 0;
  for (const RigidGroup& g : groups) {
    Eigen::MatrixXd moves(3 * g.blocks, 6);
    for (int i = 0; i < g.blocks; ++i) {
      const Vec3 arm = s.x[static_cast<std::size_t>(g.first + i)] - s.x[static_cast<std::size_t>(g.first)];
      moves.middleRows<3>(3 * i) << Mat3::Identity(), -skew(arm);
    }
    if (g.body) moves.setIdentity();
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(moves.rows(), 6);
    qr.setThreshold(1e-6).compute(moves);
    const Eigen::MatrixXd basis = Eigen::MatrixXd(qr.householderQ()).leftCols(qr.rank());
    modes.block(3 * g.first, column, basis.rows(), basis.cols()) = basis;
    column += basis.cols();
  }
  const Eigen::MatrixXd p = modes.leftCols(column);
  return p * (p.transpose() * a * p).ldlt().solve(p.transpose());
}

/// A strip, a body before a second strip, contacts inside groups, between them and with two bodies; the last blocks have no layout.
StripSystem everything() {
  StripSystem s;
  const int first = s.add_strip(13);
  const int hub = s.add_body(Vec3(10, 3, -4), 30);
  const int other = s.add_strip(11);
  const int box = s.add_body(Vec3(5, 3, 9), 2);
  for (int i = 0; i < 20; ++i) {
    s.add_contact(first + i, first + i + 1, Vec3(0, 0.6, 0.8), 1e3);
    s.add_contact(first + 3 * i, other + 2 * i, Vec3(0.36, 0.48, 0.8), 1e3);
    s.add_contact_to_body(40 + i, hub, Vec3(0.36, 0.48, 0.8), 1e4);
    s.add_contact_to_body(other + i, box, Vec3(0.6, 0, 0.8), 1e3);
  }
  const int loose = s.add_strip(3);
  s.layout.strips.pop_back();
  s.add_contact(loose, first, Vec3(0.6, 0, 0.8), 1e3);
  return s;
}

/// Points on straight lines and a point alone: rows of one, two and many vertices.
StripSystem degenerate() {
  StripSystem s;
  const int row = s.add_strip(1), line = s.add_strip(10), point = s.add_strip(1);
  s.layout.strips = {{row, 7, 7}, {line, 10, 1}, {line + 10, 60, 7}, {point, 1, 1}};
  for (int i = 0; i < 7; ++i) s.x[static_cast<std::size_t>(row + i)] = Vec3(0.3, 0.7 * i, 0.1);
  for (int i = 0; i < 10; ++i) s.x[static_cast<std::size_t>(line + i)] = Vec3(1, 2, 3) + 0.1 * i * Vec3(0.36, 0.48, 0.8);
  return s;
}
/// Ratios of a real roll at a time step of 10 ms: mass / dt^2 : bending : contact : membrane.
StripSystem weakly_held_roll() {
  StripSystem s;
  s.vertex_mass = 2e-4;
  s.add_roll(2, 10);
  return s;
}
}  // namespace

TEST(TwoLevel, ItIsBlockJacobiPlusTheGalerkinCorrectionOfRigidMotions) {
  for (const StripSystem& s : {everything(), degenerate()}) {
    const Eigen::MatrixXd a = s.dense(), inverse = block_jacobi(s, a) + coarse_correction(s, a);
    const Loaded loaded(s);
    TwoLevel m(s.layout);
    ASSERT_TRUE(m.build(loaded.matrix, loaded.points.span()));
    Buffer<Vec3> r(s.load()), z;
    z.resize(s.n);
    m.apply(r.span(), z.span());
    const Eigen::VectorXd expected = inverse * VectorMap(r.span()[0].data(), 3 * s.n);
    EXPECT_LT((VectorMap(z.span()[0].data(), 3 * s.n) - expected).norm(), 1e-9 * expected.norm());
  }
}

TEST(TwoLevel, ItHasTheSameBitsForAnyThreadsAnyOrderAndAnyPast) {
  const StripSystem s = everything();
  const Loaded loaded(s);
  const auto applied = [&](TwoLevel& m) {
    EXPECT_TRUE(m.build(loaded.matrix, loaded.points.span()));
    Buffer<Vec3> r(s.load()), z;
    z.resize(s.n);
    m.apply(r.span(), z.span());
    return z.download();
  };
  const auto fresh = [&] {
    TwoLevel m(s.layout);
    return applied(m);
  };
  const std::uint64_t order = shuffled_order();
  set_threads(1);
  const std::vector<Vec3> expected = fresh();
  for (int threads : {2, 8}) {
    set_threads(threads);
    EXPECT_EQ(fresh(), expected) << threads << " threads";
  }
  set_threads(0);
  set_shuffled_order(9);
  EXPECT_EQ(fresh(), expected) << "shuffled";
  set_shuffled_order(order);

  StripSystem other = s;  // other contacts, other positions
  for (int i = 0; i < 10; ++i) other.add_contact(2 * i, 60 + i, Vec3(0, 0.8, 0.6), 1e4);
  for (Vec3& p : other.x) p.z() += 0.1 * p.x() * p.y();
  const Loaded before(other);
  TwoLevel used(s.layout);
  EXPECT_TRUE(used.build(before.matrix, before.points.span()));
  EXPECT_EQ(applied(used), expected) << "after another system";
}

TEST(TwoLevel, GroupsTakeAllRowsOfAStripAndNeverFewerThanHalfTheirNumber) {
  for (int rows = 1; rows < 40; ++rows) {
    const SystemLayout layout{.strips = {{3, 7 * rows, 7}}, .body_blocks = {1, 3 + 7 * rows}};
    const std::vector<RigidGroup> groups = rigid_groups(layout);
    int next = 1;
    for (const RigidGroup& g : groups) {
      EXPECT_EQ(g.first, next);
      if (!g.body) {
        EXPECT_LE(g.blocks, 7 * kRowsPerGroup * 3 / 2);
        EXPECT_GE(2 * g.blocks, 7 * std::min(kRowsPerGroup, 2 * rows)) << rows;
      }
      next = g.first + g.blocks;
    }
    EXPECT_EQ(next, 3 + 7 * rows + 2);
  }
}

TEST(TwoLevel, WhereNoRowsAndNoBodiesAreKnownItIsBlockJacobi) {
  StripSystem s = everything();
  s.layout = {};
  const Loaded loaded(s);
  TwoLevel two_level(s.layout);
  BlockJacobi jacobi(s.layout);
  Buffer<Vec3> r(s.load()), z, expected;
  z.resize(s.n), expected.resize(s.n);
  for (const auto& [m, out] : {std::pair<Preconditioner*, Buffer<Vec3>*>(&two_level, &z), {&jacobi, &expected}}) {
    ASSERT_TRUE(m->build(loaded.matrix, loaded.points.span()));
    m->apply(r.span(), out->span());
  }
  EXPECT_EQ(z.download(), expected.download());
}

/// Negative along a rigid motion of ten rows, and nowhere on a diagonal block.
TEST(TwoLevel, NegativeCurvatureOfTheCoarseSpaceIsSeenBeforeAnyIteration) {
  StripSystem s;
  const int body = s.add_body(Vec3(10, 3, -4), 5);
  const int first = s.add_strip(30);
  for (int i = 0; i < 40; ++i) s.contact.add(first + i, body, 2 * Mat3::Identity());  // 5 - 40 (2)^2 / (1 + springs) < 0
  Loaded loaded(s);
  TwoLevel m(s.layout);
  BlockJacobi jacobi(s.layout);
  EXPECT_TRUE(jacobi.build(loaded.matrix, loaded.points.span()));
  EXPECT_FALSE(m.build(loaded.matrix, loaded.points.span()));
}

/// The trial that the method is from needed an eighth or less (11 to 56 iterations where block Jacobi needed 400 to 1200).
TEST(TwoLevel, ARoughLoadOnAWeaklyHeldRollTakesAnEighthOfTheIterationsOfBlockJacobiAtMost) {
  const StripSystem s = weakly_held_roll();
  const Loaded loaded(s);
  Buffer<Vec3> b(s.load()), x;
  x.resize(s.n);
  const auto iterations = [&](LinearKind kind) {
    LinearSolver solver({.linear = kind}, s.layout);
    const LinearReport report = solver.solve(loaded.matrix, loaded.points.span(), b.span(), x.span());
    EXPECT_TRUE(report.converged);
    return report.iterations;
  };
  EXPECT_LE(8 * iterations(LinearKind::pcg_two_level), iterations(LinearKind::pcg_jacobi));
}

/// Springs of a roll resist no rigid motion: A u = m u, so the load m u has the solution u.
TEST(TwoLevel, ARigidMotionOfAWeaklyHeldRollTakesAFewIterations) {
  const StripSystem s = weakly_held_roll();
  const Loaded loaded(s);
  for (const auto& [velocity, spin] : {std::pair(Vec3(1, -2, 0.5), Vec3(0, 0, 0)), std::pair(Vec3(0, 0, 0), Vec3(0.2, 1, -0.1))}) {
    const std::vector<Vec3> expected = s.rigid_motion(velocity, spin);
    std::vector<Vec3> load = expected;
    for (Vec3& f : load) f *= s.vertex_mass;
    Buffer<Vec3> b(load), x;
    x.resize(s.n);
    LinearSolver two_level({.linear = LinearKind::pcg_two_level}, s.layout), jacobi({.linear = LinearKind::pcg_jacobi}, s.layout);
    const LinearReport report = two_level.solve(loaded.matrix, loaded.points.span(), b.span(), x.span());
    EXPECT_TRUE(report.converged);
    EXPECT_LE(report.iterations, 10);
    const Eigen::VectorXd u = VectorMap(expected[0].data(), 3 * s.n), error = VectorMap(x.span()[0].data(), 3 * s.n) - u;
    EXPECT_LT(error.norm(), 1e-3 * u.norm());
    EXPECT_GE(jacobi.solve(loaded.matrix, loaded.points.span(), b.span(), x.span()).iterations, 10 * report.iterations);
  }
}
