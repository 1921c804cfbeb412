#include "apps/tapesim/run_folder.hpp"

#include <cstdlib>
#include <fstream>

#include "apps/report/json.hpp"
#include "apps/report/steps_csv.hpp"
#include "apps/report/table.hpp"

namespace tape::tapesim {
namespace fs = std::filesystem;
namespace {
std::string csv_line(const std::vector<std::string>& cells) { return report::to_csv({cells, {}}); }

std::string settings_text(const World& world, const cosim::RobotScene& robots) {
  return report::Json({{"version", TAPE_VERSION}, {"settings", report::settings_json(world.setup, robots)}}).dump(1);
}

fs::path made(fs::path folder) {
  cosim::make_folder(folder);
  return folder;
}
}  // namespace

RunFolder::RunFolder(fs::path folder, const World& world, const cosim::RobotScene& robots, const std::vector<cosim::Phase>& phases,
                     const State& start, const std::string& pictures)
    : folder_(made(std::move(folder))),
      world_(&world),
      robots_(robots),
      phases_(phases),
      pictures_(pictures),
      steps_(folder_ / "steps.csv") {
  const std::string header = csv_line(report::step_columns(world, phases_));
  steps_.write(header);
  if (start.step > 0) keep_earlier_steps(header, start.step);
  if (start.step == 0 || !keep_earlier_states(start.step)) states_.emplace(folder_ / "state.h5", mesh());
}

cosim::RecordedMesh RunFolder::mesh() const {
  return cosim::RecordedMesh::of(*world_, robots_, phases_, pictures_, settings_text(*world_, robots_));
}

void RunFolder::keep_earlier_steps(const std::string& header, int step) {
  std::ifstream earlier(folder_ / "steps.csv");
  std::string line;
  if (!std::getline(earlier, line) || line + '\n' != header) return;
  while (std::getline(earlier, line))
    if (std::atoi(line.c_str()) <= step) steps_.write(line + '\n');
}

/// @return whether states.h5 goes on from an earlier one
bool RunFolder::keep_earlier_states(int step) {
  if (!fs::exists(folder_ / "state.h5")) return false;
  const cosim::StateReader earlier(folder_ / "state.h5");
  const cosim::RecordedMesh now = mesh();
  const auto same = [&](const cosim::RecordedMesh& m) { return m.triangles == now.triangles && m.rest == now.rest; };
  int last = 0;  // mesh of the state that the run goes on from
  while (last < earlier.meshes() && !same(earlier.mesh(last))) ++last;
  if (last == earlier.meshes() || earlier.mesh().robots != now.robots || earlier.mesh().grips != now.grips ||
      earlier.mesh().phases != now.phases)
    return false;
  states_.emplace(folder_ / "state.h5", last == 0 ? now : earlier.mesh());
  int written = 0;  // meshes that are started
  const auto go_to = [&](int mesh) {
    while (written < mesh) ++written, states_->start_mesh(earlier.mesh(written));
  };
  for (int i = 0; i < earlier.frames(); ++i) {
    const cosim::RecordedFrame frame = earlier.frame(i);
    if (frame.step > step || frame.mesh > last) break;
    go_to(frame.mesh);
    states_->add(frame);
    last_recorded_ = frame.step;
  }
  go_to(last);
  return true;
}

void RunFolder::show(movie::LiveMovie& movie) {
  movie_ = &movie;
  movie_->start_mesh(mesh());
}

void RunFolder::start_mesh() {
  states_->start_mesh(mesh());
  ++mesh_;
  if (movie_) movie_->start_mesh(mesh());
}

void RunFolder::add_step(const cosim::StepRow& row) {
  steps_.write(csv_line(report::step_cells(*world_, phases_, row)));
  grip_force_ = row.report.grip_force;
}

void RunFolder::add_state(const State& state, std::vector<Real> contact_force, std::vector<cosim::RobotRecord> robots) {
  if (state.step <= last_recorded_) return;
  cosim::RecordedFrame frame = cosim::RecordedFrame::of(
      *world_, state, {std::move(contact_force), grip_force_, std::move(robots), phase_of(phases_, state, *world_)});
  frame.mesh = mesh_;
  states_->add(frame);
  if (movie_) movie_->add(std::move(frame));
  last_recorded_ = state.step;
}

void RunFolder::commit(const State& state) {
  save_snapshot((folder_ / "snapshot.h5").string(), *world_, state);
  states_->commit();
  steps_.commit();
}
}  // namespace tape::tapesim
