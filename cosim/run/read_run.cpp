#include "cosim/run/read_run.hpp"

#include "cosim/roll/settled_roll.hpp"
#include "cosim/scene/read_scene.hpp"

namespace cosim {
RunInput read_run(SceneFile scene) {
  RunInput input{.file = std::move(scene),
                 .setup = {},
                 .robots = {},
                 .events = {},
                 .goals = {},
                 .phases = {},
                 .record = {},
                 .figures = {},
                 .roll_asset = {}};
  const SceneFile& file = input.file;
  BothWorlds both = read_worlds(file);
  input.setup.scene = std::move(both.tape), input.robots = std::move(both.robots), input.events = std::move(both.events);
  input.goals = std::move(both.goals), input.phases = std::move(both.phases);
  std::vector<std::string> effects;
  for_each_effect([&]<class T>(std::type_identity<T>) {
    effects.emplace_back(T::name);
    file.read(T::name, params<T>(input.setup.effects));
  });
  for (const auto& [name, chosen] : file.switches("effects", effects)) input.setup.forced[name] = chosen.on;
  file.read("solver", input.setup.newton);
  file.read("solver", input.setup.linear);
  file.read("cutting", input.setup.cutting);
  if (file["cutting"] && input.setup.scene.blades.empty()) file["cutting"].fail("it names no blades");
  file.read("record", input.record);
  if (const Reader figures = file["record"]["figures"]) input.figures = figures.texts();
  const Reader roll = file["roll"];
  input.settle_roll = roll["settle"].flag_or(true);
  const std::optional<Model>& model = input.setup.scene.model;
  if (model && is_reduced(*model)) {
    if (!input.settle_roll) roll["settle"].fail("a reduced roll starts from one at rest");
    for (std::size_t s = 0; s < input.setup.scene.strips.size(); ++s)
      if (input.setup.scene.strips[s].winding && !holds_together(input.setup, s))
        file["model"].fail("a reduced roll needs tape that adheres to itself (interfaces: [tape.sticky, tape], and its effect not off)");
  }
  if (const Reader asset = roll["asset"]) {
    if (!input.settle_roll) asset.fail("of no use where settle is off");
    input.roll_asset = file.path().parent_path() / asset.text();
  }
  return input;
}
}  // namespace cosim
