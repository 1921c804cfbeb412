#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "cosim/scene/reader.hpp"

namespace cosim {
/// A YAML file whose sections are read by whoever knows them. At the end `require_all_used` refuses keys that nobody knew.
class SceneFile {
 public:
  /// @param overrides  "path.to.key=value"; a number in the path counts into a list: strips.0.length=0.2
  /// @throws InputError if the file cannot be read, is not YAML, or an override cannot be applied
  static SceneFile load(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});
  /// The same from memory. @param file  for messages, and its folder for the files that the scene names
  static SceneFile parse(const std::string& text, const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

  const std::filesystem::path& path() const { return file_; }
  Reader root() const { return {&root_, "", root_.where}; }
  Reader operator[](std::string_view section) const { return root()[section]; }

  /// Reads what section `name` holds of the fields of T; every value is checked. Several structs may share a section.
  template <Settings T>
  void read(std::string_view section, T& settings) const {
    root()[section].read(settings);
  }
  /// A section of switches, name: on|off. @param names  those that may stand there
  struct Switch {
    bool on;
    std::string where;  ///< "file:line"
  };
  std::map<std::string, Switch> switches(std::string_view section, const std::vector<std::string>& names) const;

  /// "file:line" of a dotted path, empty if it is not there.
  std::string where(std::string_view dotted) const;

  /// @throws InputError naming the first key that nobody asked for, with the names that come near
  void require_all_used() const { root().require_known(); }

 private:
  std::filesystem::path file_;
  Node root_;
};

/// The text of a file. @param name  of the file, and of what asks for it: what messages start with
/// @throws InputError if it is missing, no file, unreadable or above 64 MB
std::string read_whole_file(const std::filesystem::path& file, const std::string& name);

/// The first of `name` that exists: in the folder of `from` and in its parents, each also under `subfolder` and data/`subfolder`,
/// then in the project's own data/`subfolder`. Empty if there is none.
std::filesystem::path find_file(const std::filesystem::path& from, const std::string& subfolder, const std::string& name);
}  // namespace cosim
