#include "tape/solver/linear_params.hpp"

namespace tape {
void check(const LinearParams& params, bool strip_available) {
  require_valid(params, "solver");
  if (params.linear == LinearKind::pcg_strip && !strip_available)
    throw SettingsError("solver.linear", to_text(params.linear), "auto, cholesky, pcg_jacobi or pcg_two_level on this back end");
}
}  // namespace tape
