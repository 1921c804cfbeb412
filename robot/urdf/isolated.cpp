#include "robot/urdf/isolated.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>

#include "robot/model/robot_model.hpp"

namespace robot {
namespace {
void limit_memory(std::size_t megabytes) {
  rlim_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;  // the address space may be large already, as under the address sanitizer
  const rlim_t bytes = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + megabytes * 1'000'000;
  const rlimit limit{bytes, bytes};
  setrlimit(RLIMIT_AS, &limit);
}

[[noreturn]] void run_child(const std::function<std::string()>& work, int pipe, unsigned seconds, std::size_t megabytes) {
  std::signal(SIGALRM, SIG_DFL);
  std::signal(SIGPIPE, SIG_DFL);
  alarm(seconds);
  if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) dup2(nowhere, STDERR_FILENO);
  bool done = false;
  try {
    limit_memory(megabytes);
    const std::string result = work();
    std::size_t sent = 0;
    while (sent < result.size()) {
      const ssize_t n = write(pipe, result.data() + sent, result.size() - sent);
      if (n < 0 && errno != EINTR) break;
      if (n > 0) sent += static_cast<std::size_t>(n);
    }
    done = sent == result.size();
  } catch (...) {
    done = false;
  }
  _exit(done ? 0 : 1);
}
}  // namespace

std::optional<std::string> run_isolated(const std::function<std::string()>& work, unsigned seconds, std::size_t megabytes) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw InputError(std::string("no pipe to a child process: ") + std::strerror(errno));
  const pid_t child = fork();
  if (child == 0) run_child(work, ends[1], seconds, megabytes);
  close(ends[1]);
  std::string result;
  char block[65536];
  for (ssize_t n = 1; child > 0 && n != 0;) {
    n = read(ends[0], block, sizeof block);
    if (n > 0) result.append(block, static_cast<std::size_t>(n));
    if (n < 0 && errno != EINTR) break;
  }
  close(ends[0]);
  if (child < 0) throw InputError("no child process can be made");
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return std::nullopt;
  return result;
}
}  // namespace robot
