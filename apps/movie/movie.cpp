#include "apps/movie/movie.hpp"

namespace tape::movie {
Movie::Movie(const PictureParams& params, const Stage& stage, const RecordedMesh& mesh, const RecordedFrame& first, Sink sink)
    : studio_(params, stage, mesh, first), sink_(std::move(sink)), rate_(params.video.rate), start_(first.time), time_(start_) {}

void Movie::add(const RecordedMesh& mesh, const RecordedFrame& frame) {
  const std::string phase = frame.phase < 0 ? "" : mesh.phases[static_cast<std::size_t>(frame.phase)];
  show_until((time_ + frame.time) / 2);
  if (phase != phase_) keep_still();
  phase_ = phase;
  time_ = frame.time;
  studio_.show(mesh, frame);
}

void Movie::finish() {
  show_until(time_ + 1e-6 / rate_);
  keep_still();
}

/// Pictures of the state that is shown, for times before this one.
void Movie::show_until(Real time) {
  for (; start_ + pictures_ / rate_ < time; ++pictures_) sink_(studio_.picture());
}

void Movie::keep_still() {
  if (!phase_.empty()) stills_.push_back({phase_, studio_.picture()});
}
}  // namespace tape::movie
