#include "tape/step/stepper.hpp"

#include "tape/step/sides.hpp"

namespace tape {
bool cuda_available() { return on_cuda::available_to_step(); }

bool runs_on_cuda(Backend backend, const World& world) {
  return backend == Backend::cuda ||
         (backend == Backend::automatic && cuda_available() && world.setup.linear.linear != LinearKind::pcg_strip);
}

std::unique_ptr<Stepper> make_stepper(Backend backend, const World& world) {
  if (backend == Backend::cuda && !cuda_available())
    throw InputError("backend cuda: no CUDA device answers, or this build has no CUDA; use --backend cpu or auto");
  return runs_on_cuda(backend, world) ? on_cuda::make_stepper(world) : on_cpu::make_stepper(world);
}
}  // namespace tape
