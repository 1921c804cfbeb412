#pragma once
#include <cmath>

#include "tape/effects/membrane.hpp"
#include "tape/math/psd.hpp"

namespace tape {
TAPE_HD Mat32 Membrane::deformation_gradient(const StateView& s, int i) const {
  const Element& e = elements[i];
  const Vec3 a = s.x[e.v[1]] - s.x[e.v[0]], b = s.x[e.v[2]] - s.x[e.v[0]];
  Mat32 F;
  F.col(0) = e.b[1][0] * a + e.b[2][0] * b;
  F.col(1) = e.b[1][1] * a + e.b[2][1] * b;
  return F;
}
TAPE_HD Mat2 Membrane::green_strain(const Mat32& F) { return 0.5 * (F.transpose() * F - Mat2::Identity()); }
TAPE_HD Mat2 Membrane::stress(const Mat2& G, int i) const {
  return 2 * elements[i].mu * G + elements[i].lambda * G.trace() * Mat2::Identity();
}
TAPE_HD Real Membrane::strain(const StateView& s, int i) const {
  const Mat32 F = deformation_gradient(s, i);
  const Mat2 C = F.transpose() * F;
  const Real mean = C.trace() / 2, radius = std::hypot((C(0, 0) - C(1, 1)) / 2, C(0, 1));
  return std::fmax(std::fabs(std::sqrt(mean + radius) - 1), std::fabs(std::sqrt(std::fmax(mean - radius, 0.0)) - 1));
}
TAPE_HD Real Membrane::energy(const StateView& s, int i) const {
  const Mat2 G = green_strain(deformation_gradient(s, i));
  return elements[i].mu * G.squaredNorm() + elements[i].lambda / 2 * G.trace() * G.trace();
}
TAPE_HD VecN<9> Membrane::gradient(const StateView& s, int i) const {
  const Mat32 F = deformation_gradient(s, i), P = F * stress(green_strain(F), i);
  VecN<9> g;
  for (int k = 0; k < 3; ++k) g.segment<3>(3 * k) = elements[i].b[k][0] * P.col(0) + elements[i].b[k][1] * P.col(1);
  return g;
}
TAPE_HD MatN<9, 9> Membrane::hessian(const StateView& s, int i, HessianMode mode) const {
  const Element& e = elements[i];
  const Mat32 F = deformation_gradient(s, i);
  const Mat2 full = stress(green_strain(F), i), S = mode == HessianMode::projected ? psd_part(full) : full;
  const Mat3 FFt = F * F.transpose();
  Vec3 u[3];
  for (int k = 0; k < 3; ++k) u[k] = e.b[k][0] * F.col(0) + e.b[k][1] * F.col(1);
  MatN<9, 9> h;
  for (int k = 0; k < 3; ++k) {
    for (int l = k; l < 3; ++l) {
      const Real bb = e.b[k][0] * e.b[l][0] + e.b[k][1] * e.b[l][1];
      const Real geometric =
          e.b[k][0] * (S(0, 0) * e.b[l][0] + S(0, 1) * e.b[l][1]) + e.b[k][1] * (S(1, 0) * e.b[l][0] + S(1, 1) * e.b[l][1]);
      const Mat3 block = e.mu * (bb * FFt + u[l] * u[k].transpose()) + e.lambda * u[k] * u[l].transpose() + geometric * Mat3::Identity();
      h.block<3, 3>(3 * k, 3 * l) = block;
      if (l > k) h.block<3, 3>(3 * l, 3 * k) = block.transpose();
    }
  }
  return h;
}
}  // namespace tape
