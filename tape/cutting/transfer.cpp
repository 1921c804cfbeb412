#include "tape/cutting/transfer.hpp"

#include <Eigen/Cholesky>
#include <numeric>

namespace tape {
namespace {
using Polygon = std::vector<Vec2>;

/// The part of a convex polygon on the left of a-b.
Polygon left_part(const Polygon& polygon, const Vec2& a, const Vec2& b) {
  Polygon out;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const Real at_p = turn(a, b, p), at_q = turn(a, b, q);
    if (at_p >= 0) out.push_back(p);
    if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0)) out.push_back(p + at_p / (at_p - at_q) * (q - p));
  }
  return out;
}

bool boxes_overlap(const Corners& s, const Corners& t) {
  const auto low = [](const Corners& c) { return c.a.cwiseMin(c.b).cwiseMin(c.c).eval(); };
  const auto high = [](const Corners& c) { return c.a.cwiseMax(c.b).cwiseMax(c.c).eval(); };
  return (low(s).array() < high(t).array()).all() && (low(t).array() < high(s).array()).all();
}

struct Piece {
  Momentum has, needs;
  bool changed = false;
};

class Mover {
 public:
  Mover(const StripMesh& old, const Cut& cut, const std::vector<Vec3>& x, const std::vector<Vec3>& v, Real per_area)
      : old_(old), cut_(cut), x_(x), v_(v), per_area_(per_area), pieces_(static_cast<std::size_t>(cut.pieces)) {}

  MovedOn run() {
    MovedOn out{interpolated(old_, cut_, x_), interpolated(old_, cut_, v_), lumped_mass(cut_.mesh, per_area_), {}, 0};
    out.kerf = what_pieces_need();
    for (std::size_t i = 0; i < out.x.size(); ++i) pieces_[cut_.piece[i]].has.add(out.mass[i], out.x[i], out.v[i]);
    for (int p = 0; p < cut_.pieces; ++p)
      if (pieces_[p].changed) correct(out, p);
    return out;
  }

 private:
  /// Adds material of an old triangle. @param at  barycentric, its centre
  void add(Momentum& sum, int triangle, Real area, const Vec3& at) const {
    for (int k = 0; k < 3; ++k) {
      const int i = old_.triangles[triangle][k];
      sum.add(per_area_ * area * at[k], x_[i], v_[i]);
    }
  }

  /// Hands the old momentum to the pieces; what nobody gets is returned.
  Momentum what_pieces_need() {
    Momentum rest;
    std::vector<int> gone;  // old triangles that are no more
    for (int t = 0; t < static_cast<int>(old_.triangles.size()); ++t) {
      const Real area = corners(old_, t).area();
      if (const int same = cut_.new_triangle[t]; same >= 0) {
        add(pieces_[piece_of(same)].needs, t, area, Vec3::Constant(1.0 / 3));
      } else {
        gone.push_back(t);
        add(rest, t, area, Vec3::Constant(1.0 / 3));
      }
    }
    for (int n = cut_.unchanged; n < static_cast<int>(cut_.mesh.triangles.size()); ++n) {
      Piece& piece = pieces_[piece_of(n)];
      piece.changed = true;
      for (int t : gone) share(n, t, piece.needs, rest);
    }
    return rest;
  }
  int piece_of(int triangle) const { return cut_.piece[cut_.mesh.triangles[triangle][0]]; }

  /// What a new triangle has of an old one goes from `rest` to `sum`.
  void share(int fresh, int old, Momentum& sum, Momentum& rest) const {
    const Corners n = corners(cut_.mesh, fresh), o = corners(old_, old);
    if (!boxes_overlap(n, o)) return;
    Polygon common{n.a, n.b, n.c};
    for (const auto& [a, b] : {std::pair(o.a, o.b), std::pair(o.b, o.c), std::pair(o.c, o.a)}) common = left_part(common, a, b);
    for (std::size_t i = 1; i + 1 < common.size(); ++i) {
      const Corners part{common[0], common[i], common[i + 1]};
      const Vec3 at = o.weight(part.centre());
      add(sum, old, part.area(), at);
      add(rest, old, -part.area(), at);
    }
  }

  void correct(MovedOn& out, int p) const {
    const Piece& piece = pieces_[p];
    Vec3 centre = Vec3::Zero();
    const auto each = [&](const auto& f) {
      for (std::size_t i = 0; i < out.x.size(); ++i)
        if (cut_.piece[i] == p) f(i);
    };
    each([&](std::size_t i) { centre += out.mass[i] * out.x[i]; });
    centre /= piece.has.mass;
    Mat3 second = Mat3::Zero();
    each([&](std::size_t i) { second += out.mass[i] * (out.x[i] - centre) * (out.x[i] - centre).transpose(); });
    const Mat3 inertia = second.trace() * Mat3::Identity() - second;
    const Vec3 linear = piece.needs.linear - piece.has.linear, angular = piece.needs.angular - piece.has.angular - centre.cross(linear);
    const Vec3 dv = linear / piece.has.mass, spin = inertia.ldlt().solve(angular);
    each([&](std::size_t i) {
      const Vec3 change = dv + spin.cross(out.x[i] - centre);
      out.v[i] += change;
      out.largest_change = std::max(out.largest_change, change.norm());
    });
  }

  const StripMesh& old_;
  const Cut& cut_;
  const std::vector<Vec3>&x_, &v_;
  Real per_area_;  // [kg/m^2]
  std::vector<Piece> pieces_;
};
}  // namespace

std::vector<Real> lumped_mass(const StripMesh& mesh, Real per_area) {
  std::vector<Real> mass(mesh.rest.size(), 0.0);
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t)
    for (int v : mesh.triangles[t]) mass[v] += corners(mesh, t).area() / 3 * per_area;
  return mass;
}

Momentum momentum(const std::vector<Real>& mass, const std::vector<Vec3>& x, const std::vector<Vec3>& v) {
  Momentum sum;
  for (std::size_t i = 0; i < mass.size(); ++i) sum.add(mass[i], x[i], v[i]);
  return sum;
}

MovedOn move_on(const StripMesh& old, const Cut& cut, const std::vector<Vec3>& x, const std::vector<Vec3>& v, Real per_area) {
  return Mover(old, cut, x, v, per_area).run();
}

Place new_place(const StripMesh& old, const Cut& cut, const Place& place) {
  if (const int same = cut.new_triangle[place.triangle]; same >= 0) return {same, place.weight};
  const Corners at = corners(old, place.triangle);
  const Vec2 p = place.weight[0] * at.a + place.weight[1] * at.b + place.weight[2] * at.c;
  std::vector<int> fresh(cut.mesh.triangles.size() - static_cast<std::size_t>(cut.unchanged));
  std::iota(fresh.begin(), fresh.end(), cut.unchanged);
  const Place found = locate(cut.mesh, fresh, p);
  return found.inside() ? found : Place{};
}
}  // namespace tape
