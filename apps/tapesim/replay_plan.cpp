#include "apps/tapesim/replay_plan.hpp"

#include <algorithm>

#include "cosim/scene/folder_name.hpp"
#include "cosim/scene/node.hpp"
#include "cosim/scene/scene_file.hpp"
#include "tape/model/scene.hpp"

namespace tape::tapesim {
namespace {
namespace fs = std::filesystem;
constexpr Range kRepeats = Range::closed(1, 100);

std::vector<std::string> all_models() {
  std::vector<std::string> names;
  for (std::string_view name : enum_names(Model{})) names.emplace_back(name);
  return names;
}

void read_episodes(const cosim::Reader& list, const fs::path& from, ReplayPlan& plan) {
  for (const cosim::Reader& one : list.items()) {
    plan.episodes.push_back(cosim::find_file(from, "episodes", one.text()));
    if (plan.episodes.back().empty()) one.fail("no such episode beside this file, above it, or in data/episodes");
  }
  if (plan.episodes.empty()) list.fail("needs at least one EPISODE.yaml");
}

void read_models(const cosim::SceneFile& file, ReplayPlan& plan) {
  for (const cosim::Reader& model : file["models"].items()) {
    plan.models.push_back(all_models()[cosim::choose(model, all_models())]);
    if (std::ranges::count(plan.models, plan.models.back()) > 1) model.fail("is named already");
  }
  if (plan.models.empty()) plan.models = {""};
  const cosim::Reader baseline = file["baseline"];
  plan.baseline = baseline ? plan.models[cosim::choose(baseline, plan.models)] : plan.models.front();
}
}  // namespace

ReplayPlan load_plan(const fs::path& path) {
  const cosim::SceneFile file = cosim::SceneFile::load(path);
  ReplayPlan plan;
  const cosim::Reader name = file["replay"];
  if (!name) {
    plan.name = file["episode"].text();
    plan.episodes = {path};
    plan.models = {""};
  } else {
    plan.name = name.text();
    read_episodes(file["episodes"], path, plan);
    read_models(file, plan);
    plan.repeats = file["repeats"].integer_or(1, kRepeats);
    const cosim::Reader set = file["set"], beside = file["beside"];
    const std::vector<std::string> all = all_models();
    for (const std::string& key : set.keys()) plan.overrides.push_back(key + "=" + set[key].text());
    for (const std::string& whose : beside.keys()) {
      plan.beside.push_back({whose, {}});
      for (const std::string& model : beside[whose].keys()) {
        const cosim::Reader error = beside[whose][model];
        if (std::ranges::find(all, model) == all.end()) error.fail("is of no model; " + cosim::suggestion(model, {all.begin(), all.end()}));
        plan.beside.back().second[model] = error.number(Range::non_negative(), "px");
      }
    }
    file.require_all_used();
  }
  cosim::require_folder_name(name ? name : file["episode"], plan.name);
  return plan;
}
}  // namespace tape::tapesim
