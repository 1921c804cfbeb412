#include "apps/video/process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

#include <cerrno>
#include <cstring>
#include <utility>

#include "tape/core/error.hpp"

namespace tape::video {
namespace {
/// Starts the program with `input` as standard input and `errors` as standard error; 0 or the error number.
int spawn(pid_t* id, const std::vector<std::string>& arguments, int input, int errors) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, errors, STDERR_FILENO);
  posix_spawnattr_t attributes;  // a process group of its own: Ctrl-C is for us, who then finish the file
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  std::vector<char*> words;
  words.reserve(arguments.size() + 1);
  for (const std::string& a : arguments) words.push_back(const_cast<char*>(a.c_str()));
  words.push_back(nullptr);
  const int failure = posix_spawnp(id, words[0], &actions, &attributes, words.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return failure;
}
}  // namespace

Process::Process(const std::vector<std::string>& arguments) : errors_(std::tmpfile()) {
  // A socket instead of a pipe: writing to a reader that is gone is then an error instead of a signal.
  int ends[2];
  if (!errors_ || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends)) throw InputError(arguments[0] + ": " + std::strerror(errno));
  input_ = ends[0];
  const int failure = spawn(&id_, arguments, ends[1], fileno(errors_));
  close(ends[1]);
  if (!failure) return;
  close(input_);
  std::fclose(errors_);
  throw InputError("cannot start " + arguments[0] + " (" + std::strerror(failure) + "); install the package " + arguments[0] +
                   " or put the program on the PATH");
}

Process::~Process() {
  if (input_ >= 0) close(input_);
  if (id_ > 0) {
    kill(id_, SIGKILL);
    waitpid(id_, nullptr, 0);
  }
  std::fclose(errors_);
}

bool Process::send(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(input_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
  return true;
}

bool Process::wait() {
  close(std::exchange(input_, -1));
  int status = 0;
  while (waitpid(id_, &status, 0) < 0 && errno == EINTR) {
  }
  id_ = -1;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::string Process::messages() const {
  std::string text(4096, '\0');
  const ssize_t n = pread(fileno(errors_), text.data(), text.size(), 0);
  text.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}
}  // namespace tape::video
