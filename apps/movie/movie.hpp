#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/movie/studio.hpp"

namespace tape::movie {
/// Turns states, as they were recorded, into pictures at the video's rate, at the speed of the simulation: each shows the state nearest to
/// its time. Beside them it keeps the last picture of each phase.
class Movie {
 public:
  using Sink = std::function<void(const render::Picture&)>;
  struct Still {
    std::string phase;
    render::Picture picture;
  };
  /// @param mesh, first  of the first state, which is still to be added
  Movie(const PictureParams& params, const Stage& stage, const RecordedMesh& mesh, const RecordedFrame& first, Sink sink);
  int width() const { return studio_.width(); }
  int height() const { return studio_.height(); }
  /// The next state. Its mesh must stay until there is another.
  void add(const RecordedMesh& mesh, const RecordedFrame& frame);
  void finish();
  int pictures() const { return pictures_; }  ///< so far
  const std::vector<Still>& stills() const { return stills_; }

 private:
  void show_until(Real time);
  void keep_still();
  Studio studio_;
  Sink sink_;
  Real rate_, start_, time_;  // [1/s] of pictures; [s] of the first and the last state
  std::string phase_;         // of the last state; empty: none
  int pictures_ = 0;
  std::vector<Still> stills_;
};
}  // namespace tape::movie
