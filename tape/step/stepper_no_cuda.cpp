#include "tape/core/error.hpp"
#include "tape/step/sides.hpp"

namespace tape::on_cuda {
#ifndef TAPE_HAS_CUDA
bool available_to_step() { return false; }
std::unique_ptr<Stepper> make_stepper(const World&) { throw CheckFailed("this build has no CUDA"); }
#endif
}  // namespace tape::on_cuda
