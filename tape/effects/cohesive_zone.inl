#pragma once
#include <limits>

#include "tape/effects/cohesive_zone.hpp"
#include "tape/effects/triangle_plane.hpp"

namespace tape {
struct CohesiveZone::Corners {
  Vec3 x[6];
};
/// The way from the point that a sample sticks to, in parts.
struct CohesiveZone::Opening {
  Vec2 beside;   ///< [1] G^-1 c
  Vec2 slipped;  ///< [1] G^-1 (c - c*)
  Real height;   ///< [m] h
  Real open;     ///< [m] h - d*
  Real slip2;    ///< [m^2] |u|^2
  Real square;   ///< [m^2] delta^2
  TAPE_HD Opening(const Element& e, const TrianglePlane<6>& at) {
    const Vec2 c = at.along();
    beside = e.inverse_metric * c;
    slipped = e.inverse_metric * (c - e.met);
    height = std::sqrt(std::fmax(at.r.squaredNorm() - c.dot(beside), 0));
    open = height - e.rest;
    slip2 = std::fmax((c - e.met).dot(slipped), 0);
    const Real opened = std::fmax(open, 0);
    square = opened * opened + e.shear * slip2;
  }
  TAPE_HD Real delta() const { return std::sqrt(square); }
};

TAPE_HD CohesiveZone::Element CohesiveZone::recall(const Memory& m, const SamplePair& pair, const StateView& s) const {
  const AreaCohesion& law = s.adhesion[pair.interface].area;
  Element e{.pair = pair,
            .zone = Zone::at(law, m.worst),
            .area = pair.area * m.share,
            .shear = law.shear,
            .foot = {m.foot[0], m.foot[1], m.foot[2]},
            .inverse_metric = {},
            .met = {m.met[0], m.met[1]},
            .rest = pair.xi + law.rest * dhat};
  e.inverse_metric = plane(e, s.x).metric().inverse();
  return e;
}
TAPE_HD Real CohesiveZone::energy(const StateView& s, int i) const {
  const Element& e = elements[i];
  return e.area * e.zone.work(Opening(e, plane(e, s.x)).delta());
}
TAPE_HD VecN<18> CohesiveZone::gradient(const StateView& s, int i) const {
  const Element& e = elements[i];
  const auto at = plane(e, s.x);
  const Opening o(e, at);
  return e.area * e.zone.slope(o.delta()) * square_gradient(e, at, o);
}
TAPE_HD MatN<18, 18> CohesiveZone::hessian(const StateView& s, int i, HessianMode mode) const {
  const Element& e = elements[i];
  const auto at = plane(e, s.x);
  const Opening o(e, at);
  const Real slope = e.area * e.zone.slope(o.delta()), curvature = e.area * e.zone.curvature(o.delta());
  const bool exact = mode == HessianMode::exact, open = o.open > 0;
  MatN<18, 3> B;  // d along/dx, dh/dx: h = B S B^T and what the second derivatives of along and of |r|^2 add
  B << at.slope(), open ? height_gradient(at, o) : VecN<18>(VecN<18>::Zero());
  const Real pull = exact && open ? 2 * slope * o.open / o.height : 0;  // by h^2 = |r|^2 - c^T G^-1 c
  Mat3 S = Mat3::Zero();
  S.topLeftCorner<2, 2>() = (2 * slope * e.shear - pull) * e.inverse_metric;
  if (open) S(2, 2) = 2 * slope - pull;
  if (exact) {
    const Vec3 square(2 * e.shear * o.slipped.x(), 2 * e.shear * o.slipped.y(), open ? 2 * o.open : 0);
    S += curvature * square * square.transpose();
  }
  const MatN<18, 3> BS = B * S;
  MatN<18, 18> h = BS.lazyProduct(B.transpose());
  if (!exact) return h;
  for (int k = 0; k < 6 && open; ++k)
    for (int l = 0; l < 6; ++l) h.block<3, 3>(3 * k, 3 * l).diagonal().array() += pull * at.w[k] * at.w[l];
  at.add_curvature(2 * slope * e.shear * o.slipped - pull * o.beside, h);
  return h;
}
template <class F>
TAPE_HD bool CohesiveZone::squares(const StateView& s, int i, const F& add) const {
  const Element& e = elements[i];
  const auto at = plane(e, s.x);
  const Opening o(e, at);
  const Real stiffness = 2 * e.area * e.zone.slope(o.delta());
  const MatN<18, 2> J = at.slope();
  const Mat2& m = e.inverse_metric;  // J m J^T by columns: m = a a^T / m_00 + (det m / m_00) b b^T, a its first column, b = (0, 1)
  add(stiffness * e.shear / m(0, 0), VecN<18>(J * m.col(0)));
  add(stiffness * e.shear * m.determinant() / m(0, 0), VecN<18>(J.col(1)));
  if (o.open > 0) add(stiffness, height_gradient(at, o));
  return true;
}
TAPE_HD bool CohesiveZone::begin(const SamplePair& pair, const StateView& s, Memory& out) const {
  const Adhesion& a = s.adhesion[pair.interface];
  if (a.law != of_law) return false;
  const Vec3 x[4] = {pair.point(s.x), s.x[pair.v[3]], s.x[pair.v[4]], s.x[pair.v[5]]};
  const Closest closest = closest_vertex_triangle(x);
  const Vec3 offset = combine(closest.weight, x);
  const Vec3 own = (s.x[pair.v[1]] - s.x[pair.v[0]]).cross(s.x[pair.v[2]] - s.x[pair.v[0]]);
  const Face of_sample = own.dot(offset) > 0 ? Face::sticky : Face::backing;
  const Face of_triangle = (x[2] - x[1]).cross(x[3] - x[1]).dot(offset) < 0 ? Face::sticky : Face::backing;
  if (!a.sticks[static_cast<int>(of_sample)][static_cast<int>(of_triangle)]) return false;
  if (!(offset.norm() <= pair.xi + a.area.reach * dhat)) return false;
  const bool on_strip = pair.id.triangle < triangles;
  if (on_strip && of_sample == Face::backing && of_triangle == Face::sticky) return false;  // the other side's samples do it
  const Real share = on_strip && of_sample == of_triangle ? 0.5 : 1;
  out = {pair.name(), {-closest.weight[1], -closest.weight[2], -closest.weight[3]}, {0, 0}, 0, share};
  const Vec2 met = TrianglePlane<6>(corners(pair, s.x).x, pair.w, out.foot).along();
  out.met[0] = met[0], out.met[1] = met[1];
  return true;
}
TAPE_HD bool CohesiveZone::renew(const StateView& s, int i, Memory& m) const {
  const Element& e = elements[i];
  m.worst = std::fmax(m.worst, Opening(e, plane(e, s.x)).delta());
  return m.worst < e.zone.final;
}
TAPE_HD Real CohesiveZone::accuracy_to_judge(const StateView& s, int i) const {
  const Element& e = elements[i];
  const bool near = Opening(e, plane(e, s.x)).delta() > e.zone.knee / 2;
  return near ? 0.02 * e.zone.final : std::numeric_limits<Real>::infinity();
}
TAPE_HD Real CohesiveZone::slack(const StateView& s, int i) const {
  const Element& e = elements[i];
  return std::fmax(e.zone.knee - Opening(e, plane(e, s.x)).delta(), 0) / std::fmax(1, std::sqrt(e.shear));
}
TAPE_HD AdhesiveForce CohesiveZone::force(const StateView& s, int i) const {
  const Element& e = elements[i];
  const auto at = plane(e, s.x);
  const Opening o(e, at);
  const Real pull = 2 * e.area * e.zone.slope(o.delta());
  return {.interface = e.pair.interface,
          .vertex = {e.pair.v[0], e.pair.v[1], e.pair.v[2]},
          .weight = {e.pair.w[0], e.pair.w[1], e.pair.w[2]},
          .live = true,
          .normal = pull * std::fmax(o.open, 0),
          .tangential = pull * e.shear * std::sqrt(o.slip2)};
}
TAPE_HD CohesiveZone::Corners CohesiveZone::corners(const SamplePair& p, Span<const Vec3> x) {
  Corners out;
  for (int k = 0; k < 6; ++k) out.x[k] = x[p.v[k]];
  return out;
}
TAPE_HD TrianglePlane<6> CohesiveZone::plane(const Element& e, Span<const Vec3> x) {
  return TrianglePlane<6>(corners(e.pair, x).x, e.pair.w, e.foot);
}
TAPE_HD VecN<18> CohesiveZone::height_gradient(const TrianglePlane<6>& at, const Opening& o) {
  VecN<18> g = -at.slope() * o.beside;
  for (int k = 0; k < 6; ++k) g.segment<3>(3 * k) += at.w[k] * at.r;
  return g / o.height;
}
TAPE_HD VecN<18> CohesiveZone::square_gradient(const Element& e, const TrianglePlane<6>& at, const Opening& o) {
  VecN<18> g = 2 * e.shear * at.slope() * o.slipped;
  if (o.open > 0) g += 2 * o.open * height_gradient(at, o);
  return g;
}
}  // namespace tape
