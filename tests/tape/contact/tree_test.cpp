#include "tape/contact/tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>
using namespace tape;
using namespace tape::on_cpu;

namespace {
std::vector<Box> random_boxes(int n, Real size, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<Real> u(0, 1);
  std::vector<Box> boxes;
  for (int i = 0; i < n; ++i) {
    const Vec3 low(u(generator), u(generator), u(generator));
    boxes.push_back({low, low + size * Vec3(u(generator), u(generator), u(generator))});
  }
  return boxes;
}
bool overlap(const Box& a, const Box& b) { return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all(); }

struct Tree {
  explicit Tree(const std::vector<Box>& boxes, int fixed = 0) {
    std::vector<Lanes> host;
    for (std::size_t i = 0; i < boxes.size(); ++i) host.push_back(stored_box(boxes[i], static_cast<int>(i), static_cast<int>(i) < fixed));
    lanes.upload(host);
    tree.build(lanes.span());
  }
  std::vector<int> found(const Lanes& query) const {
    std::vector<int> ids;
    tree.view().visit(query, [&](int id) { ids.push_back(id); });
    std::ranges::sort(ids);
    return ids;
  }
  Buffer<Lanes> lanes;
  BoxTree tree;
};
}  // namespace

TEST(BoxTree, FindsExactlyTheBoxesThatOverlap) {
  for (const int n : {0, 1, 2, 3, 64, 65, 1000}) {
    const std::vector<Box> boxes = random_boxes(n, 0.1, 1);
    const Tree tree(boxes);
    for (const Box& q : random_boxes(50, 0.1, 2)) {
      std::vector<int> expected;
      for (int i = 0; i < n; ++i)
        if (overlap(boxes[static_cast<std::size_t>(i)], q)) expected.push_back(i);
      EXPECT_EQ(tree.found(query_box(q, 0, false)), expected) << n << " boxes";
    }
  }
}

TEST(BoxTree, BoxesThatTouchOrDifferInTheLastBitAreNeverMissed) {
  const Real third = 1.0 / 3;  // not a float: both sides are rounded outwards
  const Box a{Vec3(0, 0, 0), Vec3(third, third, third)}, b{Vec3(third, third, third), Vec3(1, 1, 1)};
  EXPECT_EQ(Tree({a}).found(query_box(b, 0, false)).size(), 1u);
  EXPECT_EQ(Tree({b}).found(query_box(a, 0, false)).size(), 1u);
}

TEST(BoxTree, OneHundredEqualBoxesAreAllFound) {
  const Tree tree(std::vector<Box>(100, Box{Vec3(1, 2, 3), Vec3(1, 2, 3)}));
  EXPECT_EQ(tree.found(query_box({Vec3(0, 0, 0), Vec3(9, 9, 9)}, 0, false)).size(), 100u);
}

TEST(BoxTree, AQueryMayAskForHigherIdsAndForWhatMoves) {
  const Tree tree(random_boxes(100, 0.1, 4), 30);  // the first 30 are fixed
  const Box all{Vec3(-1, -1, -1), Vec3(9, 9, 9)};
  EXPECT_EQ(tree.found(query_box(all, 0, false)).size(), 100u);
  EXPECT_EQ(tree.found(query_box(all, 90, false)).front(), 90);
  EXPECT_EQ(tree.found(query_box(all, 90, false)).size(), 10u);
  EXPECT_EQ(tree.found(query_box(all, 0, true)).front(), 30);
  EXPECT_EQ(tree.found(query_box(all, 0, true)).size(), 70u);
}
