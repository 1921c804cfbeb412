#include "apps/movie/studio.hpp"

#include "apps/movie/paint.hpp"
#include "apps/render/legend.hpp"

namespace tape::movie {
Studio::Studio(const PictureParams& params, const Stage& stage, const RecordedMesh& mesh, const RecordedFrame& first)
    : view_(params.view),
      stage_(stage),
      views_(params, stage, mesh, first),
      font_(std::max(11, views_.height() / 36)),
      large_(std::max(22, views_.height() / 18)),
      chronicle_(params.overlay) {}

void Studio::show(const RecordedMesh& mesh, const RecordedFrame& frame) {
  chronicle_.add(mesh, frame);
  mesh_ = &mesh;
  frame_ = frame;
  picture_.reset();
}

const render::Picture& Studio::picture() {
  if (picture_) return *picture_;
  picture_ = views_.draw(painted(view_, stage_, *mesh_, frame_), *mesh_, frame_);
  draw_legends(*picture_, font_, {legend_of(view_, stage_, *mesh_)});
  draw_caption(*picture_, font_, chronicle_.caption());
  draw_charts(*picture_, font_, chronicle_.charts());
  if (chronicle_.just_cut()) draw_flash(*picture_, large_, "cut");
  return *picture_;
}
}  // namespace tape::movie
