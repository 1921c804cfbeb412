#include "tape/solver/blas.hpp"

#include <dlfcn.h>

namespace tape {
void fix_blas_threads() {
  using SetThreads = void (*)(int);
  static const auto set_threads = reinterpret_cast<SetThreads>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"));
  if (set_threads != nullptr) set_threads(1);
}
}  // namespace tape
