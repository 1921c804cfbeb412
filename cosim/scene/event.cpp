#include "cosim/scene/event.hpp"

#include <algorithm>

#include "tape/core/error.hpp"

namespace cosim {
std::string to_text(const Event& e) {
  const auto k = static_cast<std::size_t>(e.quantity);
  std::string things = e.things[0];
  if (e.things.size() > 1) things += " and " + e.things[1];
  return std::string(enum_names(Quantity{})[k]) + " of " + things + (e.above ? " above " : " below ") + tape::to_text(e.level) + " " +
         std::string(unit_names(Quantity{})[k]) + " within " + tape::to_text(e.timeout) + " s";
}

Thing find_thing(const std::string& name, const tape::Scene& scene) {
  Thing found;
  const auto index = [&](const auto& things, const std::string& wanted) -> std::optional<std::size_t> {
    const auto it = std::ranges::find_if(things, [&](const auto& thing) { return thing.name == wanted; });
    if (it == things.end()) return {};
    return static_cast<std::size_t>(it - things.begin());
  };
  const std::size_t dot = name.rfind('.');
  const std::string part = dot == std::string::npos ? "" : name.substr(dot + 1);
  found.grip = index(scene.grips, name);
  found.body = index(scene.bodies, name);
  found.strip = index(scene.strips, part == "tip" || part == "root" ? name.substr(0, dot) : name);
  found.tip = part != "root";
  return found;
}

void require_things(const Event& event, const tape::Scene& scene) {
  for (const std::string& name : event.things) {
    const Thing thing = find_thing(name, scene);
    if (event.quantity == Quantity::force) {
      const bool bears = thing.grip || (thing.body && scene.bodies[*thing.body].motion != tape::Motion::fixed);
      if (!bears) throw tape::InputError(name + ": no grip, no link and no body that moves is called so");
    } else if (!thing.body && !thing.strip) {
      throw tape::InputError(name + ": no body and no strip (or its tip or root) is called so");
    }
  }
}
}  // namespace cosim
