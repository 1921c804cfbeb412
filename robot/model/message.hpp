#pragma once
#include <sstream>
#include <string>

namespace robot {
/// The parts of a message, one after the other; numbers as streams print them.
template <class... Parts>
std::string message(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}
}  // namespace robot
