#pragma once
#include "tape/effects/inertia.hpp"

namespace tape {
TAPE_HD Vec3 Inertia::offset(const StateView& s, int i) const { return s.x[elements[i].v] - s.x_tilde[elements[i].v]; }
TAPE_HD Real Inertia::stiffness(const StateView& s, int i) const { return s.mass[elements[i].v] / (s.dt * s.dt); }
TAPE_HD Real Inertia::energy(const StateView& s, int i) const { return 0.5 * stiffness(s, i) * offset(s, i).squaredNorm(); }
TAPE_HD Vec3 Inertia::gradient(const StateView& s, int i) const { return stiffness(s, i) * offset(s, i); }
TAPE_HD Mat3 Inertia::hessian(const StateView& s, int i, HessianMode) const { return stiffness(s, i) * Mat3::Identity(); }
}  // namespace tape
