#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "cosim/exchange/robots.hpp"
#include "cosim/run/summary.hpp"

namespace tape::report {
using cosim::RunSummary;
/// Keys stay in the order in which they are written.
using Json = nlohmann::ordered_json;

/// What a report says about the program that made it.
struct Provenance {
  std::string scene_file, version, backend;
  int threads = 1;
  int first_step = 0;  ///< step that the run was resumed from
};

/// Every setting of a run, by section. Numbers that are not finite become null, as everywhere in JSON.
Json settings_json(const Setup& setup, const cosim::RobotScene& robots);
/// The contents of report.json (cosim/run/README.md).
Json report_json(const Provenance& provenance, const World& world, const cosim::RobotScene& robots, const RunSummary& summary);

/// A settings struct by its list of fields.
template <Settings T>
void add_fields(Json& section, T settings) {
  settings.fields([&](const char* name, auto& value, const char*, Range, const char*) {
    using V = std::remove_cvref_t<decltype(value)>;
    if constexpr (NamedEnum<V>)
      section[name] = to_text(value);
    else if constexpr (std::is_same_v<V, Vec3>)
      section[name] = {value.x(), value.y(), value.z()};
    else
      section[name] = value;
  });
}
}  // namespace tape::report
