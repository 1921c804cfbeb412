#include "tape/solver/block_matrix.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/strip_system.hpp"
using namespace tape;
using namespace tape::on_cpu;

namespace {
/// Random slots, several to a block, with empty rows and slots without a block.
test::StripSystem::Slots random_slots(int n, int count, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_int_distribution<int> block(0, n - 1);
  test::StripSystem::Slots slots;
  for (int s = 0; s < count; ++s) {
    const int i = block(generator), j = s % 5 == 0 ? i : block(generator);
    const auto entry = [&] { return static_cast<Real>(block(generator)) - n / 3.0; };
    Mat3 h;
    for (int k = 0; k < 9; ++k) h(k) = entry();
    slots.add(i, j, i == j ? Mat3(h + h.transpose()) : h);
    if (s % 7 == 0) slots.keys.push_back(kNoBlock), slots.values.push_back(Mat3::Constant(1e30));
  }
  return slots;
}

struct Loaded {
  BlockMatrix matrix;
  explicit Loaded(int n, const test::StripSystem::Slots& fixed, const test::StripSystem::Slots& contact) {
    Buffer<std::uint64_t> fixed_keys(fixed.keys), contact_keys(contact.keys);
    Buffer<Mat3> fixed_values(fixed.values), contact_values(contact.values);
    matrix.set_fixed_pattern(n, fixed_keys.span());
    matrix.set_contact_pattern(contact_keys.span());
    matrix.accumulate_fixed(fixed_values.span());
    matrix.accumulate_contact(contact_values.span());
  }
};

/// Sum of the slots as a full matrix, straight from the definition.
Eigen::MatrixXd dense(int n, const test::StripSystem::Slots& fixed, const test::StripSystem::Slots& contact) {
  test::StripSystem s;
  s.n = n;
  const auto append = [](test::StripSystem::Slots& to, const test::StripSystem::Slots& from) {
    for (std::size_t k = 0; k < from.keys.size(); ++k)
      if (from.keys[k] != kNoBlock) to.keys.push_back(from.keys[k]), to.values.push_back(from.values[k]);
  };
  append(s.fixed, fixed);
  append(s.contact, contact);
  return s.dense();
}

std::vector<Vec3> random_vector(int n) {
  std::mt19937 generator(11);
  std::uniform_real_distribution<Real> uniform(-1, 1);
  std::vector<Vec3> x(static_cast<std::size_t>(n));
  for (Vec3& v : x) v = Vec3(uniform(generator), uniform(generator), uniform(generator));
  return x;
}

std::vector<Vec3> product(const BlockMatrix& a, const std::vector<Vec3>& x) {
  Buffer<Vec3> in(x), out;
  out.resize(a.size());
  a.multiply(in.span(), out.span());
  return out.download();
}
}  // namespace

TEST(BlockMatrix, ItsBlocksAreTheSumsOfTheirSlots) {
  constexpr int n = 40;
  const auto fixed = random_slots(n, 600, 1), contact = random_slots(n, 90, 2);
  const Loaded a(n, fixed, contact);
  HostBlocks host;
  a.matrix.download(host);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  ASSERT_EQ(host.row_begin.size(), std::size_t{n + 1});
  for (int i = 0; i < n; ++i)
    for (int k = host.row_begin[static_cast<std::size_t>(i)]; k < host.row_begin[static_cast<std::size_t>(i) + 1]; ++k) {
      const int j = host.col[static_cast<std::size_t>(k)];
      ASSERT_GE(j, i);
      if (k > host.row_begin[static_cast<std::size_t>(i)]) {
        EXPECT_LT(host.col[static_cast<std::size_t>(k) - 1], j);
      }
      sum.block<3, 3>(3 * i, 3 * j) = host.values[static_cast<std::size_t>(k)];
      sum.block<3, 3>(3 * j, 3 * i) = host.values[static_cast<std::size_t>(k)].transpose();
    }
  const Eigen::MatrixXd expected = dense(n, fixed, contact);
  EXPECT_LT((sum - expected).cwiseAbs().maxCoeff(), 1e-14 * expected.cwiseAbs().maxCoeff());
}

TEST(BlockMatrix, ItMultipliesLikeTheDenseMatrix) {
  constexpr int n = 40;
  const auto fixed = random_slots(n, 300, 3), contact = random_slots(n, 60, 4);
  const Loaded a(n, fixed, contact);
  const std::vector<Vec3> x = random_vector(n), y = product(a.matrix, x);
  const Eigen::MatrixXd full = dense(n, fixed, contact);
  const Eigen::VectorXd expected = full * Eigen::Map<const Eigen::VectorXd>(x[0].data(), 3 * n);
  EXPECT_LT((Eigen::Map<const Eigen::VectorXd>(y[0].data(), 3 * n) - expected).cwiseAbs().maxCoeff(), 1e-13 * full.cwiseAbs().sum());
}

TEST(BlockMatrix, EveryDiagonalBlockExistsAndHoldsBothGroups) {
  constexpr int n = 5;
  test::StripSystem::Slots fixed, contact;
  fixed.add(1, 1, 2 * Mat3::Identity());
  fixed.add(0, 4, Mat3::Constant(7));
  contact.add(1, 1, 3 * Mat3::Identity());
  contact.add(3, 3, 4 * Mat3::Identity());
  const Loaded a(n, fixed, contact);
  Buffer<Mat3> diagonal;
  diagonal.resize(n);
  a.matrix.diagonal(diagonal.span());
  const Real expected[] = {0, 5, 0, 4, 0};
  for (int i = 0; i < n; ++i) EXPECT_EQ(diagonal.span()[i], Mat3(expected[i] * Mat3::Identity())) << i;
  HostBlocks host;
  a.matrix.download(host);
  EXPECT_EQ(host.col, (std::vector<int>{0, 4, 1, 2, 3, 4}));
}

TEST(BlockMatrix, ANewContactPatternReplacesTheOldOneAndLeavesTheFixedGroup) {
  constexpr int n = 40;
  const auto fixed = random_slots(n, 300, 3), first = random_slots(n, 60, 4), second = random_slots(n, 20, 5);
  Loaded a(n, fixed, first);
  const std::uint64_t pattern = a.matrix.pattern();
  Buffer<std::uint64_t> keys(first.keys);
  a.matrix.set_contact_pattern(keys.span());
  EXPECT_EQ(a.matrix.pattern(), pattern) << "the keys are the same";
  keys.upload(second.keys);
  const Mat3* fixed_values = a.matrix.view().fixed.values.data;
  a.matrix.set_contact_pattern(keys.span());
  EXPECT_NE(a.matrix.pattern(), pattern);
  EXPECT_EQ(a.matrix.view().fixed.values.data, fixed_values);
  Buffer<Mat3> values(second.values);
  a.matrix.accumulate_contact(values.span());
  const std::vector<Vec3> x = random_vector(n);
  EXPECT_EQ(product(a.matrix, x), product(Loaded(n, fixed, second).matrix, x));
  a.matrix.set_contact_pattern({});
  EXPECT_EQ(product(a.matrix, x), product(Loaded(n, fixed, {}).matrix, x));
}

TEST(BlockMatrix, ItHasTheSameBitsForAnyNumberOfThreadsAndAnyOrder) {
  test::StripSystem s;
  s.add_strip(300);
  s.fold(0, 300, 1e5);
  const std::vector<Vec3> x = random_vector(s.n);
  set_threads(1);
  const std::vector<Vec3> expected = product(Loaded(s.n, s.fixed, s.contact).matrix, x);
  for (int threads : {2, 8}) {
    set_threads(threads);
    EXPECT_EQ(product(Loaded(s.n, s.fixed, s.contact).matrix, x), expected) << threads << " threads";
  }
  set_threads(0);
  const std::uint64_t before = shuffled_order();
  set_shuffled_order(4);
  EXPECT_EQ(product(Loaded(s.n, s.fixed, s.contact).matrix, x), expected);
  set_shuffled_order(before);
}

TEST(BlockMatrix, AKeyBelowTheDiagonalOrOutsideIsRefused) {
  BlockMatrix a;
  for (std::uint64_t key : {block_key(3, 1), block_key(1, 4)}) {
    Buffer<std::uint64_t> keys(std::vector<std::uint64_t>{key});
    EXPECT_THROW(a.set_fixed_pattern(4, keys.span()), CheckFailed);
  }
}
