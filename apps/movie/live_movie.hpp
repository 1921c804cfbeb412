#pragma once
#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <list>
#include <mutex>
#include <thread>

#include "apps/movie/movie_file.hpp"

namespace tape::movie {
/// A movie that is made while the run goes on, on a thread of low priority: it takes what the solver leaves of the machine. It knows only
/// the beginning of the motion, so it ends early where that does not keep the stage that it begins on; a movie of the whole recording is
/// the same otherwise.
class LiveMovie {
 public:
  LiveMovie(PictureParams params, std::filesystem::path file);
  /// Gives up what is not finished.
  ~LiveMovie();
  LiveMovie(const LiveMovie&) = delete;
  LiveMovie& operator=(const LiveMovie&) = delete;
  /// States from now on are of this mesh.
  void start_mesh(RecordedMesh mesh);
  void add(RecordedFrame frame);
  enum class End { made, stopped, left_stage };
  /// After the last state: waits for the rest of the movie.  @param watch  as long as it is not made; false: no more
  /// @throws what went wrong on the thread
  End finish(const Watch& watch);
  Real seconds() const { return seconds_; }  ///< [s] of the thread at work
  int pictures() const { return pictures_; }

 private:
  struct Item {
    const RecordedMesh* mesh;
    RecordedFrame frame;
  };
  void work();
  bool shoot(const Item& item);
  PictureParams params_;
  std::filesystem::path file_;
  std::list<RecordedMesh> meshes_;  // of the run so far; they stay where they are
  // Between the threads, under the mutex.
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> waiting_;
  int added_ = 0, done_ = 0;  // states
  bool complete_ = false, given_up_ = false, over_ = false;
  // Of the movie's thread; the others read it once that is over.
  Survey survey_;
  std::optional<Stage> stage_;
  std::optional<MovieFile> movie_;
  End end_ = End::stopped;
  std::exception_ptr failure_;
  Real seconds_ = 0;
  int pictures_ = 0;
  std::thread thread_;  // last: it uses the rest
};
}  // namespace tape::movie
