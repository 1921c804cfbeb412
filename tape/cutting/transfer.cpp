#include "tape/cutting/transfer.hpp"

#include <Eigen/Cholesky>
#include <map>
#include <numeric>
#include <utility>

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

/// Columns: the values at the corners of a triangle.
Mat3 at_corners(const std::vector<Vec3>& value, const Index3& t) {
  Mat3 columns;
  columns << value[t[0]], value[t[1]], value[t[2]];
  return columns;
}

/// A piece that was cut. Lumped masses.
struct Piece {
  std::vector<int> vertices;
  Momentum lost;  ///< by the interpolation: old less new integrals
  Real mass = 0;
  Vec3 centre = Vec3::Zero();
  Mat3 inertia = Mat3::Zero();  ///< about the centre
};

class Mover {
 public:
  Mover(const StripMesh& old, const Cut& cut, const std::vector<Vec3>& x, const std::vector<Vec3>& v, Real per_area)
      : old_(old), cut_(cut), x_(x), v_(v), per_area_(per_area) {}

  MovedOn run() {
    out_.x = interpolated(old_, cut_, x_);
    out_.v = interpolated(old_, cut_, v_);
    out_.mass = lumped_mass(cut_.mesh, per_area_);
    compare();
    const std::vector<Vec3> plain = out_.v;
    Mat3 inertia = Mat3::Zero();
    for (auto& [id, piece] : pieces_) {
      measure(piece, id);
      inertia += piece.inertia;
      const Vec3 angular = piece.lost.angular - piece.centre.cross(piece.lost.linear);
      move(piece, piece.lost.linear / piece.mass, piece.inertia.ldlt().solve(angular));
    }
    const Vec3 before = momentum(lumped_mass(old_, per_area_), x_, v_).angular, after = momentum(out_.mass, out_.x, out_.v).angular;
    const Vec3 spin = inertia.ldlt().solve(before - out_.kerf.angular - after);
    for (const auto& [id, piece] : pieces_) move(piece, Vec3::Zero(), spin);
    for (std::size_t i = 0; i < plain.size(); ++i) out_.largest_change = std::max(out_.largest_change, (out_.v[i] - plain[i]).norm());
    return std::move(out_);
  }

 private:
  /// Old against new integrals over the new triangles; what no piece has went with the kerf.
  void compare() {
    std::vector<int> gone;
    for (int t = 0; t < static_cast<int>(old_.triangles.size()); ++t) {
      if (cut_.new_triangle[t] >= 0) continue;
      gone.push_back(t);
      const Index3& corner = old_.triangles[t];
      out_.kerf.add_triangle(per_area_ * corners(old_, t).area(), at_corners(x_, corner), at_corners(v_, corner));
    }
    for (int n = cut_.unchanged; n < static_cast<int>(cut_.mesh.triangles.size()); ++n) {
      const Index3& corner = cut_.mesh.triangles[n];
      Momentum& lost = pieces_[cut_.piece[corner[0]]].lost;
      lost.add_triangle(-per_area_ * corners(cut_.mesh, n).area(), at_corners(out_.x, corner), at_corners(out_.v, corner));
      for (int t : gone) share(n, t, lost);
    }
  }
  /// What a new triangle has of an old one goes from the kerf to its piece.
  void share(int fresh, int old, Momentum& piece) {
    const Corners n = corners(cut_.mesh, fresh), o = corners(old_, old);
    if (!boxes_overlap(n, o)) return;
    Polygon common{n.a, n.b, n.c};
    for (const auto& [a, b] : {std::pair(o.a, o.b), std::pair(o.b, o.c), std::pair(o.c, o.a)}) common = left_part(common, a, b);
    const Mat3 x = at_corners(x_, old_.triangles[old]), v = at_corners(v_, old_.triangles[old]);
    for (std::size_t i = 1; i + 1 < common.size(); ++i) {
      const Corners part{common[0], common[i], common[i + 1]};
      Mat3 weight;
      weight << o.weight(part.a), o.weight(part.b), o.weight(part.c);
      const Real mass = per_area_ * part.area();
      piece.add_triangle(mass, x * weight, v * weight);
      out_.kerf.add_triangle(-mass, x * weight, v * weight);
    }
  }

  void measure(Piece& piece, int id) const {
    for (int i = 0; i < static_cast<int>(out_.x.size()); ++i)
      if (cut_.piece[i] == id) piece.vertices.push_back(i);
    for (int i : piece.vertices) piece.mass += out_.mass[i], piece.centre += out_.mass[i] * out_.x[i];
    piece.centre /= piece.mass;
    for (int i : piece.vertices) {
      const Vec3 r = out_.x[i] - piece.centre;
      piece.inertia += out_.mass[i] * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
    }
  }
  void move(const Piece& piece, const Vec3& velocity, const Vec3& spin) {
    for (int i : piece.vertices) out_.v[i] += velocity + spin.cross(out_.x[i] - piece.centre);
  }

  const StripMesh& old_;
  const Cut& cut_;
  const std::vector<Vec3>&x_, &v_;
  Real per_area_;                // [kg/m^2]
  std::map<int, Piece> pieces_;  // by their numbers
  MovedOn out_;
};
}  // namespace

/// Integrals of products of linear functions over a triangle: [1/12] (sum of all pairs of corners, those of equal ones twice).
void Momentum::add_triangle(Real m, const Mat3& x, const Mat3& v) {
  mass += m;
  linear += m / 3 * v.rowwise().sum();
  angular += m / 12 * Vec3(x.rowwise().sum()).cross(Vec3(v.rowwise().sum()));
  for (int k = 0; k < 3; ++k) angular += m / 12 * x.col(k).cross(v.col(k));
}

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
