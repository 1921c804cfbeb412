#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "tape/core/settings.hpp"

namespace tape {
enum class LinearKind { automatic, cholesky, pcg_jacobi, pcg_strip, pcg_two_level };
constexpr auto enum_names(LinearKind) {
  return std::array<std::string_view, 5>{"auto", "cholesky", "pcg_jacobi", "pcg_strip", "pcg_two_level"};
}

/// How A x = b is solved; part of the scene's `solver`.
struct LinearParams {
  LinearKind linear = LinearKind::automatic;
  Real pcg_tol = 1e-4;         ///< ||x - x_k||_A / ||x||_A, as estimated (README)
  int pcg_iterations = 10000;  ///< cap; reaching it is reported as not converged
  template <class F>
  void fields(F&& f) {
    f("linear", linear, "", Range::any(), "linear solver; auto: by the fixed cost model");
    f("pcg_tol", pcg_tol, "", Range::above(0, 0.1), "relative error of PCG in the energy norm");
    f("pcg_iterations", pcg_iterations, "", Range::closed(1, 1e6), "PCG iterations at most");
  }
};

/// @param strip_available  whether the side offers pcg_strip
/// @throws SettingsError for a value out of range or a solver that the side does not offer
void check(const LinearParams& params, bool strip_available);

/// Unknowns of one strip: consecutive blocks, row after row along the strip.
struct StripLayout {
  int first_block = 0;
  int blocks = 0;
  int blocks_per_row = 1;
};
/// What the unknowns are. Blocks that no strip has (bodies, articulations) are the border of the strips.
struct SystemLayout {
  std::vector<StripLayout> strips;
  std::vector<int> body_blocks;  ///< first of the two consecutive blocks of each rigid body: translation, rotation
};

/// Outcome of one linear solve.
struct LinearReport {
  std::string solver;          ///< "cholesky_simplicial", "cholesky_supernodal", or the name of the LinearKind
  int iterations = 0;          ///< of PCG; 0 for Cholesky
  Real relative_residual = 0;  ///< |b - A x| / |b|
  Real error_estimate = 0;     ///< PCG: estimate of ||x* - x||_A / ||x*||_A
  bool converged = false;
  bool negative_curvature = false;  ///< A is not positive definite; x is not to be used
  int dropped = 0;                  ///< blocks outside the bands that the strip preconditioner left out
};
}  // namespace tape
