#include "apps/report/phase_table.hpp"

#include <algorithm>
#include <initializer_list>

namespace tape::report {
namespace {
Real sum(const std::vector<StageReport>& stages, std::initializer_list<const char*> names) {
  Real ms = 0;
  for (const StageReport& stage : stages)
    if (std::ranges::find(names, stage.name) != names.end()) ms += stage.ms;
  return ms;
}
}  // namespace

Table phase_table(const std::vector<cosim::PhaseSummary>& phases) {
  Table table{{"phase", "from s", "to s", "steps", "wall s", "x real time", "ms/step", "tape ms", "contact ms", "bullet ms", "cutting ms"},
              {}};
  for (const cosim::PhaseSummary& p : phases) {
    const Real contact = sum(p.stages, {"broad_phase", "ccd"}), bullet = sum(p.stages, {"bullet", "exchange"}),
               cutting = sum(p.stages, {"cutting"}), tape = p.step_ms.mean - contact - bullet - cutting;
    table.rows.push_back({p.name.empty() ? "-" : p.name, rounded(p.start), rounded(p.end), std::to_string(p.steps), rounded(p.wall),
                          rounded(p.wall > 0 ? (p.end - p.start) / p.wall : 0), rounded(p.step_ms.mean), rounded(tape), rounded(contact),
                          rounded(bullet), rounded(cutting)});
  }
  return table;
}
}  // namespace tape::report
