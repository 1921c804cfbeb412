#include <numbers>

#include "tape/math/rotation.hpp"
#include "tape/model/primitives.hpp"
#include "tests/hard/hard_case.hpp"

namespace tape::test {
namespace {
constexpr Real kQuarter = std::numbers::pi / 2;

/// A strip that falls on a fixed obstacle, with a floor below.
Setup onto(TriangleMesh obstacle, const Vec3& at, Setup setup) {
  add_body(setup, "obstacle", std::move(obstacle), Motion::fixed, at);
  add_body(setup, "floor", box_mesh(Vec3(0.2, 0.2, 0.01)), Motion::fixed, Vec3(0, 0, -0.0251));
  return setup;
}
/// Stands the strip on its edge (about x) or on its tip (about y).
Setup turned(Setup setup, const Vec3& rotation, const Vec3& start) {
  setup.scene.strips[0].pose = {rotation_exp(rotation), start};
  return setup;
}
/// Drags the strip's tip along x.
Setup dragged(Setup setup, Real distance, Real speed) {
  Grip grip;
  grip.name = "pull";
  grip.what.object = "tape";
  grip.what.vertices = {0, 1, 2, 3};
  grip.motion = {{0, distance / speed, Vec3(-distance, 0, 0)}};
  setup.scene.grips.push_back(grip);
  return setup;
}
Setup two_blocks(Real gap, Setup setup) {
  add_body(setup, "left", box_mesh(Vec3(0.04, 0.06, 0.02)), Motion::fixed, Vec3(-0.02 - gap / 2, 0, -0.01));
  add_body(setup, "right", box_mesh(Vec3(0.04, 0.06, 0.02)), Motion::fixed, Vec3(0.02 + gap / 2, 0, -0.01));
  return setup;
}
}  // namespace

std::vector<HardCase> obstacle_cases() {
  const Real z = 0.004;
  const TriangleMesh spike = spike_mesh(0.004, 0.02, 4), wedge = wedge_mesh(Vec3(0.01, 0.05, 0.02));
  const Vec3 foot(0, 0, -0.02);
  return {
      {"HC1_face_on_spike", "a strip's face falls on a point", 0.25, false, [=] { return onto(spike, foot, dropped_strip(0.05, 3, z)); }},
      {"HC1_edge_on_spike", "a strip's long edge falls on a point", 0.25, false,
       [=] { return onto(spike, foot, turned(dropped_strip(0.05, 3, z), Vec3(kQuarter, 0, 0), Vec3(-0.0243, 0, 0.0125))); }},
      {"HC1_corner_on_spike", "a strip's corner falls on a point", 0.25, false,
       [=] { return onto(spike, foot, turned(dropped_strip(0.03, 3, z), Vec3(0.6, -0.9, 0), Vec3(0.0005, 0, 0.012))); }},
      {"HC1_face_on_wedge", "a strip's face falls across a sharp ridge", 0.25, false,
       [=] { return onto(wedge, foot, dropped_strip(0.05, 3, z, 0.3)); }},
      {"HC1_edge_on_wedge", "a strip's long edge falls along a sharp ridge", 0.25, false,
       [=] {
         return onto(wedge, foot, turned(dropped_strip(0.05, 3, z), Vec3(0, 0, kQuarter) + Vec3(0.2, 1.4, 0), Vec3(0, -0.02, 0.03)));
       }},
      {"HC1_corner_on_wedge", "a strip's corner falls on a sharp ridge", 0.25, false,
       [=] { return onto(wedge, foot, turned(dropped_strip(0.03, 3, z), Vec3(0.6, -0.9, 0), Vec3(0.0005, 0, 0.012))); }},
      {"HC1_edge_on_cliff_edge", "a strip's long edge falls across the edge of a block", 0.3, false,
       [=] {
         return onto(box_mesh(Vec3(0.04, 0.05, 0.02)), Vec3(-0.024, 0, -0.01),
                     turned(dropped_strip(0.05, 3, z), Vec3(kQuarter, 0, 0), Vec3(-0.0243, 0, 0.0125)));
       }},
      {"HC1_corner_on_cliff_edge", "a strip's corner falls on the edge of a block", 0.3, false,
       [=] {
         return onto(box_mesh(Vec3(0.04, 0.05, 0.02)), Vec3(-0.024, 0, -0.01),
                     turned(dropped_strip(0.03, 3, z), Vec3(0.6, -0.9, 0), Vec3(-0.0045, 0, 0.012)));
       }},
      {"HC1_dragged_over_spike", "a strip dragged across a point", 0.3, true,
       [=] { return dragged(onto(spike, foot, dropped_strip(0.06, 3, 0.0005)), 0.03, 0.15); }},
      {"HC1_dragged_over_cliff_edge", "a strip dragged back over the edge of a block", 0.3, true,
       [=] { return dragged(onto(box_mesh(Vec3(0.04, 0.05, 0.02)), Vec3(-0.024, 0, -0.01), dropped_strip(0.06, 3, 0.0005)), 0.03, 0.15); }},
      {"HC1_dragged_over_hole", "a strip dragged over the bore of a ring", 0.3, true,
       [=] { return dragged(onto(ring_mesh(0.012, 0.018, 0.02, 24, 1), Vec3(0, 0, -0.01), dropped_strip(0.06, 3, 0.0006)), 0.03, 0.15); }},
      {"HC1_cliff_edge", "a strip half over the edge of a block", 0.3, false,
       [=] { return onto(box_mesh(Vec3(0.04, 0.05, 0.02)), Vec3(-0.024, 0, -0.01), dropped_strip(0.06, 3, 0.0005)); }},
      {"HC1_internal_edges", "a strip dragged over a plane of many small triangles", 0.3, true,
       [=] {
         return dragged(onto(box_mesh(Vec3(0.12, 0.05, 0.02), Index3(24, 10, 1)), Vec3(0, 0, -0.01), dropped_strip(0.04, 3, 0.0003)), 0.03,
                        0.15);
       }},
      {"HC1_dragged_over_wedge", "a strip dragged across a sharp ridge", 0.3, true,
       [=] { return dragged(onto(wedge, foot, dropped_strip(0.06, 3, 0.0005)), 0.03, 0.15); }},
      {"HC1_into_crack", "a strip's tip falls into a crack of its own width", 0.3, false,
       [=] { return two_blocks(0.0012, turned(dropped_strip(0.03, 3, z), Vec3(0, kQuarter, 0), Vec3(0, 0, 0.0325))); }},
      {"HC1_over_crack", "a strip dragged over a crack", 0.3, true,
       [=] { return dragged(two_blocks(0.002, dropped_strip(0.04, 3, 0.0003)), 0.02, 0.1); }},
      {"HC1_into_hole", "a strip falls into the bore of a ring", 0.3, false,
       [=] { return onto(ring_mesh(0.012, 0.018, 0.02, 24, 1), Vec3(0, 0, -0.01), dropped_strip(0.05, 3, 0.0006)); }},
  };
}
}  // namespace tape::test
