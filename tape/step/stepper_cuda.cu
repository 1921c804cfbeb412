#include "tape/step/sides.hpp"
#include "tape/step/stepper.inl"

namespace tape::on_cuda {
bool available_to_step() { return available(); }
std::unique_ptr<Stepper> make_stepper(const World& world) { return std::make_unique<SideStepper>(world); }
}  // namespace tape::on_cuda
