#pragma once
#include "apps/report/json.hpp"
#include "apps/tapesim/run_folder.hpp"
#include "apps/tapesim/scene_input.hpp"
#include "cosim/run/summary.hpp"
#include "tape/core/hash.hpp"

namespace tape::tapesim {
/// Adds what decides a run beside the scene's text and what overrides it: program, threads, back end, settings, robots, and the start.
void add_run(Hash& hash, const LoadedWorld& loaded, const State& start, Backend backend);

/// By a name that the command line has checked.
Backend backend_of(const std::string& name);

using OnStep = std::function<void(const State&, const cosim::StepRow&)>;
/// Advances a state to the end of the scene; steps and recorded states go into the folder.
/// @param steps  at most so many; negative: no limit  @param on_step  after each completed step
cosim::RunLog simulate_into(RunFolder& folder, LoadedWorld& loaded, Stepper& stepper, State& state, int steps, const OnStep& on_step);

void write_report(const RunFolder& folder, const report::Json& json);
/// Gives the files of a run their names, report.json last. @return the report
report::Json commit_run(RunFolder& folder, const State& end, const LoadedWorld& loaded, const report::Provenance& provenance,
                        const cosim::RunSummary& summary);
}  // namespace tape::tapesim
