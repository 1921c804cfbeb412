#include "tape/step/sides.hpp"
#include "tape/step/stepper.inl"

namespace tape::on_cpu {
std::unique_ptr<Stepper> make_stepper(const World& world) { return std::make_unique<SideStepper>(world); }
}  // namespace tape::on_cpu
