#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cosim/episode/import.hpp"
#include "cosim/scene/scene_file.hpp"

namespace cosim {
namespace {
using Json = nlohmann::json;
namespace fs = std::filesystem;

Json parsed(const std::string& text, const std::string& where) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& e) {
    throw InputError(where + ": is no JSON: " + e.what());
  }
}

/// meta/info.json of a data set.
class Info {
 public:
  explicit Info(const fs::path& file) : name_(file.string()), json_(parsed(read_whole_file(file, name_), name_)) {
    const std::string version = value<std::string>("codebase_version");
    if (version != "v2.1") throw InputError(fmt::format("{}: codebase_version = {} (allowed: v2.1)", name_, version));
  }
  template <class T>
  T value(const char* key) const {
    try {
      return json_.at(key).get<T>();
    } catch (const Json::exception&) {
      throw InputError(fmt::format("{}: {} is missing or of another type", name_, key));
    }
  }
  /// Names of a feature's numbers, as one list or a list in a list; none if there is no such feature.
  std::vector<std::string> names(const std::string& feature) const {
    const Json features = value<Json>("features");
    if (!features.contains(feature)) return {};
    try {
      Json names = features[feature].at("names");
      if (names.is_object() && names.size() == 1) names = names.items().begin().value();
      if (names.is_array() && names.size() == 1 && names[0].is_array()) names = names[0];
      auto all = names.get<std::vector<std::string>>();
      if (all.size() == features[feature].at("shape").at(0).get<std::size_t>()) return all;
    } catch (const Json::exception&) {
    }
    throw InputError(fmt::format("{}: features.{}.names is missing or not a name for each of its numbers", name_, feature));
  }
  const std::string& name() const { return name_; }

 private:
  std::string name_;
  Json json_;
};

/// Rows that meta/episodes.jsonl announces.
std::size_t announced_rows(const fs::path& file, int episode) {
  std::istringstream lines(read_whole_file(file, file.string()));
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.find_first_not_of(" \r\t") == line.npos) continue;
    const std::string where = fmt::format("{}:{}", file.string(), number);
    const Json one = parsed(line, where);
    try {
      if (one.at("episode_index").get<int>() == episode) return one.at("length").get<std::size_t>();
    } catch (const Json::exception&) {
      throw InputError(where + ": episode_index or length is missing or no whole number");
    }
  }
  throw InputError(fmt::format("{}: there is no episode {}", file.string(), episode));
}

std::vector<TableJoint> table_joints(const Info& info, const LeRobotUnits& units) {
  const std::vector<std::string> states = info.names("observation.state"), actions = info.names("action");
  if (states.empty()) throw InputError(info.name() + ": features.observation.state is missing");
  if (!actions.empty() && actions != states)
    throw InputError(info.name() + ": features.action.names differ from those of observation.state (allowed: the same joints)");
  std::vector<TableJoint> joints;
  for (const std::string& joint : states)
    joints.push_back({joint, units.usual, "state." + joint, actions.empty() ? "" : "action." + joint});
  for (const auto& [name, unit] : units.of) {
    bool found = false;
    for (TableJoint& joint : joints)
      if (fnmatch(name.c_str(), joint.name.c_str(), 0) == 0) joint.unit = unit, found = true;
    if (!found)
      throw InputError(fmt::format("{}: there is no joint {}, whose unit {} is given (allowed: {})", info.name(), name, to_text(unit),
                                   fmt::join(states, ", ")));
  }
  return joints;
}
}  // namespace

MotionStream import_lerobot(const fs::path& folder, int episode, const fs::path& table, const LeRobotUnits& units) {
  if (table.extension() == ".parquet")
    throw InputError(
        table.string() +
        ": Parquet is not read; convert the table to CSV with columns timestamp, state.<joint>, action.<joint>, with pandas as "
        "cosim/episode/README.md shows");
  const Info info(folder / "meta" / "info.json");
  const std::size_t rows = announced_rows(folder / "meta" / "episodes.jsonl", episode);
  MotionStream motion = import_csv(table, "robot", "timestamp", table_joints(info, units));
  const std::vector<Real>& times = motion.times;
  if (times.size() != rows)
    throw InputError(fmt::format("{}: has {} rows (allowed: {}, as meta/episodes.jsonl says of episode {})", table.string(), times.size(),
                                 rows, episode));
  const Real fps = info.value<Real>("fps"), found = static_cast<Real>(rows - 1) / (times.back() - times.front());
  if (!(std::abs(found - fps) < 0.01 * fps))
    throw InputError(fmt::format("{}: has {:.4g} rows a second (allowed: {:g}, as meta/info.json says)", table.string(), found, fps));
  return motion;
}
}  // namespace cosim
