#pragma once
#include <vector>

#include "apps/movie/params.hpp"
#include "cosim/run/state_file.hpp"

/// A made-up recording: a strip of two triangles over a box, of states that a test lines up.
namespace tape::test {
inline cosim::RecordedMesh movie_mesh() {
  cosim::RecordedMesh mesh;
  mesh.scene = "made_up";
  mesh.objects = {{"tape", "vinyl", 0, 2, true, 1, 0}, {"box", "wood", 2, 2, false}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  mesh.rest = {{0, 0}, {0.1, 0}, {0.1, 0.1}, {0, 0.1}, {0, 0}, {0, 0}, {0, 0}, {0, 0}};
  mesh.body = {-1, -1, -1, -1, 0, 0, 0, 0};
  mesh.local = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {-0.1, -0.1, 0}, {0.2, -0.1, 0}, {0.2, 0.2, 0}, {-0.1, 0.2, 0}};
  mesh.strip_vertices = 4;
  mesh.grips = {"pull"};
  mesh.phases = {"lift", "hold"};
  return mesh;
}
/// @param height  [m] of the strip  @param force  [N] of the grip
inline cosim::RecordedFrame movie_frame(int step, Real time, Real height, int phase = -1, Real force = 0) {
  cosim::RecordedFrame frame;
  frame.step = step, frame.time = time;
  frame.x = {{0, 0, height}, {0.1, 0, height}, {0.1, 0.1, height}, {0, 0.1, height}};
  frame.bodies = {Pose{Mat3::Identity(), Vec3::Zero()}};
  frame.contact_force.assign(8, 0);
  frame.engagement.assign(4, 0);
  frame.part.assign(4, TapePart::free);
  frame.grip_force = {Vec3(0, 0, force)};
  frame.phase = phase;
  return frame;
}
/// A small picture from the front and above.
inline movie::PictureParams movie_params() {
  movie::PictureParams params;
  params.video.width = 320, params.video.height = 180, params.video.rate = 10;
  params.cameras = {{render::LookAtSettings{.eye = {0.05, -0.6, 0.4}, .target = {0.05, 0.05, 0.03}}}};
  return params;
}
}  // namespace tape::test
