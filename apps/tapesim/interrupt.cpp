#include "apps/tapesim/interrupt.hpp"

#include <csignal>

namespace tape::tapesim {
namespace {
volatile std::sig_atomic_t asked = 0;

void remember(int signal) {
  asked = 1;
  std::signal(signal, SIG_DFL);
}
}  // namespace

void remember_interrupts() {
  asked = 0;
  std::signal(SIGINT, remember);
  std::signal(SIGTERM, remember);
}
bool interrupted() { return asked != 0; }
}  // namespace tape::tapesim
