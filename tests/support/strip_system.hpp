#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "tape/core/types.hpp"
#include "tape/solver/linear_params.hpp"

namespace tape::test {
/// A linear system like those of a tape strip, made of springs: mass 1 on every block, membrane springs along the edges of a
/// lattice on a curled sheet, second differences for bending, and optionally contacts and rigid bodies. Slots as elements write them.
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
  Real membrane = 1e3, bending = 1;

  int add_strip(int rows);                                     ///< @return its first block
  int add_body(const Vec3& centre, Real mass);                 ///< @return its first block
  void add_contact(int i, int j, const Vec3& normal, Real k);  ///< between strip blocks
  void add_contact_to_body(int i, int body, const Vec3& normal, Real k);
  /// Contacts of a strip folded in half, with the rows near the fold left free.
  void fold(int first_block, int rows, Real k);

  Eigen::MatrixXd dense() const;
  std::vector<Vec3> load() const;  ///< uniform, plus a rough part
};
}  // namespace tape::test
