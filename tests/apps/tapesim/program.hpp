#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace tape::test {
/// What a finished program left.
struct Outcome {
  int exit_code = -1;
  std::string out, err;
};
/// A program that is running; by default tapesim.
class Program {
 public:
  struct Limits {
    long file_bytes = -1;  ///< no file may grow beyond; negative: no limit
  };
  explicit Program(const std::vector<std::string>& arguments) : Program(arguments, Limits{}) {}
  Program(const std::vector<std::string>& arguments, Limits limits);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  /// Waits until the program has written `text` to standard error.  @return false if it ended first
  bool wait_for_error_text(const std::string& text);
  void signal(int number) const;
  Outcome wait();

 private:
  int id_, files_[2];
  std::filesystem::path names_[2];
};
Outcome tapesim(const std::vector<std::string>& arguments);

/// A folder that is gone after the test.
class Folder {
 public:
  Folder();
  ~Folder();
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  /// Writes a file and returns its path.
  std::string file(const std::string& name, const std::string& text) const;
  std::vector<std::string> names(const std::string& folder = "") const;  ///< of what lies in it, sorted

 private:
  std::filesystem::path path_;
};
std::string read(const std::filesystem::path& file);
}  // namespace tape::test
