#include "cosim/run/run_log.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "cosim/run/conditions.hpp"
#include "cosim/run/summary.hpp"

using namespace cosim;

namespace {
constexpr Real kDt = 0.01;          // [s]
constexpr Real kStiffness = 100.0;  // [N/m]

/// A strip of two cells, of which one end is gripped and led along x at 0.1 m/s.
World strip_world() {
  Setup setup;
  setup.scene.name = "fake";
  setup.scene.time = {.dt = kDt, .duration = 0.1};
  setup.scene.films = {{.name = "film"}};
  setup.scene.strips.emplace_back().mesh = {.length = 0.038, .cells_across = 1};
  setup.scene.grips.push_back({.name = "hand",
                               .what = {.object = "tape", .vertices = {0}, .points = {}},
                               .to = {},
                               .stiffness = kStiffness,
                               .start = 0,
                               .motion = {{0, 1, Vec3(0.1, 0, 0)}}});
  return World::build(setup);
}

/// Does not solve anything: what it reports is what the test says.
class FakeStepper : public Stepper {
 public:
  explicit FakeStepper(std::function<void(State&, StepReport&)> act) : act_(std::move(act)) {}
  StepReport step(State& state, const Exchange&) override {
    StepReport report;
    report.dt = kDt;
    report.grip_force = {Vec3::Zero()};
    report.min_gap = 1e-4;
    const State before = state;
    act_(state, report);
    if (!report.ok) {
      state = before;
    } else {
      state.step += 1;
      state.time += kDt;
    }
    return report;
  }
  Real renew(const State&) override { return 0; }
  std::vector<Real> contact_force() const override { return {}; }

 private:
  std::function<void(State&, StepReport&)> act_;
};

RunLog run(World world, const std::function<void(State&, StepReport&)>& act, const RunOptions& options = {}) {
  FakeStepper stepper(act);
  State state = State::start(world);
  return simulate(world, stepper, state, options);
}
const Condition& condition(const std::vector<Condition>& all, const std::string& name) {
  for (const Condition& c : all)
    if (c.name == name) return c;
  throw std::runtime_error("no condition " + name);
}
}  // namespace

TEST(Simulate, MakesAsManyStepsAsTheDurationHolds) {
  const World world = strip_world();
  EXPECT_EQ(run(world, [](State&, StepReport&) {}).rows.size(), 10u);
  EXPECT_EQ(run(world, [](State&, StepReport&) {}, {.max_steps = 4}).rows.size(), 4u);
}
TEST(Simulate, RecordsTheStartTheStatesDueAndTheEnd) {
  const World world = strip_world();
  std::vector<int> steps;
  RunOptions options{.max_steps = 9, .record = {.rate = 25}};  // due at 0.04, 0.08 s
  options.on_record = [&](const State& state) { steps.push_back(state.step); };
  const RunLog log = run(
      world, [](State&, StepReport&) {}, options);
  EXPECT_EQ(steps, (std::vector<int>{0, 4, 8, 9}));
  EXPECT_EQ(log.checked_states, 4);
}
TEST(Simulate, StopsAtTheFirstStepThatFailsAndKeepsItsReason) {
  const World world = strip_world();
  const RunLog log = run(world, [](State& state, StepReport& report) {
    report.ok = state.step < 3;
    report.failure = report.ok ? "" : "made to fail";
  });
  EXPECT_EQ(log.rows.size(), 3u);
  EXPECT_EQ(log.failed_step, 4);
  const RunSummary summary = summarize(world, log, {});
  EXPECT_EQ(summary.status, "failed");
  EXPECT_EQ(summary.failure, "step 4: made to fail");
  EXPECT_FALSE(condition(summary.conditions, "failed_steps").met);
}
TEST(Simulate, StopsBetweenStepsWhenAsked) {
  const World world = strip_world();
  int asked = 0;
  const RunLog log = run(world, [](State&, StepReport&) {}, {.stop_asked = [&] { return ++asked > 2; }});
  EXPECT_TRUE(log.interrupted);
  EXPECT_EQ(log.rows.size(), 2u);
}
/// Step n takes 10 n s and n Newton iterations, a tenth of it in the search; looking for cuts adds what it really takes.
TEST(Phases, EachIsSummedUpOverItsOwnSteps) {
  const World world = strip_world();
  const auto costs = [](State& state, StepReport& report) {
    const Real ms = 1e4 * (state.step + 1);
    report.wall_ms = ms, report.newton = state.step + 1;
    report.stages = {{"broad_phase", ms / 10}};
    report.effects = {{.name = "membrane", .ms = ms / 2}};
  };
  const RunLog log = run(world, costs, {.phases = {{"lift", 0.02}, {"hold", 0.05}, {"never", 7}}});
  const RunSummary summary = summarize(world, log, {});
  ASSERT_EQ(summary.phases.size(), 3u) << "of the steps before the first, and the two that were reached";
  const PhaseSummary &before = summary.phases[0], &lift = summary.phases[1], &hold = summary.phases[2];
  EXPECT_EQ(before.name, "");
  EXPECT_EQ(before.steps, 2);
  EXPECT_EQ(lift.name, "lift");
  EXPECT_EQ(lift.steps, 3);
  EXPECT_NEAR(lift.start, 0.02, 1e-12);
  EXPECT_NEAR(lift.end, 0.05, 1e-12);
  EXPECT_NEAR(lift.step_ms.mean, 4e4, 500) << "steps 3, 4 and 5";
  EXPECT_NEAR(lift.step_ms.max, 5e4, 500);
  EXPECT_DOUBLE_EQ(lift.newton_mean, 4);
  EXPECT_NEAR(lift.stages.at(0).ms, 4e3, 1e-9);
  EXPECT_NEAR(lift.effects.at(0).ms, 2e4, 1e-9);
  EXPECT_EQ(hold.steps, 5);
  EXPECT_NEAR(hold.step_ms.p50, 8e4, 500);
  EXPECT_NEAR(before.wall + lift.wall + hold.wall, log.rows.back().wall, 1e-12);
  EXPECT_TRUE(summarize(world, run(world, costs), {}).phases.empty()) << "a script without phases";
}
TEST(EnergyLedger, AGripThatPullsOnSomethingFixedStoresAllItsWork) {
  // The spring's end stays where it is, so V = k/2 (0.1 t)^2, and the work of the grip is what V gains.
  const World world = strip_world();
  const RunLog log = run(world, [](State& state, StepReport& report) {
    const Real stretch = 0.1 * (state.time + kDt);
    report.effects = {{.name = "tether", .energy = kStiffness / 2 * stretch * stretch}};
  });
  const auto at = [](Real t) { return kStiffness / 2 * 0.01 * t * t; };
  EXPECT_NEAR(log.rows.back().energy.work, at(0.1) - at(kDt), 1e-15);
  for (const StepRow& row : log.rows) EXPECT_NEAR(row.energy.balance, 0, 1e-15) << "step " << row.step;
}
TEST(EnergyLedger, EnergyFromNowhereIsARiseAndDissipationIsNot) {
  const World world = strip_world();
  const auto with_energy = [&](const std::vector<Real>& kinetic) {
    return run(world, [&](State& state, StepReport& report) { report.kinetic = kinetic[static_cast<std::size_t>(state.step)]; },
               {.max_steps = static_cast<int>(kinetic.size())});
  };
  // The target moves away from a vertex that rests, but the grip's energy is not in these reports: take its work out.
  const auto rise_above_work = [&](const RunLog& log) { return energy_rise(log); };
  EXPECT_EQ(rise_above_work(with_energy({5, 4, 3, 2})), 0);
  EXPECT_NEAR(rise_above_work(with_energy({5, 3, 4, 2})), 1.0 / 5, 1e-3);  // scale 5 J; the work is below 1e-3 J
  EXPECT_FALSE(condition(check_conditions(world, with_energy({5, 3, 4, 2})), "energy_rise").met);
}
TEST(Conditions, EachLimitThatIsNotReachedShows) {
  const World world = strip_world();
  const std::vector<std::pair<std::string, std::function<void(StepReport&)>>> broken = {
      {"retried_steps", [](StepReport& r) { r.substeps = 2; }},
      {"linear_solves_at_their_limit", [](StepReport& r) { r.linear_failures = 1; }},
      {"ccd_queries_at_their_limit", [](StepReport& r) { r.ccd_capped = 1; }},
      {"unsettled_substeps", [](StepReport& r) { r.unsettled_substeps = 1; }},
      {"link_mismatch_m", [](StepReport& r) { r.link_mismatch = 1; }},
      {"stop_error_estimate_m", [](StepReport& r) { r.stop_error_estimate = 1; }},
      {"min_gap_m", [](StepReport& r) { r.min_gap = 0; }},
      {"max_strain", [](StepReport& r) { r.max_strain = 0.06; }},
  };
  for (const auto& [name, breaks] : broken) {
    const RunLog log = run(world, [&, breaks = breaks](State& state, StepReport& report) {
      if (state.step == 2) breaks(report);
    });
    const std::vector<Condition> conditions = check_conditions(world, log);
    EXPECT_FALSE(condition(conditions, name).met) << name;
    for (const Condition& c : conditions) {
      if (c.name != name && c.name != "energy_rise") {
        EXPECT_TRUE(c.met) << c.name << " while " << name << " is broken";
      }
    }
  }
}
TEST(Distribution, RanksAreTheNearest) {
  std::vector<Real> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  const Distribution d = distribution(values);
  EXPECT_EQ(d.mean, 50.5);
  EXPECT_EQ(d.p50, 50);
  EXPECT_EQ(d.p95, 95);
  EXPECT_EQ(d.max, 100);
  EXPECT_EQ(distribution({}).max, 0);
}
TEST(Figures, TheTipIsMeasuredFromTheRoot) {
  const World world = strip_world();
  const RunLog log = run(world, [](State& state, StepReport&) {
    for (std::size_t v = 2; v < state.x.size(); ++v) state.x[v] -= Vec3(0, 0, 0.001);  // all but the first row
  });
  const FigureValues values = measure_figures({"tip"}, world, log);
  ASSERT_EQ(values.size(), 2u);
  EXPECT_EQ(values[0].first, "tip_drop_m");
  EXPECT_NEAR(values[0].second, 0.01, 1e-15);  // ten steps
  EXPECT_NEAR(values[1].second, 0.038, 1e-15);
}
TEST(Figures, ANameThatThereIsNotIsRefusedWithThoseThereAre) {
  const World world = strip_world();
  EXPECT_NO_THROW(require_figures({"tip", "rest_speed"}, world));
  try {
    require_figures({"tipp"}, world);
    ADD_FAILURE();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("rest_speed"), std::string::npos) << e.what();
  }
  EXPECT_THROW(require_figures({"capstan_ratio"}, world), InputError);  // one grip only
}
TEST(MiddleLine, RunsFromRootToTipInEqualParts) {
  const World world = strip_world();
  const std::vector<Vec3> line = middle_line(world, State::start(world), 5);
  for (int i = 0; i < 5; ++i) EXPECT_LT((line[static_cast<std::size_t>(i)] - Vec3(0.038 * i / 4, 0, 0)).norm(), 1e-15) << i;
}
/// The strip's speed is 1, 2, ... m/s at the ends of the steps.
TEST(Goals, AreJudgedByTheWorstOfTheTimeInWhichTheyMustHold) {
  const World world = strip_world();
  const auto faster = [](State& state, StepReport&) { state.v.assign(state.v.size(), Vec3(state.step + 1, 0, 0)); };
  const auto goal = [](bool above, Real level, Real held) {
    return Goal{.name = "speed", .claim = {.quantity = Quantity::speed, .things = {"tape"}, .above = above, .level = level}, .held = held};
  };
  const struct {
    Goal goal;
    Real value;
    bool met;
    const char* required;
  } cases[] = {
      {goal(true, 9.5, 0), 10, true, "> 9.5"},
      {goal(true, 10, 0), 10, false, "> 10"},
      {goal(true, 6.5, 0.03), 7, true, "> 6.5 for the last 0.03 s"},  // 0.07, 0.08, 0.09 and 0.1 s
      {goal(true, 7, 0.03), 7, false, "> 7 for the last 0.03 s"},
      {goal(false, 10.5, 0.05), 10, true, "< 10.5 for the last 0.05 s"},
      {goal(false, 9.5, 0), 10, false, "< 9.5"},
  };
  for (const auto& c : cases) {
    const RunLog log = run(world, faster, {.goals = {c.goal}});
    const RunSummary summary = summarize(world, log, {});
    const Condition& judged = condition(summary.conditions, "speed");
    EXPECT_TRUE(judged.stated);
    EXPECT_EQ(judged.value, c.value) << c.required;
    EXPECT_EQ(judged.met, c.met) << c.required;
    EXPECT_EQ(judged.required, c.required);
    EXPECT_EQ(summary.fell_short, !c.met) << c.required;
    EXPECT_EQ(summary.status, "done");
  }
}
TEST(Goals, FailARunOnlyAtItsEndAndTheConditionsOfTrustDoNot) {
  const World world = strip_world();
  const Goal fast{.name = "fast", .claim = {.quantity = Quantity::speed, .things = {"tape"}, .above = true, .level = 1}};
  const auto rest = [](State&, StepReport& report) { report.substeps = 2; };
  const RunSummary early = summarize(world, run(world, rest, {.max_steps = 4, .goals = {fast}}), {});
  EXPECT_FALSE(condition(early.conditions, "fast").met);
  EXPECT_FALSE(early.fell_short) << "it may come yet";
  EXPECT_TRUE(summarize(world, run(world, rest, {.goals = {fast}}), {}).fell_short);
  const RunSummary without = summarize(world, run(world, rest), {});
  EXPECT_FALSE(condition(without.conditions, "retried_steps").met);
  EXPECT_FALSE(without.fell_short);
  EXPECT_FALSE(condition(summarize(world, run(world, rest, {.max_steps = 0, .goals = {fast}}), {}).conditions, "fast").met)
      << "nothing was seen";
}
