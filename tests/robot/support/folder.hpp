#pragma once
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace robot::test {
namespace fs = std::filesystem;

/// A new folder, which goes with its scope.
class Folder {
 public:
  Folder() {
    std::string name = fs::temp_directory_path() / "robot_test_XXXXXX";
    if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const fs::path& path() const { return path_; }
  /// Makes the folders above it, too.
  fs::path write(const fs::path& file, const std::string& text) const {
    fs::create_directories((path_ / file).parent_path());
    std::ofstream(path_ / file, std::ios::binary) << text;
    return path_ / file;
  }

 private:
  fs::path path_;
};

/// A text file in a folder of its own, for one expression.
class TextFile {
 public:
  explicit TextFile(const std::string& text) : path_(folder_.write("file", text)) {}
  operator const fs::path&() const { return path_; }

 private:
  Folder folder_;
  fs::path path_;
};
}  // namespace robot::test
