#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <algorithm>
#include <random>

#include "tape/solver/articulations.inl"
using namespace tape;
using namespace tape::on_cpu;

namespace {
/// Two links of one articulation of five coordinates, one link of another of three, and four vertices: blocks 0-5, 6-7 and 8, 9-12.
Assembly assembly() {
  Assembly a;
  for (int b = 0; b < 3; ++b) {
    BodyPart part;
    part.motion = Motion::linked, part.block = 2 * b;
    a.bodies.push_back(part);
  }
  a.articulations = {{5, 6, 2, {0, 1}}, {3, 8, 1, {2}}};
  a.blocks = 13;
  return a;
}

struct Problem {
  std::mt19937 random{7};
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(39, 39), T = Eigen::MatrixXd::Zero(39, 20), M = Eigen::MatrixXd::Zero(20, 20);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(39), q = Eigen::VectorXd::Zero(8), target = Eigen::VectorXd::Zero(8);
  std::vector<ArticulationStep> steps;
  Eigen::MatrixXd some(Eigen::Index rows, Eigen::Index columns) {
    std::normal_distribution<Real> normal;
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
  }
  Eigen::MatrixXd positive(Eigen::Index n) {
    const Eigen::MatrixXd m = some(n, n);
    return m * m.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n);
  }
  /// Unknowns from what is solved for: coordinates 0-4 and 5-7, then the twelve of the vertices.
  Problem() {
    A = positive(39);
    A.middleRows(18, 9).setZero(), A.middleCols(18, 9).setZero();  // the potential does not know the coordinates
    b = some(39, 1), q = some(8, 1), target = some(8, 1);
    b.segment(18, 9).setZero();
    for (const auto& [links, n, row, column] : {std::tuple{2, 5, 0, 0}, {1, 3, 12, 5}}) {
      ArticulationStep step{target.segment(column, n), positive(n), {}};
      for (int l = 0; l < links; ++l) {
        step.jacobian.push_back(some(6, n));
        T.block(row + 6 * l, column, 6, n) = step.jacobian.back();
      }
      M.block(column, column, n, n) = step.inertia;
      steps.push_back(step);
    }
    T.block(27, 8, 12, 12).setIdentity();
  }
  std::vector<Eigen::VectorXd> targets() const { return {target.head(5), target.tail(3)}; }
  /// The potential's matrix, split over both groups.
  BlockMatrix matrix() const {
    BlockMatrix a;
    std::vector<std::uint64_t> fixed, contact;
    std::vector<Mat3> fixed_values, contact_values;
    for (int i = 0; i < 13; ++i) {
      for (int j = i; j < 13; ++j) {
        const Mat3 m = A.block<3, 3>(3 * i, 3 * j);
        (i + j < 9 ? contact : fixed).push_back(block_key(i, j));
        (i + j < 9 ? contact_values : fixed_values).push_back(m);
      }
    }
    a.set_fixed_pattern(13, Buffer<std::uint64_t>(fixed).span());
    a.set_contact_pattern(Buffer<std::uint64_t>(contact).span());
    a.accumulate_fixed(Buffer<Mat3>(fixed_values).span());
    a.accumulate_contact(Buffer<Mat3>(contact_values).span());
    return a;
  }
};
constexpr Real kDt = 0.1;

std::vector<Vec3> blocks_of(const Eigen::VectorXd& v) {
  std::vector<Vec3> out;
  for (int k = 0; k < v.size(); k += 3) out.emplace_back(v.segment<3>(k));
  return out;
}
/// Coordinates in blocks, with the one that fills the second block up.
std::vector<Vec3> q_blocks(const Eigen::VectorXd& q) {
  Eigen::VectorXd padded = Eigen::VectorXd::Zero(9);
  padded.head(5) = q.head(5), padded.tail(3) = q.tail(3);
  return blocks_of(padded);
}
}  // namespace

TEST(Articulations, DirectionIsThatOfTheCoordinatesAndLinksFollow) {
  Problem p;
  const BlockMatrix a = p.matrix();
  Articulations articulations(assembly());
  const SystemLayout layout = articulations.set_layout({.strips = {{9, 4, 2}}, .body_blocks = {0, 2, 4}}, 13);
  EXPECT_TRUE(layout.body_blocks.empty());
  EXPECT_EQ(layout.strips[0].first_block, 3);
  articulations.begin(p.steps, p.targets(), kDt);
  LinearSolver linear({.linear = LinearKind::cholesky}, layout);
  Buffer<Vec3> points(std::vector<Vec3>(13, Vec3::Zero())), right(blocks_of(p.b)), x(std::vector<Vec3>(13, Vec3::Zero()));
  const Buffer<Vec3> q(q_blocks(p.q));
  ASSERT_TRUE(articulations.solve(linear, a, points.span(), q.span(), true, right.span(), x.span()).converged);

  Eigen::VectorXd lag = Eigen::VectorXd::Zero(20);
  lag.head(8) = p.q - p.target;
  const Eigen::MatrixXd H = p.T.transpose() * p.A * p.T + p.M / (kDt * kDt);
  const Eigen::VectorXd r = p.T.transpose() * p.b - p.M * lag / (kDt * kDt), d = H.ldlt().solve(r);
  const std::vector<Vec3> got = x.download(), rest = right.download();
  const Eigen::VectorXd links = p.T * d;
  for (int i : {0, 1, 2, 3, 4, 5, 9, 10, 11, 12})
    EXPECT_LT((got[static_cast<std::size_t>(i)] - links.segment<3>(3 * i)).norm(), 1e-10) << i;
  EXPECT_LT((got[6] - d.segment<3>(0)).norm() + (got[7].head<2>() - d.segment<2>(3)).norm() + (got[8] - d.segment<3>(5)).norm(), 1e-10);
  EXPECT_EQ(got[7][2], 0);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(rest[i], Vec3(Vec3::Zero()));
  EXPECT_LT((rest[6] - r.segment<3>(0)).norm() + (rest[8] - r.segment<3>(5)).norm(), 1e-10);
}
TEST(Articulations, DirectionMindsTheLimitsThatDrivesComeToOnTheWay) {
  int passed = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Problem p;
    p.random.seed(seed);
    p.b = p.some(39, 1), p.q = p.some(8, 1), p.target = p.some(8, 1);
    p.b.segment(18, 9).setZero();
    for (int k = 0; k < 12; ++k) {  // of each coordinate, and four along some of all
      const int part = k < 5 || k > 9 ? 0 : 1, size = part == 0 ? 5 : 3;
      const Eigen::VectorXd along = k < 8 ? Eigen::VectorXd::Unit(size, k - 5 * part) : p.some(size, 1);
      p.steps[static_cast<std::size_t>(part)].springs.push_back(
          {along, 3.0 + k, -100 * p.some(1, 1).cwiseAbs()(0), 100 * p.some(1, 1).cwiseAbs()(0)});
    }
    Articulations articulations(assembly());
    const SystemLayout layout = articulations.set_layout({.strips = {{9, 4, 2}}, .body_blocks = {0, 2, 4}}, 13);
    articulations.begin(p.steps, p.targets(), kDt);
    LinearSolver linear({.linear = LinearKind::cholesky}, layout);
    Buffer<Vec3> points(std::vector<Vec3>(13, Vec3::Zero())), right(blocks_of(p.b)), x(std::vector<Vec3>(13, Vec3::Zero()));
    const Buffer<Vec3> q(q_blocks(p.q));
    const BlockMatrix a = p.matrix();
    ASSERT_TRUE(articulations.solve(linear, a, points.span(), q.span(), true, right.span(), x.span()).converged);
    const std::vector<Vec3> got = x.download();
    Eigen::VectorXd d(20);
    d << got[6], got[7].head<2>(), got[8], got[9], got[10], got[11], got[12];

    // The gradient of the model at its minimum is zero, whatever the way there.
    Eigen::VectorXd gradient = p.T.transpose() * (p.A * p.T * d - p.b);
    gradient.head(8) += p.M.topLeftCorner(8, 8) * (d.head(8) + p.q - p.target) / (kDt * kDt);
    for (const int part : {0, 1}) {
      for (const LimitedSpring& spring : p.steps[static_cast<std::size_t>(part)].springs) {
        const int first = 5 * part;
        const auto ahead = [&](const Eigen::VectorXd& e) { return spring.along.dot(e.segment(first, spring.along.size())); };
        const auto force = [&](Real by) { return std::clamp(spring.stiffness * by / (kDt * kDt), spring.least, spring.most); };
        const Real before = force(ahead(p.q - p.target)), after = force(ahead(d.head(8) + p.q - p.target));
        gradient.segment(first, spring.along.size()) += after * spring.along;
        const auto limited = [&](Real f) { return f == spring.least || f == spring.most; };
        passed += before != after && (limited(before) || limited(after)) ? 1 : 0;
      }
    }
    EXPECT_LT(gradient.norm(), 1e-8 * p.b.norm()) << seed;
  }
  EXPECT_GT(passed, 20) << "what is to be shown occurs";
}
TEST(Articulations, EnergyIsTheKineticTerm) {
  Problem p;
  Articulations articulations(assembly());
  articulations.set_layout({}, 13);
  articulations.begin(p.steps, p.targets(), kDt);
  const Buffer<Vec3> q(q_blocks(p.q));
  const Eigen::VectorXd lag = p.q - p.target;
  const Real expected = lag.dot(p.M.topLeftCorner(8, 8) * lag) / (2 * kDt * kDt);
  EXPECT_NEAR(articulations.energy(q.span()).sum, expected, 1e-12 * expected);
}
