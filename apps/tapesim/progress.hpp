#pragma once
#include <chrono>
#include <functional>
#include <string>

namespace tape::tapesim {
/// Says on standard error how far a long work is: a bar with the time left on a terminal, else a line at the start, each tenth and each
/// half minute.
class Progress {
 public:
  Progress(std::string what, int total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void update(int done, const std::string& note = "");

 private:
  using Clock = std::chrono::steady_clock;
  double seconds_since(Clock::time_point t) const { return std::chrono::duration<double>(Clock::now() - t).count(); }
  std::string what_;
  int total_, tenth_ = -1;
  bool terminal_, open_ = false;  // open_: the terminal's cursor stands behind a bar
  Clock::time_point start_, last_;
};

/// Shows how far a movie is, from its first call on; false after Ctrl-C.
std::function<bool(int done, int all)> watched_video();

/// "3 s", "2 min 05 s", "1 h 02 min".
std::string duration_text(double seconds);
}  // namespace tape::tapesim
