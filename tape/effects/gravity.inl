#pragma once
#include "tape/effects/gravity.hpp"

namespace tape {
TAPE_HD Real Gravity::energy(const StateView& s, int i) const { return -s.mass[elements[i].v] * g.dot(s.x[elements[i].v]); }
TAPE_HD Vec3 Gravity::gradient(const StateView& s, int i) const { return -s.mass[elements[i].v] * g; }
TAPE_HD Mat3 Gravity::hessian(const StateView&, int, HessianMode) const { return Mat3::Zero(); }
}  // namespace tape
