#include "apps/tapesim/recorded_run.hpp"

#include <fmt/format.h>

#include "apps/tapesim/interrupt.hpp"
#include "cosim/exchange/exchange.hpp"
#include "robot/urdf/describe.hpp"
#include "tape/core/execution.hpp"

namespace tape::tapesim {
void add_run(Hash& hash, const LoadedWorld& loaded, const State& start, Backend backend) {
  const cosim::RobotScene& robots = loaded.input.run.robots;
  hash.add(fmt::format("{} {} {}\n", program_hash().text(), threads(), runs_on_cuda(backend, loaded.world)));
  hash.add(report::settings_json(loaded.world.setup, robots).dump() + world_hash(loaded.world) + start.hash());
  for (const cosim::RobotPart& part : robots.robots) {
    hash.add(robot::describe(*part.model));
    for (const auto& [a, b] : part.model->may_overlap) hash.add(fmt::format("{} {}\n", a, b));
    for (const cosim::RobotMotion& motion : part.motions) hash.add_file(motion.file);
  }
}

Backend backend_of(const std::string& name) {
  const auto names = enum_names(Backend{});
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return static_cast<Backend>(i);
  throw SettingsError("--backend", name, "auto, cpu or cuda");
}

cosim::RunLog simulate_into(RunFolder& folder, LoadedWorld& loaded, Stepper& stepper, State& state, int steps, const OnStep& on_step) {
  const int first = state.step;
  cosim::RunOptions options{.max_steps = steps,
                            .record = loaded.input.run.record,
                            .events = loaded.input.run.events,
                            .goals = loaded.input.run.goals,
                            .phases = loaded.input.run.phases};
  options.stop_asked = interrupted;
  options.on_step = [&](const State& now, const cosim::StepRow& row) {
    folder.add_step(row);
    on_step(now, row);
  };
  options.on_cut = [&] { folder.start_mesh(); };
  auto* coupled = dynamic_cast<cosim::CoupledStepper*>(&stepper);  // none where there are no robots
  options.on_record = [&](const State& now) {
    folder.add_state(now, now.step > first ? stepper.contact_force() : std::vector<Real>(),
                     coupled ? coupled->records(now) : std::vector<cosim::RobotRecord>());
  };
  return cosim::simulate(loaded.world, stepper, state, options);
}

void write_report(const RunFolder& folder, const report::Json& json) { cosim::write_text(folder / "report.json", json.dump(2) + '\n'); }

report::Json commit_run(RunFolder& folder, const State& end, const LoadedWorld& loaded, const report::Provenance& provenance,
                        const cosim::RunSummary& summary) {
  report::Json json = report::report_json(provenance, loaded.world, loaded.input.run.robots, summary);
  folder.commit(end);
  write_report(folder, json);
  return json;
}
}  // namespace tape::tapesim
