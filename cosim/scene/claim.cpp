#include "cosim/scene/claim.hpp"

#include <algorithm>
#include <tuple>

#include "cosim/scene/pose.hpp"

namespace cosim {
namespace {
template <class Named>
std::vector<std::string> names_of(const std::vector<Named>& things) {
  std::vector<std::string> names;
  for (const Named& thing : things) names.push_back(thing.name);
  return names;
}

/// How many things a quantity is of.
struct Count {
  std::size_t least, most;
};
Count things_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::distance:
    case Quantity::turns:
      return {2, 2};
    case Quantity::attached:
      return {1, 2};
    case Quantity::seam:
      return {3, 3};
    default:
      return {1, 1};
  }
}
Range levels_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::attached:
      return Range::closed(0, 1);
    case Quantity::seam:
    case Quantity::pieces:
    case Quantity::wound:
    case Quantity::turns:
      return Range::non_negative();
    default:
      return Range::any();
  }
}

class ClaimReader {
 public:
  ClaimReader(const Reader& section, const tape::Scene& scene, const RobotScene& robots)
      : section_(section), scene_(scene), robots_(robots) {}

  Claim read() {
    claim_.quantity = quantity();
    const auto q = static_cast<std::size_t>(claim_.quantity);
    const Reader things = section_[enum_names(Quantity{})[q]];
    claim_.things = things.is_list() ? things.texts() : std::vector<std::string>{things.text()};
    const Count count = things_of(claim_.quantity);
    if (claim_.things.size() < count.least || claim_.things.size() > count.most)
      things.fail("names " + std::to_string(claim_.things.size()) + " things (allowed: " + std::to_string(count.least) +
                  (count.most > count.least ? " or " + std::to_string(count.most) : "") + ")");
    require_things(things);
    const Reader above = section_["above"], below = section_["below"];
    if (above.exists() == below.exists()) section_.fail("needs either above or below");
    claim_.above = above.exists();
    claim_.level = (above ? above : below).number(levels_of(claim_.quantity), unit_names(Quantity{})[q]);
    return std::move(claim_);
  }

 private:
  Quantity quantity() const {
    const auto names = enum_names(Quantity{});
    std::string all;
    for (std::size_t q = 0; q < names.size(); ++q) {
      if (section_[names[q]]) return static_cast<Quantity>(q);
      all += (q > 0 ? ", " : "") + std::string(names[q]);
    }
    section_.fail("must hold one of " + all);
  }
  void require_things(const Reader& where) {
    switch (claim_.quantity) {
      case Quantity::force:
        return require_bearing(where);
      case Quantity::height:
      case Quantity::speed:
      case Quantity::distance:
        return require_place(where);
      case Quantity::joint:
        return find_joint(where);
      case Quantity::attached:
        return find_attached(where);
      case Quantity::seam:
        return find_seam(where);
      case Quantity::turns:
        return find_axis(where);
      case Quantity::pieces:
        return (void)strip(where);
      case Quantity::wound:
        if (!scene_.strips[strip(where)].winding) where.fail("is no roll");
    }
  }
  void require_bearing(const Reader& where) const {
    const Thing thing = find_thing(claim_.things[0], scene_);
    const bool bears = thing.grip || (thing.body && scene_.bodies[*thing.body].motion != tape::Motion::fixed);
    if (!bears) where.fail(claim_.things[0] + ": no grip, no link and no body that moves is called so");
  }
  void require_place(const Reader& where) const {
    for (const std::string& name : claim_.things) {
      const Thing thing = find_thing(name, scene_);
      if (!thing.body && !thing.strip) where.fail(name + ": no body and no strip (or its tip or root) is called so");
    }
  }
  void find_joint(const Reader& where) {
    std::vector<std::string> names;
    std::vector<std::pair<int, int>> of;
    for (std::size_t r = 0; r < robots_.robots.size(); ++r)
      for (std::size_t k = 0; k < robots_.robots[r].model->joints.size(); ++k) {
        names.push_back(robots_.robots[r].name + ":" + robots_.robots[r].model->joints[k].name);
        of.emplace_back(static_cast<int>(r), static_cast<int>(k));
      }
    std::tie(claim_.robot, claim_.joint) = of[choose(where, claim_.things[0], names)];
  }
  /// @return the strip that comes first
  std::size_t strip(const Reader& where) const { return choose(where, claim_.things[0], names_of(scene_.strips)); }
  void find_attached(const Reader& where) const {
    strip(where);
    std::vector<std::string> others = names_of(scene_.strips);
    for (const tape::Body& body : scene_.bodies) others.push_back(body.name);
    if (claim_.things.size() > 1) choose(where, claim_.things[1], others);
  }
  void find_seam(const Reader& where) {
    strip(where);
    for (const std::size_t side : {1, 2}) choose(where, claim_.things[side], names_of(scene_.bodies));
    if (claim_.things[1] == claim_.things[2]) where.fail("a seam is between two bodies");
    read_direction();
  }
  void find_axis(const Reader& where) {
    strip(where);
    choose(where, claim_.things[1], names_of(scene_.bodies));
    read_direction();
  }
  void read_direction() {
    const Reader along = section_["along"];
    claim_.along = along.vector(kPlace, "");
    if (!(claim_.along.norm() > 0)) along.fail("has no direction");
    claim_.along.normalize();
  }

  const Reader& section_;
  const tape::Scene& scene_;
  const RobotScene& robots_;
  Claim claim_;
};
}  // namespace

std::string to_text(const Claim& c) {
  const auto q = static_cast<std::size_t>(c.quantity);
  std::string things = c.things[0];
  for (std::size_t k = 1; k < c.things.size(); ++k) things += (k + 1 < c.things.size() ? ", " : " and ") + c.things[k];
  const std::string unit = unit_names(Quantity{})[q];
  return std::string(enum_names(Quantity{})[q]) + " of " + things + (c.above ? " above " : " below ") + tape::to_text(c.level) +
         (unit == "1" ? "" : " " + unit);
}

Claim read_claim(const Reader& section, const tape::Scene& scene, const RobotScene& robots) {
  return ClaimReader(section, scene, robots).read();
}

Thing find_thing(const std::string& name, const tape::Scene& scene) {
  Thing found;
  const auto index = [&](const auto& things, const std::string& wanted) -> std::optional<std::size_t> {
    const auto it = std::ranges::find_if(things, [&](const auto& thing) { return thing.name == wanted; });
    if (it == things.end()) return {};
    return static_cast<std::size_t>(it - things.begin());
  };
  const std::size_t dot = name.rfind('.');
  const std::string part = dot == std::string::npos ? "" : name.substr(dot + 1);
  found.grip = index(scene.grips, name);
  found.body = index(scene.bodies, name);
  found.strip = index(scene.strips, part == "tip" || part == "root" ? name.substr(0, dot) : name);
  found.tip = part != "root";
  return found;
}
}  // namespace cosim
