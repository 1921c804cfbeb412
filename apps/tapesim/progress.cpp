#include "apps/tapesim/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "apps/tapesim/interrupt.hpp"

namespace tape::tapesim {
namespace {
/// Letters in a line of the terminal: a longer one would run over the next.
std::size_t terminal_width() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col : 80u;
}
}  // namespace

std::string duration_text(double seconds) {
  const long s = std::lround(seconds);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
}

std::function<bool(int done, int all)> watched_video() {
  return [progress = std::shared_ptr<Progress>()](int done, int all) mutable {
    if (!progress) progress = std::make_shared<Progress>("video", all);
    progress->update(done);
    return !interrupted();
  };
}

Progress::Progress(std::string what, int total)
    : what_(std::move(what)), total_(std::max(1, total)), terminal_(isatty(STDERR_FILENO) == 1), start_(Clock::now()), last_(start_) {
  if (total > 0) update(0);
}

Progress::~Progress() {
  if (open_) fmt::print(stderr, "\n");
}

void Progress::update(int done, const std::string& note) {
  const double share = std::min(1.0, static_cast<double>(done) / total_);
  std::string text = note;
  if (done > 0 && done < total_) text += (note.empty() ? "" : ", ") + duration_text(seconds_since(start_) * (1 - share) / share) + " left";
  if (terminal_) {
    if (open_ && done < total_ && seconds_since(last_) < 0.1) return;
    const auto filled = static_cast<std::size_t>(30 * share);
    const std::string line =
        fmt::format("{} [{:<30}] {:3.0f} % {}/{} {}", what_, std::string(filled, '#'), 100 * share, done, total_, text);
    fmt::print(stderr, "\r{}\033[K", line.substr(0, terminal_width() - 1));
    std::fflush(stderr);
    open_ = true;
  } else {
    const int tenth = static_cast<int>(10 * share + 1e-9);
    if (tenth == tenth_ && seconds_since(last_) < 30) return;
    fmt::print(stderr, "{}: {}/{} ({:.0f} %) {}\n", what_, done, total_, 100 * share, text);
    tenth_ = tenth;
  }
  last_ = Clock::now();
}
}  // namespace tape::tapesim
