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
    RunStore::read(j, run);
    const std::vector<Real> value = j.at("value");
    run.measured = {value.at(0), value.at(1), points(j.at("points")), points(j.at("turns"))};
  });
}

void StudyStore::keep(const std::string& key, const StudyRun& run) const {
  Json j{{"values", run.values},
         {"value", {run.measured.error, run.measured.value}},
         {"points", flat(run.measured.points)},
         {"turns", flat(run.measured.turns)}};
  RunStore::write(run, j);
  store_.keep(key, j);
}
}  // namespace tape::tapesim
