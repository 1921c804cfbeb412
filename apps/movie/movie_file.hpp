#pragma once
#include <filesystem>
#include <functional>

#include "apps/movie/movie.hpp"

namespace tape::movie {
/// Told between states how many of all are done; false: no more.
using Watch = std::function<bool(int done, int all)>;

/// A movie on its way into a video file; the last picture of each phase goes beside it, as still_PHASE.png. Without `finish` nothing is
/// left.
class MovieFile {
 public:
  /// @param mesh, first  of the first state, which is still to be added
  MovieFile(const PictureParams& params, const Stage& stage, const RecordedMesh& mesh, const RecordedFrame& first,
            std::filesystem::path file);
  /// The next state. Its mesh must stay until there is another.
  void add(const RecordedMesh& mesh, const RecordedFrame& frame) { movie_.add(mesh, frame); }
  void finish();
  int pictures() const { return movie_.pictures(); }  ///< so far

 private:
  std::filesystem::path file_;
  Movie movie_;
  video::VideoWriter video_;
};

/// The movie of a whole recording.  @return false if `watch` stopped it: there is no file then
bool write_video(const cosim::StateReader& recording, const PictureParams& params, const std::filesystem::path& file, const Watch& watch);
/// One recorded state. @param frame  counted from 0; negative: from the end
void write_still(const cosim::StateReader& recording, const PictureParams& params, int frame, const std::filesystem::path& file);
}  // namespace tape::movie
