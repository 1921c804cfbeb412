#include "apps/tapesim/study_store.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

#include "cosim/run/new_file.hpp"

namespace tape::tapesim {
namespace {
using Json = nlohmann::json;

/// What is kept; empty if the file is missing or of something else.
Json load(const std::filesystem::path& file) {
  std::ifstream in(file);
  Json kept = Json::parse(in, nullptr, false);
  return kept.is_object() ? kept : Json::object();
}
std::vector<Real> flat(const std::vector<Vec3>& points) {
  std::vector<Real> numbers;
  for (const Vec3& p : points) numbers.insert(numbers.end(), p.data(), p.data() + 3);
  return numbers;
}
std::vector<Vec3> points(const std::vector<Real>& numbers) {
  std::vector<Vec3> out;
  for (std::size_t i = 0; i + 3 <= numbers.size(); i += 3) out.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
  return out;
}
}  // namespace

bool StudyStore::find(const std::string& key, StudyRun& run) const {
  const Json kept = load(file_);
  if (!kept.contains(key)) return false;
  try {
    const Json& j = kept[key];
    run.seconds = j.at("seconds"), run.newton = j.at("newton_per_step"), run.unmet = j.at("conditions_not_met");
    run.failure = j.at("failure");
    const std::vector<Real> ms = j.at("step_ms"), value = j.at("value");
    run.step_ms = {ms.at(0), ms.at(1), ms.at(2), ms.at(3)};
    run.measured = {value.at(0), value.at(1), points(j.at("points")), points(j.at("turns"))};
  } catch (const std::exception&) {  // damaged: as if it were not there
    return false;
  }
  return true;
}

void StudyStore::keep(const std::string& key, const StudyRun& run) const {
  Json kept = load(file_);
  const cosim::Distribution& ms = run.step_ms;
  kept[key] = {{"values", run.values},
               {"seconds", run.seconds},
               {"newton_per_step", run.newton},
               {"conditions_not_met", run.unmet},
               {"failure", run.failure},
               {"step_ms", {ms.mean, ms.p50, ms.p95, ms.max}},
               {"value", {run.measured.error, run.measured.value}},
               {"points", flat(run.measured.points)},
               {"turns", flat(run.measured.turns)}};
  cosim::write_text(file_, kept.dump(1) + '\n');
}
}  // namespace tape::tapesim
