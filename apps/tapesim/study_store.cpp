#include "apps/tapesim/study_store.hpp"

namespace tape::tapesim {
namespace {
using Json = RunStore::Json;

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
  return store_.find(key, [&](const Json& j) {
    run.seconds = j.at("seconds"), run.newton = j.at("newton_per_step"), run.unmet = j.at("conditions_not_met");
    run.failure = j.at("failure");
    const std::vector<Real> ms = j.at("step_ms"), value = j.at("value");
    run.step_ms = {ms.at(0), ms.at(1), ms.at(2), ms.at(3)};
    run.measured = {value.at(0), value.at(1), points(j.at("points")), points(j.at("turns"))};
  });
}

void StudyStore::keep(const std::string& key, const StudyRun& run) const {
  const cosim::Distribution& ms = run.step_ms;
  store_.keep(key, {{"values", run.values},
                    {"seconds", run.seconds},
                    {"newton_per_step", run.newton},
                    {"conditions_not_met", run.unmet},
                    {"failure", run.failure},
                    {"step_ms", {ms.mean, ms.p50, ms.p95, ms.max}},
                    {"value", {run.measured.error, run.measured.value}},
                    {"points", flat(run.measured.points)},
                    {"turns", flat(run.measured.turns)}});
}
}  // namespace tape::tapesim
