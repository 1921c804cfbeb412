#pragma once
#include "apps/movie/chronicle.hpp"
#include "apps/movie/views.hpp"
#include "apps/render/text.hpp"

namespace tape::movie {
/// Draws the states of a motion, one after another.
class Studio {
 public:
  /// @param mesh, first  of the first state
  Studio(const PictureParams& params, const Stage& stage, const RecordedMesh& mesh, const RecordedFrame& first);
  int width() const { return views_.width(); }
  int height() const { return views_.height(); }
  /// The next state; pictures may tell of those before it. Its mesh must stay until there is another.
  void show(const RecordedMesh& mesh, const RecordedFrame& frame);
  /// The picture of this state.
  const render::Picture& picture();

 private:
  ViewParams view_;
  Stage stage_;
  Views views_;
  render::Font font_, large_;
  Chronicle chronicle_;
  const RecordedMesh* mesh_ = nullptr;  // of the state that is shown
  RecordedFrame frame_;
  std::optional<render::Picture> picture_;  // of it, once drawn
};
}  // namespace tape::movie
