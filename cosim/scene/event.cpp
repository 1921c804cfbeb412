#include "cosim/scene/event.hpp"

namespace cosim {
std::string to_text(const Event& e) { return to_text(e.claim) + " within " + tape::to_text(e.timeout) + " s"; }
}  // namespace cosim
