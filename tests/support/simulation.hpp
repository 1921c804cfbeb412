#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tape/step/cut.hpp"
#include "tape/step/stepper.hpp"

namespace tape::test {
/// A scene in memory that steps and keeps an eye on what every step must keep (checks.md, part 9): finite, no intersection,
/// gaps above zero, no limit reached.
class Simulation {
 public:
  explicit Simulation(Setup setup, Backend backend = Backend::cpu);
  /// One step; what it broke is added to `broken`.
  const StepReport& step();
  /// What follows a step: blades that press cut. @param pressures  [blades]
  void cut(const std::vector<BladePressure>& pressures);
  /// Goes on from a snapshot of this scene.
  void resume(const std::string& file);
  /// Steps until `time` [s]; stops at the first failed step.
  void run_to(Real time, const std::function<void(const Simulation&)>& each = {});
  const World& world() const { return *world_; }
  const State& state() const { return state_; }
  State& state() { return state_; }
  const StepReport& report() const { return report_; }
  const std::vector<CutReport>& cuts() const { return cuts_; }  ///< made or refused after the last step
  std::vector<Real> contact_force() const { return stepper_->contact_force(); }
  std::vector<Vec3> x() const { return vertex_positions(*world_, state_); }
  /// Mechanical energy [J]: kinetic and all potentials.
  Real energy() const;
  /// What a change of energy is measured against [J]: the magnitudes of its parts, and lifting all that moves by its own size.
  Real energy_scale() const;

  Exchange exchange;  ///< of the next step
  bool check_intersections = true;
  bool may_reach_limits = false;    ///< steps in parts and capped CCD are counted only
  std::vector<std::string> broken;  ///< in words, with the step; empty: all is well
  Real min_gap = 1e300;             ///< [m] over all steps
  int newton_max = 0, newton_sum = 0;
  int retried = 0, ccd_capped = 0;  ///< steps taken in parts; pairs whose CCD ran out of iterations

 private:
  std::unique_ptr<World> world_;
  State state_;
  std::unique_ptr<Stepper> stepper_;
  StepReport report_;
  std::vector<CutReport> cuts_;
};

/// The 19-mm vinyl tape of the paper's Table I.
Film vinyl();
/// A packaging film of 48 mm (data/tapes).
Film packaging_film();
/// A strip of that film, flat, from `start` along x, `cells` over its width.
Strip flat_strip(Real length, int cells, const Vec3& start);
/// A scene with one such strip; dt 0.01 s, tolerance 1e-3 m/s.
Setup strip_setup(const Strip& strip);
Body& add_body(Setup& setup, const std::string& name, TriangleMesh mesh, Motion motion, const Vec3& position);
/// A grip that holds these vertices of the strip where they are.
Grip hold(const std::string& name, std::vector<int> vertices);
}  // namespace tape::test
