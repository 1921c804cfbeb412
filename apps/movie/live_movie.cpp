#include "apps/movie/live_movie.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <chrono>

#include "tape/core/stopwatch.hpp"

namespace tape::movie {
namespace {
/// On Linux each thread has its own; those that it starts, and programs, inherit it.
void take_low_priority() {
  constexpr int kNice = 10;
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);
}
}  // namespace

LiveMovie::LiveMovie(PictureParams params, std::filesystem::path file)
    : params_(std::move(params)), file_(std::move(file)), survey_(params_), thread_([this] { work(); }) {}

LiveMovie::~LiveMovie() {
  {
    const std::lock_guard lock(mutex_);
    given_up_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void LiveMovie::start_mesh(RecordedMesh mesh) { meshes_.push_back(std::move(mesh)); }

void LiveMovie::add(RecordedFrame frame) {
  {
    const std::lock_guard lock(mutex_);
    if (over_) return;
    waiting_.push_back({&meshes_.back(), std::move(frame)});
    ++added_;
  }
  changed_.notify_all();
}

LiveMovie::End LiveMovie::finish(const Watch& watch) {
  constexpr std::chrono::milliseconds kLook(100);
  std::unique_lock lock(mutex_);
  complete_ = true;
  changed_.notify_all();
  while (!changed_.wait_for(lock, kLook, [&] { return over_; }))
    if (!watch(done_, added_)) {
      given_up_ = true;
      changed_.notify_all();
    }
  lock.unlock();
  thread_.join();
  if (failure_) std::rethrow_exception(failure_);
  return end_;
}

void LiveMovie::work() {
  take_low_priority();
  try {
    for (bool more = true; more;) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return !waiting_.empty() || complete_ || given_up_; });
      if (given_up_) break;
      std::optional<Item> item;
      if (!waiting_.empty()) item = std::move(waiting_.front()), waiting_.pop_front();
      lock.unlock();
      Real ms = 0;
      {
        const Stopwatch watch(ms);
        more = item && shoot(*item);
        if (!item && movie_) {
          movie_->finish();
          end_ = End::made;
        }
      }
      lock.lock();
      seconds_ += 1e-3 * ms;
      ++done_;
    }
  } catch (...) {
    failure_ = std::current_exception();
  }
  if (movie_) pictures_ = movie_->pictures();
  movie_.reset();  // on the thread that made it; unless finished nothing is left of it
  const std::lock_guard lock(mutex_);
  over_ = true;
  waiting_.clear();
  changed_.notify_all();
}

/// @return false where the motion has left its stage
bool LiveMovie::shoot(const Item& item) {
  survey_.add(*item.mesh, item.frame);
  if (!stage_) stage_ = survey_.stage();
  if (!(survey_.stage() == *stage_)) {
    end_ = End::left_stage;
    return false;
  }
  if (!movie_) movie_.emplace(params_, *stage_, *item.mesh, item.frame, file_);
  movie_->add(*item.mesh, item.frame);
  return true;
}
}  // namespace tape::movie
