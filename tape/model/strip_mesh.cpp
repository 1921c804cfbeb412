#include "tape/model/strip_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <random>

#include "tape/model/delaunay.hpp"

namespace tape {
namespace {
constexpr Real kMaxCells = 5e5;
constexpr Real kJitter = 0.25;  // of a cell, each way
constexpr Real kShear = 1e-3;   // makes one diagonal of a rectangular lattice cell Delaunay and the other not

struct Grid {
  int cells_along, cells_across;
  Real length, width;
  Vec2 point(Real i, Real j) const { return {length * i / cells_along, width * j / cells_across - width / 2}; }
  Vec2 cell() const { return {length / cells_along, width / cells_across}; }
};

Grid make_grid(const StripParams& params, Real width) {
  const Real wanted = params.cell_length > 0 ? params.cell_length : width / params.cells_across;
  const Real cells = std::max(1.0, std::round(params.length / wanted));
  if (!(cells * params.cells_across <= kMaxCells))
    throw InputError("strip: " + to_text(cells) + " x " + std::to_string(params.cells_across) + " cells (allowed: " + to_text(kMaxCells) +
                     " together); strip.length, strip.cell_length or strip.cells_across is wrong");
  return {static_cast<int>(cells), params.cells_across, params.length, width};
}

StripMesh lattice(const Grid& grid, bool alternating) {
  StripMesh mesh;
  mesh.rows = grid.cells_along + 1, mesh.columns = grid.cells_across + 1;
  for (int i = 0; i < mesh.rows; ++i)
    for (int j = 0; j < mesh.columns; ++j) mesh.rest.push_back(grid.point(i, j));
  for (int i = 0; i < grid.cells_along; ++i)
    for (int j = 0; j < grid.cells_across; ++j) {
      const int a = i * mesh.columns + j, b = a + mesh.columns, c = b + 1, d = a + 1;
      if (alternating && (i + j) % 2 == 1) {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {b, c, d}});
      } else {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
      }
    }
  return mesh;
}

/// Both diagonals: each cell has its centre. A row holds its vertices, then the centres of the cells behind it.
StripMesh crossed(const Grid& grid) {
  StripMesh mesh;
  mesh.rows = grid.cells_along + 1, mesh.columns = 2 * grid.cells_across + 1;
  for (int i = 0; i < mesh.rows; ++i) {
    for (int j = 0; j <= grid.cells_across; ++j) mesh.rest.push_back(grid.point(i, j));
    for (int j = 0; j < grid.cells_across && i < grid.cells_along; ++j) mesh.rest.push_back(grid.point(i + 0.5, j + 0.5));
  }
  for (int i = 0; i < grid.cells_along; ++i)
    for (int j = 0; j < grid.cells_across; ++j) {
      const int a = i * mesh.columns + j, b = a + mesh.columns, c = b + 1, d = a + 1, centre = a + grid.cells_across + 1;
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, centre}, {b, c, centre}, {c, d, centre}, {d, a, centre}});
    }
  return mesh;
}

StripMesh irregular(const Grid& grid, int seed) {
  StripMesh mesh = lattice(grid, true);
  std::mt19937_64 generator(static_cast<std::uint64_t>(seed));
  const auto offset = [&] { return kJitter * (2 * static_cast<Real>(generator() >> 11) * 0x1p-53 - 1); };
  for (int i = 1; i + 1 < mesh.rows; ++i)
    for (int j = 1; j + 1 < mesh.columns; ++j) {
      const Real di = offset(), dj = offset();
      mesh.rest[i * mesh.columns + j] = grid.point(i + di, j + dj);
    }
  flip_to_delaunay(mesh.rest, mesh.rest, mesh.triangles);
  number_by_x(mesh);
  return mesh;
}

/// The lattice of `grid`, turned about the middle of the strip and clipped: lattice points at least half a cell inside, and
/// evenly spaced points on the boundary.
StripMesh turned_lattice(const Grid& grid, Real angle) {
  const Vec2 cell = grid.cell(), middle(grid.length / 2, 0);
  Mat2 turn;
  turn << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  const auto spacing = [&](const Vec2& direction) { return 1 / (turn.transpose() * direction).cwiseQuotient(cell).norm(); };
  const Vec2 step(spacing(Vec2::UnitX()), spacing(Vec2::UnitY()));

  StripMesh mesh;
  const int along = std::max(1, static_cast<int>(std::round(grid.length / step.x())));
  const int across = std::max(1, static_cast<int>(std::round(grid.width / step.y())));
  for (int i = 0; i <= along; ++i)
    for (Real side : {-0.5, 0.5}) mesh.rest.push_back({grid.length * i / along, side * grid.width});
  for (int j = 1; j < across; ++j)
    for (Real x : {0.0, grid.length}) mesh.rest.push_back({x, grid.width * j / across - grid.width / 2});
  const Vec2 limit(grid.length / 2 - step.x() / 2, grid.width / 2 - step.y() / 2);
  const Vec2 row = turn.col(0) * cell.x(), column = turn.col(1) * cell.y();
  const int reach = static_cast<int>(std::hypot(grid.length, grid.width) / cell.x()) + 1;
  for (int i = -reach; i <= reach; ++i) {
    Real low = -kMaxCells, high = kMaxCells;  // those j for which i row + j column lies inside the limits
    for (int axis = 0; axis < 2; ++axis) {
      const Real a = (-limit[axis] - i * row[axis]) / column[axis], b = (limit[axis] - i * row[axis]) / column[axis];
      if (std::fabs(column[axis]) > 1e-9 * column.norm())
        low = std::max(low, std::min(a, b)), high = std::min(high, std::max(a, b));
      else if (std::fabs(i * row[axis]) > limit[axis])
        high = low;
    }
    for (Real j = std::ceil(low - 1e-9); j <= high + 1e-9 && high > low; ++j) mesh.rest.push_back(middle + i * row + j * column);
  }

  mesh.triangles = triangulate_hull(mesh.rest);
  std::vector<Vec2> sheared;  // along the rows of the lattice: shortens the diagonals of pattern `same`
  for (const Vec2& p : mesh.rest) {
    const Vec2 q = turn.transpose() * (p - middle);
    sheared.push_back({q.x() - kShear * q.y() * cell.x() / cell.y(), q.y()});
  }
  flip_to_delaunay(mesh.rest, sheared, mesh.triangles);
  number_by_x(mesh);
  return mesh;
}

/// Piece of a centreline from arc length s on.
struct Arc {
  Real s, heading;  // [m], [rad]
  Vec2 point;       // [m] along and normal
  Real curvature;   // [1/m]
  Vec2 at(Real ds) const {
    const Real half = curvature * ds / 2, chord = std::fabs(half) > 1e-8 ? ds * std::sin(half) / half : ds;
    return point + chord * Vec2(std::cos(heading + half), std::sin(heading + half));
  }
};
/// The last one is straight.
std::vector<Arc> arcs_of(const std::vector<PathPiece>& path) {
  std::vector<Arc> arcs{{0, 0, Vec2::Zero(), 0}};
  for (const PathPiece& piece : path) {
    Arc& now = arcs.back();
    now.curvature = piece.turn / piece.length;
    arcs.push_back({now.s + piece.length, now.heading + piece.turn, now.at(piece.length), 0});
  }
  return arcs;
}
Vec2 point_on(const std::vector<Arc>& arcs, Real s) {
  auto arc = arcs.end() - 1;
  while (arc != arcs.begin() && arc->s > s) --arc;
  return arc->at(s - arc->s);
}
}  // namespace

Real cell_length(const StripParams& params, Real width) { return make_grid(params, width).cell().x(); }

StripMesh make_strip_mesh(const StripParams& params, Real width, int seed) {
  require_valid(params, "strip");
  const Grid grid = make_grid(params, width);
  if (params.grid_angle != 0) {
    if (params.pattern != MeshPattern::same)
      throw InputError("strip.grid_angle = " + to_text(params.grid_angle) + ": needs strip.pattern = same, not " + to_text(params.pattern));
    return turned_lattice(grid, params.grid_angle * std::numbers::pi / 180);
  }
  switch (params.pattern) {
    case MeshPattern::crossed:
      return crossed(grid);
    case MeshPattern::irregular:
      return irregular(grid, seed);
    default:
      return lattice(grid, params.pattern == MeshPattern::alternating);
  }
}

std::vector<int> number_by_x(StripMesh& mesh) {
  std::vector<int> order(mesh.rest.size()), rank(mesh.rest.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const Vec2 &p = mesh.rest[a], &q = mesh.rest[b];
    return p.x() != q.x() ? p.x() < q.x() : p.y() < q.y();
  });
  std::vector<Vec2> sorted;
  for (std::size_t i = 0; i < order.size(); ++i) {
    rank[order[i]] = static_cast<int>(i);
    sorted.push_back(mesh.rest[order[i]]);
  }
  mesh.rest = std::move(sorted);
  mesh.columns = 1;
  for (Index3& t : mesh.triangles) {
    t = {rank[t[0]], rank[t[1]], rank[t[2]]};
    mesh.columns = std::max(mesh.columns, t.maxCoeff() - t.minCoeff());
  }
  mesh.rows = (static_cast<int>(mesh.rest.size()) + mesh.columns - 1) / mesh.columns;
  return rank;
}

std::vector<Vec3> place(const StripMesh& mesh, const Strip& strip) {
  if (!strip.settled.empty()) {
    if (strip.settled.size() != mesh.rest.size()) throw InputError("strip '" + strip.name + "': its settled positions are of another mesh");
    std::vector<Vec3> x;
    for (const Vec3& p : strip.settled) x.push_back(apply(strip.pose, p));
    return x;
  }
  const std::vector<Arc> arcs = arcs_of(strip.path);
  std::vector<Vec3> x;
  x.reserve(mesh.rest.size());
  for (const Vec2& rest : mesh.rest) {
    const Vec2 p = strip.winding ? strip.winding->at(rest.x()) : point_on(arcs, rest.x());
    x.push_back(apply(strip.pose, {p.x(), rest.y(), p.y()}));
  }
  return x;
}

std::vector<int> survivors(const StripMesh& whole, const StripMesh& remnant) {
  std::map<std::pair<Real, Real>, int> there;
  for (std::size_t v = 0; v < remnant.rest.size(); ++v) there[{remnant.rest[v].x(), remnant.rest[v].y()}] = static_cast<int>(v);
  std::vector<int> out;
  for (const Vec2& p : whole.rest) {
    const auto it = there.find({p.x(), p.y()});
    out.push_back(it == there.end() ? -1 : it->second);
  }
  return out;
}

std::vector<int> vertices_between(const StripMesh& mesh, Real from, Real to) {
  std::vector<int> found;
  for (int v = 0; v < static_cast<int>(mesh.rest.size()); ++v)
    if (const Real x = mesh.rest[v].x(); x >= from && x <= to) found.push_back(v);
  return found;
}

std::vector<int> root_vertices(const StripMesh& mesh, Real tolerance) {
  return vertices_between(mesh, -std::numeric_limits<Real>::infinity(), tolerance);
}

std::vector<int> tip_vertices(const StripMesh& mesh, Real tolerance) {
  Real length = 0;
  for (const Vec2& p : mesh.rest) length = std::max(length, p.x());
  return vertices_between(mesh, length - tolerance, std::numeric_limits<Real>::infinity());
}
}  // namespace tape
