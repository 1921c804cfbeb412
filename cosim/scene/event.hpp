#pragma once
#include <string>

#include "cosim/scene/claim.hpp"
#include "tape/model/moment.hpp"

namespace cosim {
/// Something that a script waits for: that a claim comes true, or that the time for it is over.
struct Event {
  Claim claim;
  tape::Moment start;  ///< looked at from here on
  double timeout = 0;  ///< [s] after the start
};
/// "force of pull above 2 N within 3 s"
std::string to_text(const Event& event);
}  // namespace cosim
