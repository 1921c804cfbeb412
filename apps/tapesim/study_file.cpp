#include "apps/tapesim/study_file.hpp"

#include <numbers>

#include "cosim/scene/folder_name.hpp"
#include "cosim/scene/scene_file.hpp"

namespace tape::tapesim {
namespace {
constexpr Real kMostRuns = 1000;

Reference read_reference(const cosim::SceneFile& file, const std::vector<std::string>& grid_keys) {
  const cosim::Reader against = file["against"], form = against["closed_form"], finest = against["finest"];
  Reference reference;
  if (form.exists() == finest.exists()) against.fail("needs either closed_form: NAME or finest: true");
  if (finest) {
    if (!finest.flag()) finest.fail("can only be true");
    reference.measure = file["measure"].text_or("state");
    for (const cosim::Reader& key : against["of_each"].items()) reference.of_each.push_back(cosim::choose(key, grid_keys));
    if (const cosim::Reader within = against["within"]) {
      if (reference.figure().empty()) within.fail("needs a figure to measure");
      reference.within = within.number(Range::above(0, 1), "");
      reference.each = cosim::choose(against["each"], grid_keys);
    }
    return reference;
  }
  reference.kind = static_cast<Reference::Kind>(cosim::choose(form, {"heavy_elastica", "capstan", "kendall"}));
  if (reference.kind != Reference::Kind::heavy_elastica)
    reference.angle = against["angle_deg"].number(Range::above(0, 3600), "deg") * std::numbers::pi / 180;
  return reference;
}
}  // namespace

std::vector<std::vector<std::string>> Study::combinations() const {
  std::vector<std::vector<std::string>> all = {{}};
  for (const auto& [key, values] : grid) {
    std::vector<std::vector<std::string>> longer;
    for (const auto& start : all)
      for (const std::string& value : values) {
        longer.push_back(start);
        longer.back().push_back(value);
      }
    all = std::move(longer);
  }
  return all;
}

Study load_study(const std::filesystem::path& path, const std::vector<std::string>& more_overrides) {
  const cosim::SceneFile file = cosim::SceneFile::load(path);
  Study study;
  study.name = file["study"].text_or(path.stem().string());
  cosim::require_folder_name(file["study"], study.name);
  const cosim::Reader scene = file["scene"];
  study.scene = cosim::find_file(path, "scenes", scene.text());
  if (study.scene.empty()) scene.fail("no such scene beside the study, above it, or in data/scenes");
  if (std::filesystem::equivalent(study.scene, path)) scene.fail("is the study itself; say scenes/" + scene.text());
  const cosim::Reader fixed = file["set"], grid = file["grid"];
  for (const std::string& key : fixed.keys()) study.overrides.push_back(key + "=" + fixed[key].text());
  study.overrides.insert(study.overrides.end(), more_overrides.begin(), more_overrides.end());
  for (const std::string& key : grid.keys()) {
    study.grid.emplace_back(key, grid[key].texts());
    if (study.grid.back().second.empty()) grid[key].fail("needs at least one value");
  }
  for (const auto& [key, values] : study.grid)
    for (const std::string& set : study.overrides)
      if (set.starts_with(key + "="))
        grid[key].fail("is set to " + set.substr(key.size() + 1) + " as well: a key is either of the grid or set");
  if (study.grid.empty()) grid.fail("needs at least one key, such as solver.velocity_tol: [1e-2, 1e-3]");
  Real runs = 1;
  for (const auto& [key, values] : study.grid) runs *= static_cast<Real>(values.size());
  if (runs > kMostRuns) grid.fail("asks for " + tape::to_text(runs) + " runs (allowed: at most " + tape::to_text(kMostRuns) + ")");
  study.reference = read_reference(file, grid.keys());
  file.require_all_used();
  return study;
}
}  // namespace tape::tapesim
