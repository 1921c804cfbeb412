#include "apps/movie/views.hpp"

#include <algorithm>
#include <cmath>

#include "apps/movie/things.hpp"
#include "apps/render/panel.hpp"

namespace tape::movie {
namespace {
Pose on(const Pose& X_WB, const Pose& X_BC) { return {X_WB.rotation * X_BC.rotation, apply(X_WB, X_BC.position)}; }
}  // namespace

Views::Views(const PictureParams& params, const Stage& stage, const RecordedMesh& mesh, const RecordedFrame& first) {
  const auto beside = std::ranges::count_if(params.cameras, [](const CameraParams& c) { return !c.inset; });
  const int height = params.video.height;
  const int width = beside < 2 ? params.video.width : params.video.width / static_cast<int>(beside) / 2 * 2;
  for (const CameraParams& camera : params.cameras)
    if (!camera.inset) add(camera, width, height, mesh, first);
  if (views_.empty()) views_.push_back({render::Camera::make(render::overview(stage.moving, width, height), width, height)});
  for (const View& view : views_) width_ += view.camera.width, height_ = view.camera.height;
  for (const CameraParams& camera : params.cameras) {
    if (!camera.inset) continue;
    const auto part = [&](int whole) { return static_cast<int>(std::lround(camera.inset->width * whole)); };
    add(camera, part(width_), part(height_), mesh, first);
  }
  for (const View& view : views_) {
    const std::pair size(view.camera.width, view.camera.height);
    renderers_.try_emplace(size, size.first, size.second);
  }
}

void Views::add(const CameraParams& camera, int width, int height, const RecordedMesh& mesh, const RecordedFrame& first) {
  if (const auto* pinhole = std::get_if<render::PinholeSettings>(&camera.lens)) {
    views_.push_back({.camera = render::Camera::make(*pinhole), .mount = pinhole->mount});
    return;
  }
  const auto& look = std::get<render::LookAtSettings>(camera.lens);
  if (!look.mount.empty() && !look.follow.empty()) throw InputError("camera: follow and mount exclude each other");
  View view{.camera = render::Camera::make(look, width, height), .inset = camera.inset, .follow = look.follow, .mount = look.mount};
  if (!look.follow.empty()) view.start = place_of(look.follow, mesh, first);
  views_.push_back(std::move(view));
}

render::Picture Views::draw(const render::RenderScene& scene, const RecordedMesh& mesh, const RecordedFrame& frame) {
  std::vector<render::Picture> beside;
  for (const View& view : views_)
    if (!view.inset) beside.push_back(shot(view, scene, mesh, frame));
  render::Picture whole = render::side_by_side(beside);
  for (const View& view : views_)
    if (view.inset) place_inset(whole, shot(view, scene, mesh, frame), view.inset->corner);
  return whole;
}

render::Picture Views::shot(const View& view, const render::RenderScene& scene, const RecordedMesh& mesh, const RecordedFrame& frame) {
  render::Camera camera = view.camera;
  if (!view.follow.empty()) camera.X_WC.position += place_of(view.follow, mesh, frame) - view.start;
  if (!view.mount.empty()) camera.X_WC = on(frame_of(view.mount, mesh, frame), camera.X_WC);
  return renderers_.at({camera.width, camera.height}).draw(scene, camera);
}

void Views::place_inset(render::Picture& whole, const render::Picture& part, Corner corner) const {
  const int away = std::max(4, height_ / 45), border = std::max(1, height_ / 360);  // [px]
  const bool right = corner == Corner::bottom_right || corner == Corner::top_right;
  const bool bottom = corner == Corner::bottom_right || corner == Corner::bottom_left;
  const int x = right ? whole.width - part.width - away : away, y = bottom ? whole.height - part.height - away : away;
  fill(whole, {x - border, y - border, part.width + 2 * border, part.height + 2 * border}, render::kInk, 1);
  paste(whole, part, x, y);
}
}  // namespace tape::movie
