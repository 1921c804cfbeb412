#include "cosim/run/figures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <numbers>

#include "cosim/run/conditions.hpp"
#include "cosim/run/read_run.hpp"
#include "tape/math/rotation.hpp"

using namespace cosim;

namespace {
constexpr Real kDt = 0.01;  // [s]

/// A run of a scene whose reports are what `fill` makes of them, from step 1 on.
struct Recorded {
  World world;
  RunLog log;
  Recorded(const std::string& scene, int steps, const std::function<void(int, StepReport&)>& fill)
      : world(World::build(read_run(SceneFile::parse(scene, TAPE_SOURCE_DIR "/data/scenes/figures_test.yaml")).setup)) {
    log.start = log.end = State::start(world);
    for (int k = 1; k <= steps; ++k) {
      StepRow row{.step = k, .time = k * kDt, .report = {}, .energy = {}};
      row.report.dt = kDt;
      fill(k, row.report);
      log.rows.push_back(row);
    }
    log.end.time = steps * kDt;
  }
  std::map<std::string, Real> figures(const std::string& name) const {
    const FigureValues values = measure_figures({name}, world, log);
    return {values.begin(), values.end()};
  }
};

constexpr const char* kPeel = R"(film: vinyl_19mm
strip: {length: 0.1, cells_across: 2, position: [0, 0, 0.001]}
bodies: {table: {shape: box, size: [0.3, 0.1, 0.02], position: [0, 0, -0.01]}}
interfaces: [{between: [tape.sticky, table], law: per_pair, cn: 1, ct: 1, beta0: 1}]
script: [{grip: tape.tip, as: hand}, {move: hand, by: [-0.006, 0, 0], speed: 0.006}]
)";
constexpr const char* kRoll = R"(film: vinyl_19mm
roll: {turns: 1, free_length: 0.05}
interfaces:
  - {between: [tape.sticky, tape], law: per_pair, cn: 1, ct: 1, beta0: 1}
  - {between: [tape.sticky, hub], law: per_pair, cn: 1, ct: 1, beta0: 1}
script: [{grip: {body: hub, point: [0, 0, 0]}, as: carrier}, {release: carrier, at: 0.05}]
)";
}  // namespace

TEST(Figures, ThePeelForceIsThatAlongThePullWhileTheFrontAdvances) {
  // The front stands at 0.1 m for three steps, then moves by 10 mm a step; force 2 N back, 5 N up, and 7 N more in the first steps.
  const Recorded run(kPeel, 6, [](int k, StepReport& report) {
    report.grip_force = {Vec3(k <= 3 ? -9 : -1 - k / 4.0, 0, 5)};
    report.adhesion = {{.normal = 1, .tangential = 0, .live = 10, .from = 0, .to = k <= 3 ? 0.1 : 0.1 - 0.01 * (k - 3)}};
  });
  const auto figures = run.figures("peel_force");
  EXPECT_NEAR(figures.at("peel_force_mean_N"), (2 + 2.25 + 2.5) / 3, 1e-12);
  EXPECT_NEAR(figures.at("peel_force_median_N"), 2.25, 1e-12);
  EXPECT_NEAR(figures.at("peel_force_max_N"), 2.5, 1e-12);
  EXPECT_NEAR(run.figures("boundary_advance").at("boundary_advance_m"), 0.03, 1e-12);
}
TEST(Figures, TheBoundaryOfARollIsThatOfTapeAndHubTogether) {
  // When the last layer on the tape is gone, what is left adheres to the hub up to 20 mm; at the end nothing does.
  for (const auto& [steps, advance] : {std::pair{1, 0.0}, {2, 0.1 - 0.02}, {3, 0.1}}) {
    const Recorded run(kRoll, steps, [](int k, StepReport& report) {
      AdhesionReport none;
      report.adhesion = {none, none};
      if (k == 1) report.adhesion[0].to = 0.1;
      if (k <= 2) report.adhesion[1].to = 0.02;
      report.body_pose = {Pose{}};
    });
    EXPECT_NEAR(run.figures("boundary_advance").at("boundary_advance_m"), advance, 1e-12) << steps;
  }
}
TEST(Figures, TheHubsRangeCountsFromItsReleaseAndBeyondATurn) {
  const Recorded run(kRoll, 100, [](int k, StepReport& report) {  // 10 rad/s one way, from 0.5 s on back
    const Real time = k * kDt, angle = time < 0.5 ? 10 * time : 10 - 10 * time;
    report.body_pose = {Pose{rotation_exp(Vec3(std::numbers::pi / 2, 0, 0)) * rotation_exp(Vec3(0, 0, angle)), Vec3::Zero()}};
    report.adhesion = {{}, {}};
  });
  // Its axis is z in its own frame. Released at 0.05 s at 0.5 rad, it turns to 5 rad and back to zero.
  EXPECT_NEAR(run.figures("hub_range").at("hub_range_deg"), 5 * 180 / std::numbers::pi, 1e-9);
}
TEST(Conditions, APeelByAreaThatTheMeshCannotResolveShows) {
  const std::string scene = R"(film: vinyl_19mm
strip: {length: 0.02, cells_across: 6, cell_length: CELL, position: [0, 0, 0.001]}
bodies: {table: {shape: box, size: [0.3, 0.1, 0.02], position: [0, 0, -0.01]}}
interfaces: [{between: [tape.sticky, table], law: per_area, strength: 5000, toughness: 1, rest: 0.8, reach: 0.8}]
)";
  for (const auto& [cell, met] : {std::pair{"0.0005", true}, {"0.003", false}}) {
    std::string text = scene;
    text.replace(text.find("CELL"), 4, cell);
    const Recorded run(text, 1, [](int, StepReport&) {});
    const std::vector<Condition> conditions = check_conditions(run.world, run.log);
    const auto c = std::ranges::find(conditions, "cell_per_fold_radius", &Condition::name);
    ASSERT_NE(c, conditions.end());
    EXPECT_EQ(c->met, met) << cell;
  }
}
