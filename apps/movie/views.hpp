#pragma once
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/movie/stage.hpp"
#include "apps/render/renderer.hpp"

namespace tape::movie {
/// The cameras of a movie: their pictures side by side, insets in the corners.
class Views {
 public:
  /// @param mesh, first  of the first state, from which cameras follow things
  Views(const PictureParams& params, const Stage& stage, const RecordedMesh& mesh, const RecordedFrame& first);
  int width() const { return width_; }
  int height() const { return height_; }
  render::Picture draw(const render::RenderScene& scene, const RecordedMesh& mesh, const RecordedFrame& frame);

 private:
  struct View {
    render::Camera camera;
    std::optional<InsetParams> inset = {};
    std::string follow = {}, mount = {};  // what it moves along with, and what its pose is in the frame of
    Vec3 start = Vec3::Zero();            // [m] middle of what it follows in the first state
  };
  void add(const CameraParams& camera, int width, int height, const RecordedMesh& mesh, const RecordedFrame& first);
  render::Picture shot(const View& view, const render::RenderScene& scene, const RecordedMesh& mesh, const RecordedFrame& frame);
  void place_inset(render::Picture& whole, const render::Picture& part, Corner corner) const;
  int width_ = 0, height_ = 0;
  std::vector<View> views_;
  std::map<std::pair<int, int>, render::Renderer> renderers_;  // by the size of their pictures
};
}  // namespace tape::movie
