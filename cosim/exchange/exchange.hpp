#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "cosim/exchange/pinching.hpp"
#include "tape/step/stepper.hpp"

namespace cosim {
/// Of one step.
struct ExchangeReport {
  int iterations = 1;                   ///< tape solves
  double bullet_ms = 0;                 ///< in Bullet, both passes
  double tape_ms = 0;                   ///< in the tape solver
  double momentum_given = 0;            ///< [N s] sum over links of the magnitude of what the tape side gave them
  std::optional<double> residual = {};  ///< [1] what of it robots with a free base did not receive; none: none was touched
  int pinching = 0;                     ///< pairs of links that touch in the tape solver
  double mismatch = 0;                  ///< [m] farthest that a point of a link stands on the tape side from where Bullet has it
};

/// What there is to record of a robot at the end of a step.
struct RobotRecord {
  robot::VecX position, velocity, command, effort;  ///< [nj] rad or m, by s, of the drives' targets, N m or N
  std::vector<robot::Pose> links;                   ///< [nl] X_WL
  std::vector<Eigen::Matrix<double, 6, 1>> wrench =
      {};  ///< [nl] N, N m: of the tape side on the link, about its origin, mean over the step; NaN of a fixed base, which has no unknowns
};

/// Of all robots: [robots][nj] rad or m.
using JointPositions = std::vector<robot::VecX>;

/// Unknowns of a robot in the exchange: independent joint motions, six more for a free base, and one that goes from 0 to 1 over a step
/// and closes what the first leave open between the two worlds.
int coordinates(const robot::World& world, int robot);

tape::Pose to_tape(const robot::Pose& pose);

/// A stepper of the tape side whose articulations Bullet simulates; README.md has the steps. What Bullet's world needs to go on is in
/// State::outside.
class CoupledStepper final : public tape::Stepper {
 public:
  CoupledStepper(const RobotScene& robots, const tape::World& world, std::unique_ptr<tape::Stepper> tape);
  tape::StepReport step(tape::State& state, const tape::Exchange& more = {}) override;
  double renew(const tape::State& state) override { return tape_->renew(state); }
  std::vector<double> contact_force() const override { return tape_->contact_force(); }
  const robot::World& bullet() const { return bullet_; }
  const RobotScene& robots() const { return robots_; }
  const ExchangeReport& exchange() const { return report_; }
  std::vector<RobotRecord> records(const tape::State& state);  ///< [robots] at that state; what was exerted: in the step that led to it
  JointPositions joints() const;

 private:
  /// A robot on the tape side.
  struct Part {
    int robot;
    std::vector<int> links, bodies;
    std::vector<int> independent;  // joints that follow no other
  };
  tape::ArticulationStep predicted(const Part& part, const tape::State& state, const robot::RobotState& before, double dt,
                                   const robot::VecX& load) const;
  std::vector<bool> add_holds(const Part& part, const Eigen::MatrixXd& bare, tape::ArticulationStep& step) const;
  void add_contacts(const Part& part, double dt, const Eigen::MatrixXd& bare, tape::ArticulationStep& step) const;
  Eigen::MatrixXd independent_response(int robot, double dt, bool drives) const;
  Eigen::MatrixXd point_motion(int robot, int link, const robot::Vec3& point) const;
  void add_drives(const Part& part, const Eigen::MatrixXd& bare, const std::vector<bool>& held, tape::ArticulationStep& step) const;
  bool rests_on_tape_side(const RobotPart& robot) const;
  std::vector<robot::VecX> forces(const tape::StepReport& report) const;
  std::vector<robot::RobotState> robot_states() const;
  std::vector<robot::Vec3> momenta() const;
  void restore(const tape::State& state);
  void stand_at(const tape::State& state);
  void follow_script(const tape::State& state);
  void see_to_pinching(const tape::State& state);
  void advance_bullet(const robot::Snapshot& start, double dt, const std::vector<robot::VecX>& tau);
  void pose_bullet(double dt);
  tape::StepReport step_both(tape::State& state);
  tape::StepReport step_once(tape::State& state, double dt, const robot::Snapshot& start);
  tape::StepReport step_in_turns(tape::State& state, double dt, const robot::Snapshot& start);
  void book_momentum(const tape::StepReport& report, const std::vector<robot::Vec3>& loaded, double dt);
  void note_mismatch(const tape::State& state);

  RobotScene robots_;
  const tape::World& world_;
  std::unique_ptr<tape::Stepper> tape_;
  robot::World bullet_;
  robot::Snapshot start_;
  Pinching pinching_;
  std::vector<tape::Index2> pinched_;  // pairs of bodies, in this step
  std::vector<Part> parts_;
  std::optional<std::vector<double>> standing_;    // State::outside of the state at which Bullet's world stands
  double time_ = 0;                                // [s] of the end of the step
  std::vector<double> events_;                     // that scripts_ know of
  std::vector<robot::VecX> load_;                  // [robots][dof] that the tape side exerted in the last step, zero at the start
  std::vector<tape::ArticulationReport> exerted_;  // in the last step
  std::vector<RobotScript> scripts_;               // [robots]
  ExchangeReport report_;
};

/// The stepper of a scene: coupled if it has robots.  @throws InputError if the back end is not there
std::unique_ptr<tape::Stepper> make_stepper(tape::Backend backend, const tape::World& world, const RobotScene& robots);
}  // namespace cosim
