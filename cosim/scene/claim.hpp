#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cosim/exchange/robots.hpp"
#include "cosim/scene/reader.hpp"
#include "tape/model/scene.hpp"

namespace cosim {
/// What can be waited for and judged.
/// force: magnitude of what a grip, a body or a link bears (contacts, adhesion and holds)
/// height: z of the origin of a body's mesh or of a strip's end
/// speed: of a body's centre, or of a strip's fastest vertex
/// distance: between two places that have a height
/// joint: position of a robot's joint
/// attached: share of a strip's area that adheres, to a body or strip if one is named
/// seam: length along a line over which a strip adheres to the bodies on both sides of it
/// pieces: of a strip, that do not hang together
/// wound: length of tape that is left on a roll
/// turns: that what adheres of a strip makes about an axis of a body
enum class Quantity { force, height, speed, distance, joint, attached, seam, pieces, wound, turns };
constexpr auto enum_names(Quantity) {
  return std::array<std::string_view, 10>{"force", "height", "speed", "distance", "joint", "attached", "seam", "pieces", "wound", "turns"};
}
constexpr auto unit_names(Quantity) { return std::array<const char*, 10>{"N", "m", "m/s", "m", "rad or m", "1", "m", "1", "m", "1"}; }

/// That a quantity of a thing is above or below a level.
struct Claim {
  Quantity quantity = Quantity::force;
  std::vector<std::string> things;  ///< one; of a distance two, of a seam the strip and both bodies, of turns the strip and the body
  bool above = true;
  double level = 0;            ///< in the quantity's unit
  int robot = -1, joint = -1;  ///< of a joint: the robot, and which of its joints
  Vec3 along = Vec3::Zero();   ///< of a seam or of turns: unit vector in the frame of the first body
};
/// "force of pull above 2 N"
std::string to_text(const Claim& claim);

/// A section such as {force: pull, above: 2}.
/// @throws InputError also for a thing that the scene does not have, or that has no such quantity
Claim read_claim(const Reader& section, const tape::Scene& scene, const RobotScene& robots);

/// What a name in a claim stands for: indices into the lists of a scene.
struct Thing {
  std::optional<std::size_t> strip, grip, body;
  bool tip = true;  ///< of a strip: its tip, not its root
};
/// A strip is named alone, or by its tip or root.
Thing find_thing(const std::string& name, const tape::Scene& scene);
}  // namespace cosim
