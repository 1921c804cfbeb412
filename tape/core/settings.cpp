#include "tape/core/settings.hpp"

#include <charconv>

namespace tape {
std::string to_text(Real value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

std::string Range::text() const {
  const bool bounded_low = std::isfinite(low), bounded_high = std::isfinite(high);
  if (!bounded_low && !bounded_high) return "any finite number";
  if (!bounded_high) return (open_low ? "> " : ">= ") + to_text(low);
  if (!bounded_low) return (open_high ? "< " : "<= ") + to_text(high);
  return (open_low ? "(" : "[") + to_text(low) + ", " + to_text(high) + (open_high ? ")" : "]");
}
}  // namespace tape
