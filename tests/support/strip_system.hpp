#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "tape/core/types.hpp"
#include "tape/solver/linear_params.hpp"

namespace tape::test {
/// A linear system like those of a tape strip, made of springs: a mass on every block, membrane springs along the edges of a
/// lattice, second differences for bending, and optionally contacts and rigid bodies. Slots as elements write them.
struct StripSystem {
  struct Slots {
    std::vector<std::uint64_t> keys;
    std::vector<Mat3> values;
    void add(int i, int j, const Mat3& h);  ///< h is H_ij; i <= j or not
  };
  int n = 0;  ///< blocks
  Slots fixed, contact;
  SystemLayout layout;
  std::vector<Vec3> x;  ///< [n] positions; bodies: centre, and nothing

  static constexpr int kColumns = 7;
  Real vertex_mass = 1, membrane = 1e3, bending = 1;

  int add_strip(int rows);  ///< on a curled sheet  @return its first block
  /// A strip wound on a spiral about the y axis, like the published roll (19 mm wide, pitch 0.18 mm) in units of its cells of 3.17 mm.
  /// Every vertex touches the edge in front of it in the next turn with stiffness k. Only the mass holds it against rigid motion.
  int add_roll(int turns, Real k);                             ///< @return its first block
  int add_body(const Vec3& centre, Real mass);                 ///< @return its first block
  void add_contact(int i, int j, const Vec3& normal, Real k);  ///< between strip blocks
  void add_contact_to_edge(int i, int a, int b, Real k);       ///< along the line from i to its nearest point of the edge
  void add_contact_to_body(int i, int body, const Vec3& normal, Real k);
  /// Contacts of a strip folded in half, with the rows near the fold left free.
  void fold(int first_block, int rows, Real k);

  /// @return [n] velocity + spin x p for each point p, and spin for the rotation of each body
  std::vector<Vec3> rigid_motion(const Vec3& velocity, const Vec3& spin) const;
  Eigen::MatrixXd dense() const;
  std::vector<Vec3> load() const;  ///< uniform, plus a rough part

 private:
  int add_lattice(const std::vector<Vec3>& points, bool wound);  // points [rows kColumns]
};
}  // namespace tape::test
