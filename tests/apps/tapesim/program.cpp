#include "tests/apps/tapesim/program.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace tape::test {
namespace fs = std::filesystem;
namespace {
int exit_code_of(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

void limit_files(long bytes) {
  if (bytes < 0) return;
  const rlimit limit{static_cast<rlim_t>(bytes), static_cast<rlim_t>(bytes)};
  setrlimit(RLIMIT_FSIZE, &limit);
}
}  // namespace

Program::Program(const std::vector<std::string>& arguments, Limits limits) {
  for (int k = 0; k < 2; ++k) {
    std::string name = (fs::temp_directory_path() / "tapesim_output_XXXXXX").string();
    files_[k] = mkstemp(name.data());
    names_[k] = name;
  }
  std::vector<char*> argv = {const_cast<char*>(TAPESIM)};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  id_ = fork();
  if (id_ != 0) return;
  dup2(files_[0], STDOUT_FILENO);
  dup2(files_[1], STDERR_FILENO);
  limit_files(limits.file_bytes);
  execv(TAPESIM, argv.data());
  _exit(127);
}

Program::~Program() {
  if (id_ > 0) {
    kill(id_, SIGKILL);
    waitpid(id_, nullptr, 0);
  }
  for (int k = 0; k < 2; ++k) {
    close(files_[k]);
    fs::remove(names_[k]);
  }
}

bool Program::wait_for_error_text(const std::string& text) {
  while (read(names_[1]).find(text) == std::string::npos) {
    siginfo_t info{};
    waitid(P_PID, static_cast<id_t>(id_), &info, WEXITED | WNOHANG | WNOWAIT);
    if (info.si_pid != 0) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

void Program::signal(int number) const { kill(id_, number); }

Outcome Program::wait() {
  int status = 0;
  waitpid(id_, &status, 0);
  id_ = -1;
  return {exit_code_of(status), read(names_[0]), read(names_[1])};
}

Outcome tapesim(const std::vector<std::string>& arguments) { return Program(arguments).wait(); }

Folder::Folder() {
  std::string name = (fs::temp_directory_path() / "tapesim_test_XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
  path_ = name;
}
Folder::~Folder() { fs::remove_all(path_); }

std::string Folder::file(const std::string& name, const std::string& text) const {
  std::ofstream(path_ / name, std::ios::binary) << text;
  return (path_ / name).string();
}

std::vector<std::string> Folder::names(const std::string& folder) const {
  std::vector<std::string> names;
  if (!fs::exists(path_ / folder)) return names;
  for (const auto& entry : fs::directory_iterator(path_ / folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string read(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}
}  // namespace tape::test
