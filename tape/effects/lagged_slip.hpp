#pragma once
#include <array>
#include <string_view>

#include "tape/bodies/state_view.hpp"
#include "tape/contact/pair.hpp"

namespace tape {
struct PairState;

/// What slip is measured in: a frame that turns with the pair, or the tangent plane of the start of the step.
enum class SlipFrame { turning, fixed };
constexpr auto enum_names(SlipFrame) { return std::array<std::string_view, 2>{"turning", "fixed"}; }

/// Tangential slip u of a contact pair in a step. Where the step starts, the pair fixes its closest points and the tangent plane T across
/// the offset between them. `fixed` is the published u = T^T (r - r_start) of the way r = sum_i w_i x_i between the points [Li 2020].
/// Surfaces keep a distance, so that a pair that turns as a whole seems to slip by that distance times the angle: the layers of a roll then
/// hold it fast. `turning` measures r along two edges e of the pair, y = (e_0.r, e_1.r, (e_0 x e_1).r), which a rigid motion leaves alone:
/// u = T^T B^-T (y - y_start), B = (e_0, e_1, e_0 x e_1) when the step started; to first order the same, less the turning.
struct LaggedSlip {
  int v[4];
  PairKind kind;
  Real weight[4];
  Mat32 T;                            ///< tangent basis
  Eigen::Matrix<Real, 2, 3> slip_of;  ///< T^T B^-T
  Vec3 start;                         ///< y_start
  Vec2 before;                        ///< [m] slip that is there when the step starts

  /// At the start of a step. The edges of an edge-edge pair must not be parallel.
  TAPE_HD static inline LaggedSlip at(const ContactPair& pair, const PairState& p, Span<const Vec3> x);
  /// u [m].
  TAPE_HD inline Vec2 slip(SlipFrame frame, const StateView& s) const;
  /// A slip as a pair remembers it, whatever its tangent basis and however it has turned: B^T T u.
  TAPE_HD inline Vec3 remembered(const Vec2& u, const StateView& s) const;
  TAPE_HD inline Vec2 recalled(const Vec3& y) const;
  /// du/dx.
  TAPE_HD inline MatN<12, 2> slope(SlipFrame frame, const StateView& s) const;
  /// h += sum_a g_a d2u_a/dx2; nothing in a fixed frame.
  TAPE_HD inline void add_curvature(SlipFrame frame, const StateView& s, const Vec2& g, MatN<12, 12>& h) const;

 private:
  struct Way;
};
}  // namespace tape
