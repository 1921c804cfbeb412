#pragma once
#include <sys/types.h>

#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

namespace tape::video {
/// A program that runs beside this one and reads from it.
class Process {
 public:
  /// @param arguments  the program, looked up on the PATH, and its arguments  @throws InputError where it cannot be started
  explicit Process(const std::vector<std::string>& arguments);
  /// Ends the program if it still runs.
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  /// Sends bytes to its standard input; false: it reads no longer.
  bool send(std::span<const std::uint8_t> bytes);
  /// Closes its standard input and waits for its end; true: it reports success.
  bool wait();
  /// What it has written to standard error.
  std::string messages() const;

 private:
  int input_ = -1;  // our end of a socket pair
  pid_t id_ = -1;   // -1: has ended
  std::FILE* errors_ = nullptr;
};
}  // namespace tape::video
