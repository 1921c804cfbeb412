#pragma once
#include <vector>

#include "tape/step/stepper.hpp"

namespace cosim {
using namespace tape;
/// Books the energy of a run: what there is, and what the drives put in (definitions: README.md of this folder).
class EnergyLedger {
 public:
  struct Entry {
    Real potential = 0;  ///< [J] of all conservative effects, from the first step on
    Real work = 0;       ///< [J] put in by grips, driven bodies, axles, cuts and adhesion that renews itself, since the first step
    Real balance = 0;    ///< [J] kinetic + potential - work, since the first step; positive: energy from nowhere
    Real scale = 0;      ///< [J] largest energy that has been about since the first step
  };
  explicit EnergyLedger(const World& world);
  /// Before a step from `state`.
  void before(const State& state, Real dt);
  /// After it; `state` and `report` are the step's outcome.
  Entry after(const State& state, const StepReport& report);
  /// Between two steps: what a cut takes out of the run, or puts in. @param work  [J]
  void add_work(Real work) { work_ += work; }

 private:
  Real body_work(const State& state) const;
  static Real link_work(const StepReport& report);
  const World* world_;
  std::vector<BodyDrive::Element> drives_;
  State start_;                    // of the step, grips closed
  Drive target_;                   // of the step
  Real grip_work_ = 0, work_ = 0;  // [J] of this step, of all
  Real first_energy_ = 0, scale_ = 0;
  bool started_ = false;
  std::vector<Real> first_energies_;  // [effects] J after the first step
};
}  // namespace cosim
