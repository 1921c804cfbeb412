#include "tests/support/strip_system.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tape/math/rotation.hpp"
#include "tape/solver/block_matrix.hpp"

namespace tape::test {
void StripSystem::Slots::add(int i, int j, const Mat3& h) {
  keys.push_back(i <= j ? block_key(i, j) : block_key(j, i));
  values.push_back(i <= j ? h : Mat3(h.transpose()));
}

int StripSystem::add_strip(int rows) {
  std::vector<Vec3> points;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < kColumns; ++c) points.push_back({r + 0.1 * std::sin(0.7 * c), Real(c), 3 * std::sin(0.05 * r) + 20.0 * n});
  return add_lattice(points, false);
}

int StripSystem::add_roll(int turns, Real k) {
  constexpr Real inner = 6.6, pitch = 0.057, turn = 2 * std::numbers::pi;
  std::vector<Real> angle;  // of each row
  std::vector<Vec3> points;
  for (Real phi = 0; phi < turns * turn;) {
    const Real radius = inner + pitch * phi / turn;
    for (int c = 0; c < kColumns; ++c) points.push_back({radius * std::cos(phi), Real(c), radius * std::sin(phi)});
    angle.push_back(phi);
    phi += 1 / radius;
  }
  const int first = add_lattice(points, true), rows = static_cast<int>(angle.size());
  for (int r = 0, next = 0; r < rows; ++r) {  // `next` ends as the first row behind the angle one turn on
    while (next < rows && angle[static_cast<std::size_t>(next)] <= angle[static_cast<std::size_t>(r)] + turn) ++next;
    if (next == rows) break;
    for (int c = 0; c < kColumns; ++c)
      add_contact_to_edge(first + r * kColumns + c, first + (next - 1) * kColumns + c, first + next * kColumns + c, k);
  }
  return first;
}

int StripSystem::add_lattice(const std::vector<Vec3>& points, bool wound) {
  const int first = n, rows = static_cast<int>(points.size()) / kColumns;
  const auto id = [&](int r, int c) { return first + r * kColumns + c; };
  const auto at = [&](int i) { return x[static_cast<std::size_t>(i)]; };
  n += rows * kColumns;
  x.insert(x.end(), points.begin(), points.end());
  for (int i = first; i < n; ++i) fixed.add(i, i, vertex_mass * Mat3::Identity());
  const auto spring = [&](int i, int j) {
    const Vec3 e = (at(i) - at(j)).normalized();
    const Mat3 h = membrane * e * e.transpose();
    fixed.add(i, i, h), fixed.add(j, j, h), fixed.add(i, j, -h);
  };
  const auto bend = [&](int i, int j, int k, const Mat3& directions) {  // bending / 2 |x_i - 2 x_j + x_k|^2 in these directions
    const int v[] = {i, j, k};
    const Real w[] = {1, -2, 1};
    for (int a = 0; a < 3; ++a)
      for (int b = a; b < 3; ++b) fixed.add(v[a], v[b], bending * w[a] * w[b] * directions);
  };
  const auto along = [&](int i, int j, int k) -> Mat3 {  // only across the curve, so that turning a roll costs nothing
    const Vec3 normal = (at(i) - 2 * at(j) + at(k)).normalized();
    return wound ? Mat3(normal * normal.transpose()) : Mat3(Mat3::Identity());
  };
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < kColumns; ++c) {
      if (r + 1 < rows) spring(id(r, c), id(r + 1, c));
      if (c + 1 < kColumns) spring(id(r, c), id(r, c + 1));
      if (r + 1 < rows && c + 1 < kColumns) spring(id(r, c), id(r + 1, c + 1));
      if (r + 2 < rows) bend(id(r, c), id(r + 1, c), id(r + 2, c), along(id(r, c), id(r + 1, c), id(r + 2, c)));
      if (c + 2 < kColumns) bend(id(r, c), id(r, c + 1), id(r, c + 2), Mat3::Identity());
    }
  layout.strips.push_back({first, rows * kColumns, kColumns});
  return first;
}

int StripSystem::add_body(const Vec3& centre, Real mass) {
  const int first = n;
  n += 2;
  x.push_back(centre);
  x.push_back(Vec3::Zero());
  fixed.add(first, first, mass * Mat3::Identity());
  fixed.add(first + 1, first + 1, Vec3(2, 3, 4).asDiagonal() * Mat3(mass * Mat3::Identity()));
  fixed.add(first, first + 1, Mat3::Zero());
  layout.body_blocks.push_back(first);
  return first;
}

void StripSystem::add_contact(int i, int j, const Vec3& normal, Real k) {
  const Mat3 h = k * normal * normal.transpose();
  contact.add(i, i, h), contact.add(j, j, h), contact.add(i, j, -h);
}

void StripSystem::add_contact_to_edge(int i, int a, int b, Real k) {
  const auto at = [&](int v) { return x[static_cast<std::size_t>(v)]; };
  const Vec3 edge = at(b) - at(a);
  const Real t = std::clamp((at(i) - at(a)).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
  const Vec3 normal = (at(a) + t * edge - at(i)).normalized();
  const int v[] = {i, a, b};
  const Real w[] = {1, t - 1, -t};
  for (int p = 0; p < 3; ++p)
    for (int q = p; q < 3; ++q) contact.add(v[p], v[q], k * w[p] * w[q] * normal * normal.transpose());
}

void StripSystem::add_contact_to_body(int i, int body, const Vec3& normal, Real k) {
  const Mat3 h = k * normal * normal.transpose();
  Mat3 arm;  // displacement of the body's point: t + spin x r = t - [r] spin
  const Vec3 r = x[static_cast<std::size_t>(i)] - x[static_cast<std::size_t>(body)];
  arm << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  const Mat3 j_spin = -arm;
  contact.add(i, i, h), contact.add(body, body, h), contact.add(i, body, -h);
  contact.add(body + 1, body + 1, j_spin.transpose() * h * j_spin);
  contact.add(i, body + 1, -h * j_spin), contact.add(body, body + 1, h * j_spin);
}

void StripSystem::fold(int first_block, int rows, Real k) {
  for (int r = 0; r < rows / 2 - 5; ++r)
    for (int c = 0; c < kColumns; ++c)
      add_contact(first_block + r * kColumns + c, first_block + (rows - 1 - r) * kColumns + c, Vec3::UnitZ(), k);
}

Eigen::MatrixXd StripSystem::dense() const {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (const Slots* slots : {&fixed, &contact})
    for (std::size_t s = 0; s < slots->keys.size(); ++s) {
      const auto i = static_cast<Eigen::Index>(slots->keys[s] >> 32), j = static_cast<Eigen::Index>(slots->keys[s] & 0xffffffffu);
      a.block<3, 3>(3 * i, 3 * j) += slots->values[s];
      if (i != j) a.block<3, 3>(3 * j, 3 * i) += slots->values[s].transpose();
    }
  return a;
}

std::vector<Vec3> StripSystem::rigid_motion(const Vec3& velocity, const Vec3& spin) const {
  std::vector<Vec3> u;
  for (const Vec3& p : x) u.push_back(velocity + spin.cross(p));
  for (int b : layout.body_blocks) u[static_cast<std::size_t>(b) + 1] = spin;
  return u;
}

std::vector<Vec3> StripSystem::load() const {
  std::vector<Vec3> b(static_cast<std::size_t>(n));
  for (std::size_t i = 0; i < b.size(); ++i) {
    const Real t = static_cast<Real>(i);
    b[i] = Vec3(0.3, 0.1, -1) + 0.5 * Vec3(std::sin(7.1 * t), std::sin(3.3 * t * t), std::cos(5.7 * t));
  }
  return b;
}
}  // namespace tape::test
