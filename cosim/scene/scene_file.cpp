#include "cosim/scene/scene_file.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>

#include "tape/core/error.hpp"

namespace cosim {
namespace {
namespace fs = std::filesystem;
using tape::InputError;

void name_place(Node& node, const std::string& where) {
  node.where = where;
  for (Node& item : node.items) name_place(item, where);
  for (auto& [key, value] : node.entries) name_place(value, where);
}

std::vector<std::string> split_path(const std::string& dotted) {
  std::vector<std::string> keys;
  std::istringstream stream(dotted);
  for (std::string key; std::getline(stream, key, '.');) keys.push_back(key);
  if (dotted.empty() || dotted.back() == '.') keys.push_back("");
  return keys;
}

/// The child `key` of a section or list; a section makes it if needed.
Node& child(Node& node, const std::string& key, const std::string& where) {
  if (node.kind == Node::Kind::list) {
    std::size_t i = 0;
    const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), i);
    if (error != std::errc() || end != key.data() + key.size() || i >= node.items.size())
      throw InputError(where + ": " + key + " does not count into a list of " + std::to_string(node.items.size()));
    return node.items[i];
  }
  if (node.kind == Node::Kind::empty) node.kind = Node::Kind::map;
  if (node.kind != Node::Kind::map) throw InputError(where + ": " + key + " stands below " + node.summary() + ", which is no section");
  if (Node* known = node.find(key)) return *known;
  node.entries.emplace_back(key, Node{.where = where});
  return node.entries.back().second;
}

void apply_override(Node& root, const std::string& text) {
  const std::string where = "--set " + text;
  const std::size_t equals = text.find('=');
  const std::string dotted = text.substr(0, equals);
  if (equals == std::string::npos) throw InputError(where + ": must be path.to.key=value");
  if (equals + 1 == text.size()) throw InputError(where + ": has no value; ~ stands for the default");
  const std::vector<std::string> keys = split_path(dotted);
  if (std::find(keys.begin(), keys.end(), "") != keys.end()) throw InputError(where + ": must be path.to.key=value");
  Node* node = &root;
  for (const std::string& key : keys) node = &child(*node, key, where);
  *node = parse_yaml(text.substr(equals + 1), "--set");
  name_place(*node, "--set");
}
}  // namespace

SceneFile SceneFile::load(const fs::path& file, const std::vector<std::string>& overrides) {
  return parse(read_whole_file(file, file.string()), file, overrides);
}

SceneFile SceneFile::parse(const std::string& text, const fs::path& file, const std::vector<std::string>& overrides) {
  SceneFile scene;
  scene.file_ = file;
  scene.root_ = parse_yaml(text, file.string());
  if (scene.root_.kind == Node::Kind::empty) throw InputError(file.string() + ":1: the file is empty");
  if (scene.root_.kind != Node::Kind::map)
    throw InputError(scene.root_.where + ": must be a section of keys, not " + scene.root_.summary());
  for (const std::string& text_of_one : overrides) apply_override(scene.root_, text_of_one);
  return scene;
}

std::map<std::string, SceneFile::Switch> SceneFile::switches(std::string_view section, const std::vector<std::string>& names) const {
  std::map<std::string, Switch> found;
  const Reader reader = root()[section];
  for (const std::string& name : names)
    if (const Reader one = reader[name]) found[name] = {one.flag(), one.where()};
  return found;
}

std::string SceneFile::where(std::string_view dotted) const {
  const Node* node = &root_;
  for (const std::string& key : split_path(std::string(dotted)))
    if (!(node = node->find(key))) return "";
  return node->where;
}

std::string read_whole_file(const fs::path& file, const std::string& name) {
  std::error_code error;
  if (!fs::exists(file, error)) throw InputError(name + ": there is no such file");
  if (!fs::is_regular_file(file, error)) throw InputError(name + ": is not a file");
  if (constexpr std::uintmax_t kLimit = 64'000'000; fs::file_size(file, error) > kLimit)
    throw InputError(name + ": is too large (allowed: 64 MB)");
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw InputError(name + ": cannot be read");
  return text.str();
}

fs::path find_file(const fs::path& from, const std::string& subfolder, const std::string& name) {
  std::error_code error;
  const auto there = [&](const fs::path& candidate) { return fs::is_regular_file(candidate, error); };
  fs::path folder = fs::absolute(from, error).parent_path();
  for (bool last = false; !last; folder = folder.parent_path()) {
    last = folder == folder.parent_path();
    for (const fs::path& candidate : {folder / name, folder / subfolder / name, folder / "data" / subfolder / name})
      if (there(candidate)) return candidate;
  }
  const fs::path own = fs::path(TAPE_DATA_DIR) / subfolder / name;
  return there(own) ? own : fs::path();
}
}  // namespace cosim
