#pragma once
#include <memory>

#include "tape/step/stepper.hpp"

/// The stepper of each side; made from the same source. Without CUDA in the build the second answers that it is not there.
namespace tape::on_cpu {
std::unique_ptr<Stepper> make_stepper(const World& world);
}
namespace tape::on_cuda {
bool available_to_step();
std::unique_ptr<Stepper> make_stepper(const World& world);
}  // namespace tape::on_cuda
