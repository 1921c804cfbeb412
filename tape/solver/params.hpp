#pragma once
#include <array>
#include <string_view>

#include "tape/core/settings.hpp"

namespace tape {
constexpr auto enum_names(HessianMode) { return std::array<std::string_view, 2>{"exact", "projected"}; }

/// `velocity`: the last Newton update, before any limit, moves no vertex faster than the tolerance [the paper].
/// `work`, the default: the decrease it still promises is below the kinetic energy of the tape at the tolerance (of all that moves, in a
/// scene without tape; as `velocity` where nothing has mass). What it costs and what it holds a roll to: tape/reduction/README.md.
/// Either way the energy must have fallen along the update as Newton's parabola says: what leaves contact moves little at first.
enum class StopRule { velocity, work };
constexpr auto enum_names(StopRule) { return std::array<std::string_view, 2>{"velocity", "work"}; }

struct NewtonParams {
  Real velocity_tol = 1e-2;
  StopRule stop = StopRule::work;
  HessianMode hessian = HessianMode::exact;
  int max_newton = 200;
  int max_line_search = 30;
  int retries = 4;
  template <class F>
  void fields(F&& f) {
    f("velocity_tol", velocity_tol, "m/s", Range::above(0, 1), "what Newton may leave of the velocity");
    f("stop", stop, "", Range::any(), "stop rule of Newton's method");
    f("hessian", hessian, "", Range::any(), "exact: unprojected, with fallback in each iteration where it is not positive definite");
    f("max_newton", max_newton, "1", Range::closed(1, 100000), "iterations after which a step counts as failed");
    f("max_line_search", max_line_search, "1", Range::closed(1, 100), "halvings after which a line search counts as failed");
    f("retries", retries, "1", Range::closed(0, 10), "times that a failed step is halved before the run stops");
  }
};
}  // namespace tape
