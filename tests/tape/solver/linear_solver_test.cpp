#include "tape/solver/linear_solver.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <functional>

#include "tests/support/loaded_system.hpp"
using namespace tape;
using namespace tape::on_cpu;
using test::StripSystem;

namespace {
constexpr LinearKind kKinds[] = {LinearKind::cholesky, LinearKind::pcg_jacobi, LinearKind::pcg_strip, LinearKind::pcg_two_level};

struct Loaded : test::LoadedSystem {
  using LoadedSystem::LoadedSystem;
  LinearReport solve(LinearSolver& solver) { return solver.solve(matrix, points.span(), b.span(), x.span()); }
};

LinearReport solve(const StripSystem& s, LinearParams params) {
  Loaded a(s);
  LinearSolver solver(params, s.layout);
  return a.solve(solver);
}

StripSystem strip(int rows) {
  StripSystem s;
  s.add_strip(rows);
  return s;
}
StripSystem folded(int rows, Real k) {
  StripSystem s = strip(rows);
  s.fold(0, rows, k);
  return s;
}
/// Every vertex touches three of the next layer, 20 rows on.
StripSystem roll(int rows) {
  StripSystem s = strip(rows);
  for (int r = 0; r + 21 < rows; ++r)
    for (int c = 0; c < 7; ++c)
      for (int d = -1; d <= 1; ++d) s.add_contact(7 * r + c, 7 * (r + 20 + d) + c, Vec3(0.28 * d, 0, 0.96), 1e4);
  return s;
}
/// A strip, a body before a second strip, contacts inside the band, outside it, between the strips and with two bodies.
StripSystem everything() {
  StripSystem s = strip(30);
  const int hub = s.add_body(Vec3(10, 3, -4), 30);
  const int other = s.add_strip(20);
  const int box = s.add_body(Vec3(5, 3, 9), 2);
  s.fold(0, 30, 1e4);
  for (int i = 0; i < 20; ++i) {
    s.add_contact(i, i + 1, Vec3(0, 0.6, 0.8), 1e3);
    s.add_contact(3 * i, other + 5 * i, Vec3(0.36, 0.48, 0.8), 1e3);
    s.add_contact_to_body(40 + i, hub, Vec3(0.36, 0.48, 0.8), 1e4);
    s.add_contact_to_body(other + i, box, Vec3(0.6, 0, 0.8), 1e3);
  }
  return s;
}

using VectorMap = Eigen::Map<const Eigen::VectorXd>;
}  // namespace

TEST(LinearSolver, EverySolverFindsTheSolutionOfDenseLdlt) {
  for (const StripSystem& s : {strip(20), folded(40, 1e5), everything()}) {
    const Eigen::MatrixXd a = s.dense();
    Loaded loaded(s);
    const Eigen::VectorXd expected = a.ldlt().solve(VectorMap(loaded.b.span()[0].data(), 3 * s.n));
    const Real norm = std::sqrt(expected.dot(a * expected));
    for (LinearKind kind : kKinds)
      for (Real tolerance : {1e-3, 1e-6}) {
        LinearSolver solver({.linear = kind, .pcg_tol = tolerance}, s.layout);
        const LinearReport report = loaded.solve(solver);
        const Eigen::VectorXd error = VectorMap(loaded.x.span()[0].data(), 3 * s.n) - expected;
        EXPECT_TRUE(report.converged) << report.solver;
        EXPECT_LT(std::sqrt(error.dot(a * error)) / norm, kind == LinearKind::cholesky ? 1e-9 : tolerance) << report.solver << ", " << s.n;
      }
  }
}

TEST(LinearSolver, CholeskyIsSupernodalForARollAndSolvesIt) {
  const StripSystem s = roll(200);
  Loaded a(s);
  LinearSolver cholesky({.linear = LinearKind::cholesky}, s.layout), jacobi({.linear = LinearKind::pcg_jacobi, .pcg_tol = 1e-10}, s.layout);
  const LinearReport report = a.solve(cholesky);
  EXPECT_EQ(report.solver, "cholesky_supernodal");
  EXPECT_LT(report.relative_residual, 1e-9);
  const std::vector<Vec3> direct = a.x.download();
  ASSERT_TRUE(a.solve(jacobi).converged);
  EXPECT_LT((VectorMap(direct[0].data(), 3 * s.n) - VectorMap(a.x.span()[0].data(), 3 * s.n)).norm(),
            1e-6 * VectorMap(direct[0].data(), 3 * s.n).norm());
}

TEST(LinearSolver, TheStripPreconditionerIsExactWithoutEntriesOutsideItsBands) {
  StripSystem s;
  const int before = s.add_body(Vec3(100, 3, -4), 30);  // bodies stand on both sides of their couplings
  const int first = s.add_strip(200);
  const int behind = s.add_body(Vec3(50, 3, 9), 20);
  for (int i = 0; i < 100; ++i) {
    s.add_contact_to_body(first + 7 * 90 + i, before, Vec3(0.36, 0.48, 0.8), 1e5);
    s.add_contact_to_body(first + 7 * 40 + i, behind, Vec3(0.36, 0.48, 0.8), 1e5);
    s.add_contact(first + i, first + i + 9, Vec3(0.6, 0, 0.8), 1e4);
  }
  const LinearReport report = solve(s, {.linear = LinearKind::pcg_strip});
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.dropped, 0);
  EXPECT_LE(report.iterations, 3);
}

TEST(LinearSolver, TheStripPreconditionerNeedsAThirdOfTheIterationsOfBlockJacobiAtMost) {
  StripSystem sparse = strip(1000);
  for (int i = 0; i < 30; ++i) sparse.add_contact(7 * 10 * i, 7 * (999 - 12 * i), Vec3(0.6, 0, 0.8), 1e4);
  for (const StripSystem& s : {strip(1000), sparse, folded(1000, 1e2), folded(1000, 1e5)}) {
    const LinearReport strip_report = solve(s, {.linear = LinearKind::pcg_strip}), jacobi = solve(s, {.linear = LinearKind::pcg_jacobi});
    EXPECT_TRUE(strip_report.converged && jacobi.converged);
    EXPECT_LE(3 * strip_report.iterations, jacobi.iterations);
  }
}

TEST(LinearSolver, ATighterToleranceTakesMoreIterations) {
  const StripSystem s = folded(100, 1e5);
  for (LinearKind kind : {LinearKind::pcg_jacobi, LinearKind::pcg_strip, LinearKind::pcg_two_level}) {
    int last = 0;
    for (Real tolerance : {1e-2, 1e-4, 1e-6}) {
      const LinearReport report = solve(s, {.linear = kind, .pcg_tol = tolerance});
      EXPECT_GT(report.iterations, last);
      EXPECT_LE(report.error_estimate, tolerance);
      last = report.iterations;
    }
  }
}

TEST(LinearSolver, AnIndefiniteMatrixIsReportedByEverySolver) {
  const StripSystem definite = everything();
  const auto indefinite = [&](int block, const Vec3& direction) {
    StripSystem s = definite;
    s.contact.add(block, block, -2e5 * direction * direction.transpose());
    return s;
  };
  for (const StripSystem& s : {indefinite(33, Vec3::UnitZ()), indefinite(definite.layout.body_blocks[0] + 1, Vec3::UnitX())})
    for (LinearKind kind : kKinds) {
      const LinearReport report = solve(s, {.linear = kind});
      EXPECT_TRUE(report.negative_curvature) << report.solver;
      EXPECT_FALSE(report.converged) << report.solver;
    }
}

TEST(LinearSolver, NegativeCurvatureThatNoDiagonalBlockShowsIsReportedByEverySolver) {
  for (StripSystem s : {strip(200), roll(200)}) {  // simplicial and supernodal Cholesky
    for (int i = 0; i < 7; ++i)  // pushes rows 50 and 51 apart by more than the membrane holds; the blocks on the diagonal stay definite
      for (int j = 0; j < 7; ++j) s.contact.add(7 * 50 + i, 7 * 51 + j, 300 * Mat3::Identity());
    Loaded a(s);
    std::vector<Vec3> apart(static_cast<std::size_t>(s.n), Vec3::Zero());
    for (std::size_t i = 0; i < 7; ++i) apart[7 * 50 + i] = Vec3::UnitY(), apart[7 * 51 + i] = -Vec3::UnitY();
    Buffer<Vec3> p(apart);
    a.matrix.multiply(p.span(), a.x.span());
    Real curvature = 0;
    for (int i = 0; i < s.n; ++i) curvature += p.span()[i].dot(a.x.span()[i]);
    ASSERT_LT(curvature, 0);
    for (LinearKind kind : kKinds) EXPECT_TRUE(solve(s, {.linear = kind}).negative_curvature) << to_text(kind);
  }
}

TEST(LinearSolver, TheIterationCapIsReported) {
  const LinearReport report = solve(strip(100), {.linear = LinearKind::pcg_jacobi, .pcg_iterations = 5});
  EXPECT_EQ(report.iterations, 5);
  EXPECT_FALSE(report.converged);
  EXPECT_FALSE(report.negative_curvature);
  EXPECT_GT(report.error_estimate, 1e-4);
}

TEST(LinearSolver, AZeroRightHandSideGivesZero) {
  const StripSystem s = everything();
  Loaded a(s);
  a.b.upload(std::vector<Vec3>(static_cast<std::size_t>(s.n), Vec3::Zero()));
  for (LinearKind kind : kKinds) {
    LinearSolver solver({.linear = kind}, s.layout);
    EXPECT_TRUE(a.solve(solver).converged);
    for (const Vec3& v : a.x.span()) EXPECT_EQ(v, Vec3(Vec3::Zero()));
  }
}

TEST(LinearSolver, ItHasTheSameBitsForAnyThreadsAnyOrderAndAnyPast) {
  const std::uint64_t order = shuffled_order();
  for (const StripSystem& s : {everything(), folded(200, 1e4), roll(150)})
    for (LinearKind kind : kKinds) {
      const auto solution = [&] {
        Loaded a(s);
        LinearSolver solver({.linear = kind}, s.layout);
        a.solve(solver);
        return a.x.download();
      };
      set_threads(1);
      const std::vector<Vec3> expected = solution();
      for (int threads : {2, 8}) {
        set_threads(threads);
        EXPECT_EQ(solution(), expected) << to_text(kind) << ", " << threads << " threads";
      }
      set_threads(0);
      set_shuffled_order(9);
      EXPECT_EQ(solution(), expected) << to_text(kind) << " shuffled";
      set_shuffled_order(order);

      Loaded a(s);
      LinearSolver solver({.linear = kind}, s.layout);
      a.solve(solver);
      Loaded indefinite(s);  // same pattern in another matrix, which no factorisation gets through
      Buffer<Mat3> negative(std::vector<Mat3>(s.contact.values.size(), -1e6 * Mat3::Identity()));
      indefinite.matrix.accumulate_contact(negative.span());
      EXPECT_TRUE(indefinite.solve(solver).negative_curvature);
      a.solve(solver);
      EXPECT_EQ(a.x.download(), expected) << to_text(kind) << " after other solves";
      Buffer<Mat3> same(s.contact.values);
      a.matrix.accumulate_contact(negative.span());
      EXPECT_TRUE(a.solve(solver).negative_curvature) << "with the ordering that was kept";
      a.matrix.accumulate_contact(same.span());
      a.solve(solver);
      EXPECT_EQ(a.x.download(), expected) << to_text(kind) << " with the ordering that was kept";
    }
}

TEST(LinearSolver, AutoTakesTheBandForAStripRigidMotionsForARollAndCholeskyWithoutAStripAndSaysSo) {
  EXPECT_EQ(solve(strip(400), {}).solver, "pcg_strip");
  StripSystem rolled;
  rolled.add_roll(4, 10);
  EXPECT_EQ(solve(rolled, {}).solver, "pcg_two_level");
  StripSystem bodies;
  for (int i = 0; i < 4; ++i) bodies.add_body(Vec3(i, 0, 0), 1);
  EXPECT_EQ(solve(bodies, {}).solver, "cholesky_simplicial");
  StripSystem unknown = strip(200);
  unknown.layout.strips.clear();
  EXPECT_EQ(solve(unknown, {}).solver, "cholesky_simplicial");
  EXPECT_EQ(solve(strip(20), {.linear = LinearKind::pcg_jacobi}).solver, "pcg_jacobi");
}

TEST(LinearSolver, OnlyTheSideWithHostMemoryOffersTheStripPreconditioner) {
  EXPECT_EQ(available_solvers(),
            (std::vector{LinearKind::cholesky, LinearKind::pcg_jacobi, LinearKind::pcg_two_level, LinearKind::pcg_strip}));
  for (LinearKind kind : available_solvers()) {
    check({.linear = kind}, true);
    if (kind == LinearKind::pcg_strip) {
      EXPECT_THROW(check({.linear = kind}, false), SettingsError);
    } else {
      check({.linear = kind}, false);
    }
  }
}

TEST(LinearSolver, ASettingOutOfRangeIsRefusedByName) {
  try {
    const LinearSolver refused({.pcg_tol = 0});
    ADD_FAILURE() << "accepted pcg_tol = 0";
  } catch (const SettingsError& e) {
    EXPECT_EQ(e.path, "solver.pcg_tol");
  }
}
