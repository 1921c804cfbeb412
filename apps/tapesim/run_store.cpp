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

void RunCost::take(const cosim::RunSummary& summary) {
  seconds = summary.wall, step_ms = summary.step_ms, newton = summary.newton_mean, failure = summary.failure;
  for (const cosim::Condition& condition : summary.conditions) unmet += !condition.met;
}

void RunStore::write(const RunCost& cost, Json& run) {
  const cosim::Distribution& ms = cost.step_ms;
  run["seconds"] = cost.seconds, run["newton_per_step"] = cost.newton, run["conditions_not_met"] = cost.unmet,
  run["failure"] = cost.failure;
  run["step_ms"] = {ms.mean, ms.p50, ms.p95, ms.max};
}

void RunStore::read(const Json& run, RunCost& cost) {
  cost.seconds = run.at("seconds"), cost.newton = run.at("newton_per_step"), cost.unmet = run.at("conditions_not_met");
  cost.failure = run.at("failure");
  const std::vector<Real> ms = run.at("step_ms");
  cost.step_ms = {ms.at(0), ms.at(1), ms.at(2), ms.at(3)};
}

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
