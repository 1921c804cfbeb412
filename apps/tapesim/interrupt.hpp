#pragma once
namespace tape::tapesim {
/// From now on the first Ctrl-C (SIGINT, or SIGTERM) is only remembered, so that the work can end well; the second ends the program at
/// once.
void remember_interrupts();
bool interrupted();
}  // namespace tape::tapesim
