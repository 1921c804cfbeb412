#include "tape/contact/intersection.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <string>

#include "tape/core/error.hpp"
#include "tape/math/predicates.hpp"
#include "tests/tape/contact/meshes.hpp"
using namespace tape;

namespace {
constexpr Real kXi = 4.5e-5, kDhat = 1.8e-4;  // [m]

/// All edges against all triangles. The exact test of one pair has its own independent check in predicates_test.cpp.
int crossings_by_trying_all(const test::Surface& s) {
  int count = 0;
  for (const SurfaceEdge& e : s.mesh.edges)
    for (const SurfaceTriangle& t : s.mesh.triangles) {
      const auto at = [&](int v) { return s.x[static_cast<std::size_t>(v)]; };
      const bool shared = std::ranges::any_of(t.v, [&](int v) { return v == e.v[0] || v == e.v[1]; });
      count += !shared && segment_meets_triangle(at(e.v[0]), at(e.v[1]), at(t.v[0]), at(t.v[1]), at(t.v[2]));
    }
  return count;
}
/// A triangle at y = 0 and one across it whose lowest corner is at (0.25, low, 0.25) [m].
test::Surface spike_over_plate(Real low, const VertexOwner* plate_owner = nullptr, const VertexOwner* spike_owner = nullptr) {
  test::Surface s;
  test::add_object(s, {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, 1, 2}}, kXi, plate_owner);
  test::add_object(s, {{0.25, low, 0.25}, {0.2, low + 1, 0.25}, {0.3, low + 1, 0.25}}, {{0, 1, 2}}, kXi, spike_owner);
  s.mesh.objects = {"plate", "spike"};
  return s;
}
std::string refusal(const test::Surface& s) {
  try {
    check_start(s.x, s.mesh, kDhat);
    return "";
  } catch (const InputError& e) {
    return e.what();
  }
}
}  // namespace

TEST(Intersection, RandomTrianglesCrossWhereTryingAllSays) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const test::Surface s = test::scattered_triangles(150, 0.2, kXi, seed);
    const Intersections found = find_intersections(s.mesh, s.x);
    EXPECT_EQ(found.count, crossings_by_trying_all(s));
    EXPECT_GT(found.count, 20);
    EXPECT_EQ(found.first.size(), 5u);
  }
}

TEST(Intersection, TrianglesOnACoarseGridTouchWhereTryingAllSays) {
  std::mt19937_64 generator(9);
  std::uniform_int_distribution<int> u(0, 6);
  test::Surface s;
  for (int i = 0; i < 60; ++i) {
    std::vector<Vec3> x;
    for (int k = 0; k < 3; ++k) x.emplace_back(0.1 * u(generator), 0.1 * u(generator), 0.1 * u(generator));
    test::add_object(s, x, {{0, 1, 2}}, kXi);
  }
  EXPECT_EQ(find_intersections(s.mesh, s.x).count, crossings_by_trying_all(s));
}

TEST(Intersection, AWoundStripHasNoneUntilOneVertexGoesThroughTheNextLayer) {
  test::Surface s = test::wound_strip(4, 2.7e-4, kXi);
  EXPECT_EQ(find_intersections(s.mesh, s.x).count, 0);
  Vec3& p = s.x[s.x.size() / 2];
  p += 4e-4 * Vec3(p.x(), p.y(), 0).normalized();  // 1.5 pitches outwards
  EXPECT_GT(find_intersections(s.mesh, s.x).count, 0);
}

TEST(Intersection, OneBitDecides) {
  EXPECT_EQ(find_intersections(spike_over_plate(1e-300).mesh, spike_over_plate(1e-300).x).count, 0);
  EXPECT_EQ(find_intersections(spike_over_plate(0).mesh, spike_over_plate(0).x).count, 2) << "both edges that end in the corner";
  EXPECT_EQ(find_intersections(spike_over_plate(-1e-300).mesh, spike_over_plate(-1e-300).x).count, 2);
}

TEST(Intersection, WhatCannotCollideIsNotCounted) {
  const VertexOwner fixed, body{0, 0};
  const test::Surface both_fixed = spike_over_plate(-0.5, &fixed, &fixed), both_carried = spike_over_plate(-0.5, &body, &body);
  EXPECT_EQ(find_intersections(both_fixed.mesh, both_fixed.x).count, 0);
  EXPECT_EQ(find_intersections(both_carried.mesh, both_carried.x).count, 0);
  const test::Surface one = spike_over_plate(-0.5, &fixed, &body);
  EXPECT_EQ(find_intersections(one.mesh, one.x).count, 2);
  const test::Surface far = spike_over_plate(5, &fixed, &body);  // neither has any company
  EXPECT_EQ(find_intersections(far.mesh, far.x).count, 0);
}

TEST(Intersection, MembersOfAClusterAreOnlyComparedWithOthers) {
  const test::Surface roll = test::wound_strip(6, 2.7e-4, kXi);
  const std::size_t n = roll.x.size();
  std::vector<VertexOwner> owner = roll.mesh.owner;
  for (std::size_t v = 0; v < 3 * n / 4; ++v) owner[v] = {0, 0};
  EXPECT_GT(roll.mesh.triangles.size(), 2000u) << "enough for the members to have a tree of their own";
  for (const auto& [moved, seen] : {std::pair{7 * n / 8, true}, {n / 4, false}}) {
    test::Surface s = roll;
    Vec3& p = s.x[moved];
    p -= 4e-4 * Vec3(p.x(), p.y(), 0).normalized();  // 1.5 pitches inwards
    const int all = find_intersections(s.mesh, s.x).count;
    EXPECT_GT(all, 0);
    EXPECT_EQ(find_intersections(s.mesh, owner, s.x).count, seen ? all : 0);
  }
}

TEST(Intersection, AStartIsRefusedByTheNamesOfWhatMeets) {
  EXPECT_EQ(refusal(spike_over_plate(2.001 * kXi)), "");
  const std::string crossing = refusal(spike_over_plate(-0.5));
  for (const char* part : {"2 intersections", "spike edge 0-1", "plate triangle 0-1-2", "0.225", " m"})
    EXPECT_NE(crossing.find(part), std::string::npos) << part << " in: " << crossing;
  const std::string close = refusal(spike_over_plate(1.5 * kXi));
  for (const char* part : {"gap -2.25", "spike vertex 0", "plate triangle 0-1-2", "(0.25, 6.75", "9e-05 m"})
    EXPECT_NE(close.find(part), std::string::npos) << part << " in: " << close;
  EXPECT_NE(refusal(spike_over_plate(2 * kXi)), "") << "exactly touching";
}

TEST(Intersection, AStartThatIsNotFiniteIsRefusedByTheNameOfTheVertex) {
  test::Surface s = spike_over_plate(1);
  s.x[4].y() = std::numeric_limits<Real>::quiet_NaN();
  EXPECT_NE(refusal(s).find("spike vertex 1"), std::string::npos) << refusal(s);
}
