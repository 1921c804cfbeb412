#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tape/model/scene.hpp"

namespace cosim {
/// What can be waited for. Force: magnitude of what a grip, a body or a link bears (contacts, adhesion and holds). Height: z of the origin
/// of a body's mesh or of a strip's end. Speed: of a body's centre, or of a strip's fastest vertex. Distance: between two places that have
/// a height.
enum class Quantity { force, height, speed, distance };
constexpr auto enum_names(Quantity) { return std::array<std::string_view, 4>{"force", "height", "speed", "distance"}; }
constexpr auto unit_names(Quantity) { return std::array<const char*, 4>{"N", "m", "m/s", "m"}; }

/// Something that a script waits for: that a quantity of a thing is above or below a level, or that the time for it is over.
struct Event {
  Quantity quantity = Quantity::force;
  std::vector<std::string> things;  ///< one; of a distance two
  bool above = true;
  double level = 0;    ///< in the quantity's unit
  tape::Moment start;  ///< looked at from here on
  double timeout = 0;  ///< [s] after the start
};
/// "force of pull above 2 N within 3 s"
std::string to_text(const Event& event);

/// What a name in an event stands for: indices into the lists of a scene.
struct Thing {
  std::optional<std::size_t> strip, grip, body;
  bool tip = true;  ///< of a strip: its tip, not its root
};
/// A strip is named alone, or by its tip or root.
Thing find_thing(const std::string& name, const tape::Scene& scene);

/// @throws InputError for a thing that the scene does not have, or that has no such quantity
void require_things(const Event& event, const tape::Scene& scene);
}  // namespace cosim
