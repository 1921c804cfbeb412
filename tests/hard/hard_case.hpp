#pragma once
#include <functional>
#include <string>
#include <vector>

#include "tests/support/simulation.hpp"

namespace tape::test {
/// A scene that breaks solvers, stated in one place. Every case must keep the list at the head of checks.md, part 9: no intersection
/// after any step, gaps above zero, no NaN, no limit reached, energy that never rises above where it was without a drive (less the booked
/// work of adhesion that renews itself), and the same bits when run again.
struct HardCase {
  std::string name;  ///< a word or two; the group first: HC1_...
  std::string what;  ///< what is hard about it
  Real duration;     ///< [s]
  bool driven;       ///< something does work on it, so that its energy may grow
  std::function<Setup()> setup;
  /// What else must hold at the end; adds what does not to `broken`.
  std::function<void(const Simulation&, std::vector<std::string>& broken)> also = {};
  /// By how much of its scale the energy may rise above its smallest value without a drive.
  Real energy_rise = 1e-6;
  /// Steps may be taken in parts, and CCD may run out of iterations; the table says how often.
  bool may_reach_limits = false;
};

/// All cases.
std::vector<HardCase> hard_cases();

std::vector<HardCase> obstacle_cases();  ///< HC1: spikes, edges, cracks and holes
std::vector<HardCase> stack_cases();     ///< HC6, HC10, HC12, HC20: stacks, pulls, time steps, mass ratios
std::vector<HardCase> adhesion_cases();  ///< extreme settings; what is pressed, sheared, twisted, torn and wound
std::vector<HardCase> reduced_cases();   ///< rolls as clusters: fronts that pass, stall, turn back; falls and spins
std::vector<HardCase> cutting_cases();   ///< blades on taut, buckled, wound and stuck tape
std::vector<HardCase> own_cases();       ///< of the same kind: impact, crumpling, wrapping, rolling

/// A setup that is made once, however often it is run.
std::function<Setup()> once(const std::function<Setup()>& make);
/// Strip of `length` and `cells` over the width, flat at height z, its middle at the origin; turned about the vertical.
Setup dropped_strip(Real length, int cells, Real z, Real turn = 0);
}  // namespace tape::test
