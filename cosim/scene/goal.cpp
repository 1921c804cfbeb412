#include "cosim/scene/goal.hpp"

#include <algorithm>

namespace cosim {
std::vector<Goal> read_goals(const SceneFile& file, const tape::Scene& scene, const RobotScene& robots) {
  std::vector<Goal> goals;
  for (const Reader& entry : file["conditions"].items()) {
    Goal goal{.name = entry["name"].text(), .claim = read_claim(entry, scene, robots)};
    if (std::ranges::find(goals, goal.name, &Goal::name) != goals.end()) entry["name"].fail("there is a condition of this name already");
    goal.held = entry["held"].number_or(0, Range::closed(0, scene.time.duration), "s");
    goals.push_back(std::move(goal));
  }
  return goals;
}
}  // namespace cosim
