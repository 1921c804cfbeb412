#include "apps/tapesim/run_store.hpp"

#include <fstream>

#include "cosim/run/new_file.hpp"

namespace tape::tapesim {
namespace {
/// What is kept; empty if the file is missing or of something else.
RunStore::Json load(const std::filesystem::path& file) {
  std::ifstream in(file);
  RunStore::Json kept = RunStore::Json::parse(in, nullptr, false);
  return kept.is_object() ? kept : RunStore::Json::object();
}
}  // namespace

std::optional<RunStore::Json> RunStore::find(const std::string& key) const {
  const Json kept = load(file_);
  return kept.contains(key) ? std::optional<Json>(kept[key]) : std::nullopt;
}

void RunStore::keep(const std::string& key, const Json& run) const {
  Json kept = load(file_);
  kept[key] = run;
  cosim::write_text(file_, kept.dump(1) + '\n');
}
}  // namespace tape::tapesim
