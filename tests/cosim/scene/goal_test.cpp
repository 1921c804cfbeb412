#include "cosim/scene/goal.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "cosim/scene/read_scene.hpp"
#include "tape/core/error.hpp"
using namespace cosim;

namespace {
const std::string kScene = R"(film: vinyl_19mm
time: {dt: 0.01, duration: 2}
strip: {length: 0.1, position: [0, 0, 0.5]}
robots: {carton: {urdf: carton.urdf}}
script: [{grip: tape.tip, as: pull}]
)";
std::vector<Goal> read(const std::string& conditions) {
  const SceneFile file =
      SceneFile::parse(kScene + "conditions:\n" + conditions, std::filesystem::path(TAPE_SOURCE_DIR) / "data" / "scenes" / "goals.yaml");
  std::vector<Goal> goals = read_worlds(file).goals;
  file.require_all_used();
  return goals;
}
/// What a condition is refused with; empty if it is accepted.
std::string refusal(const std::string& condition) {
  try {
    read("  - {" + condition + "}\n");
  } catch (const tape::InputError& e) {
    return e.what();
  }
  return "";
}
}  // namespace

TEST(Goals, AreReadWithWhatTheyAreAbout) {
  const std::vector<Goal> goals = read(R"(  - {name: right, joint: "carton:hinge_right", above: 1.4, held: 1}
  - {name: stuck, attached: tape, above: 0.5}
  - {name: on_flap, attached: [tape, "carton:flap_left"], above: 0.25}
  - {name: sealed, seam: [tape, "carton:flap_left", "carton:flap_right"], along: [0, 2, 0], above: 0.08}
  - {name: whole, pieces: tape, below: 2}
  - {name: gentle, force: pull, below: 3}
  - {name: far, distance: [tape.tip, "carton:base"], above: 0.1}
)");
  ASSERT_EQ(goals.size(), 7u);
  EXPECT_EQ(goals[0].name, "right");
  EXPECT_EQ(goals[0].held, 1);
  EXPECT_EQ(to_text(goals[0].claim), "joint of carton:hinge_right above 1.4 rad or m");
  EXPECT_EQ(goals[0].claim.robot, 0);
  EXPECT_EQ(goals[0].claim.joint, 2) << "the file has back and front before it";
  EXPECT_EQ(goals[1].held, 0);
  EXPECT_EQ(to_text(goals[2].claim), "attached of tape and carton:flap_left above 0.25");
  EXPECT_EQ(goals[3].claim.along, Vec3::UnitY());
  EXPECT_EQ(to_text(goals[3].claim), "seam of tape, carton:flap_left and carton:flap_right above 0.08 m");
  EXPECT_FALSE(goals[4].claim.above);
}
TEST(Goals, AreRefusedByFileLineKeyAndWhatIsAllowed) {
  const struct {
    const char* condition;
    std::vector<const char*> says;
  } cases[] = {
      {"joint: \"carton:hinge_right\", above: 1", {"conditions.0.name", "missing"}},
      {"name: a, above: 1", {"conditions.0", "one of force, height, speed, distance, joint, attached, seam, pieces, wound, turns"}},
      {"name: a, joint: \"carton:hinge\", above: 1",
       {"conditions.0.joint = carton:hinge", "allowed: carton:hinge_back, carton:hinge_front"}},
      {"name: a, joint: [x, y], above: 1", {"conditions.0.joint", "names 2 things (allowed: 1)"}},
      {"name: a, attached: tap, above: 0.5", {"conditions.0.attached = tap", "did you mean tape?"}},
      {"name: a, attached: [tape, flap], above: 0.5", {"conditions.0.attached", "flap_back"}},
      {"name: a, attached: tape, above: 1.5", {"conditions.0.above = 1.5", "[0, 1]"}},
      {"name: a, attached: [tape, tape, tape], above: 0.5", {"names 3 things (allowed: 1 or 2)"}},
      {"name: a, seam: [tape, \"carton:flap_left\"], along: [0, 1, 0], above: 0.1", {"names 2 things (allowed: 3)"}},
      {"name: a, seam: [tape, \"carton:base\", \"carton:base\"], along: [0, 1, 0], above: 0.1", {"between two bodies"}},
      {"name: a, seam: [tape, \"carton:base\", \"carton:flap_left\"], above: 0.1", {"conditions.0.along", "missing"}},
      {"name: a, seam: [tape, \"carton:base\", \"carton:flap_left\"], along: [0, 0, 0], above: 0.1", {"along", "no direction"}},
      {"name: a, seam: [tape, \"carton:base\", \"carton:flap_left\"], along: [0, 1, 0], above: -1", {"above = -1", ">= 0 m"}},
      {"name: a, pieces: tape.tip, above: 1", {"conditions.0.pieces = tape.tip", "allowed: tape"}},
      {"name: a, wound: tape, above: 0.1", {"conditions.0.wound = tape", "is no roll"}},
      {"name: a, height: tape.tip, above: 0.1, below: 1", {"either above or below"}},
      {"name: a, height: tape.tip, above: high", {"conditions.0.above = high", "not a number"}},
      {"name: a, height: tape.tip, above: nan", {"conditions.0.above = nan", "out of range"}},
      {"name: a, height: tape.tip, above: 0.1, held: 2.5", {"conditions.0.held = 2.5", "[0, 2] s"}},
      {"name: a, height: tape.tip, above: 0.1, hold: 1", {"conditions.0.hold", "unknown key", "held"}},
      {"name: a, height: tape.tip, above: 0.1, along: [0, 1, 0]", {"conditions.0.along", "unknown key"}},
  };
  EXPECT_EQ(refusal("name: a, height: tape.tip, above: 0.1"), "");
  for (const auto& bad : cases) {
    const std::string message = refusal(bad.condition);
    EXPECT_NE(message.find("goals.yaml:7: "), std::string::npos) << bad.condition << "\n" << message;
    for (const char* text : bad.says) EXPECT_NE(message.find(text), std::string::npos) << bad.condition << "\n" << message;
  }
}
TEST(Goals, HaveNamesOfTheirOwn) {
  const std::string twice = "name: a, height: tape.tip, above: 0.1}\n  - {name: a, height: tape.root, above: 0.1";
  EXPECT_NE(refusal(twice).find("goals.yaml:8: conditions.1.name = a: there is a condition of this name already"), std::string::npos)
      << refusal(twice);
}
TEST(Goals, WhatTheyAreAboutCanBeWaitedFor) {
  const SceneFile file = SceneFile::parse(
      "film: vinyl_19mm\nstrip: {length: 0.1, position: [0, 0, 0.5]}\n"
      "robots: {carton: {urdf: carton.urdf}}\n"
      "script: [{wait_until: {joint: \"carton:hinge_left\", above: 1.4}, timeout: 2}]\n",
      std::filesystem::path(TAPE_SOURCE_DIR) / "data" / "scenes" / "goals.yaml");
  const BothWorlds both = read_worlds(file);
  ASSERT_EQ(both.events.size(), 1u);
  EXPECT_EQ(both.events[0].claim.joint, 3);
}
