#include "tape/step/stepper.hpp"

#include "tape/step/sides.hpp"

namespace tape {
bool cuda_available() { return on_cuda::available_to_step(); }

std::unique_ptr<Stepper> make_stepper(Backend backend, const World& world) {
  if (backend == Backend::cuda && !cuda_available())
    throw InputError("backend cuda: no CUDA device answers, or this build has no CUDA; use --backend cpu or auto");
  if (backend == Backend::cuda || (backend == Backend::automatic && cuda_available())) return on_cuda::make_stepper(world);
  return on_cpu::make_stepper(world);
}
}  // namespace tape
