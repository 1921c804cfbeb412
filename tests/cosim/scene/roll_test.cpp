#include "cosim/scene/roll.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "cosim/scene/read_scene.hpp"
#include "tape/core/error.hpp"
using namespace cosim;

namespace {
const std::filesystem::path kScene = std::filesystem::path(TAPE_SOURCE_DIR) / "data" / "scenes" / "wound.yaml";
tape::Scene read(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const SceneFile file = SceneFile::parse(text, kScene, overrides);
  tape::Scene scene = read_worlds(file).tape;
  file.require_all_used();
  return scene;
}
std::string refusal(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    read(text, overrides);
  } catch (const tape::InputError& e) {
    return e.what();
  }
  return "";
}
const std::string kRoll = "film: vinyl_19mm\nroll: {turns: 32, free_length: 0.3}\n";
}  // namespace

TEST(RollSection, MakesAStripNamedTapeAndADynamicBodyNamedHub) {
  const tape::Scene scene = read(kRoll);
  ASSERT_EQ(scene.strips.size(), 1u);
  ASSERT_EQ(scene.bodies.size(), 1u);
  const tape::Strip& tape = scene.strips[0];
  EXPECT_EQ(tape.name, "tape");
  ASSERT_TRUE(tape.winding);
  EXPECT_EQ(tape.winding->turns, 32);
  EXPECT_EQ(tape.winding->pitch, 1.8e-4);
  EXPECT_EQ(tape.mesh.length, tape.winding->wound() + 0.3);
  EXPECT_EQ(scene.bodies[0].name, "hub");
  EXPECT_EQ(scene.bodies[0].motion, tape::Motion::dynamic);
  EXPECT_EQ(scene.bodies[0].density, 950);
  EXPECT_EQ(scene.bodies[0].mesh.vertices.size(), 4u * 96u);
}

TEST(RollSection, TakesPoseCoreAndTheSettingsOfItsStrip) {
  const tape::Scene scene = read(R"(film: vinyl_19mm
roll:
  turns: 2
  sense: right
  pitch: 2.0e-4
  position: [1, 2, 3]
  rotation_deg: [0, -90, 0]
  core: {outer_diameter: 0.05, height: 0.03, density: 1000, sides: 48, material: paper}
strip: {cells_across: 4, cell_length: 0.002, name: wound, material: vinyl}
bodies: {table: {shape: box, size: [1, 1, 0.1]}}
interfaces: [{between: [wound, hub], mu: 0.7}]
script: [{grip: wound.tip, as: up}, {grip: hub, as: axle}]
)");
  const tape::Strip& tape = scene.strips[0];
  EXPECT_EQ(tape.winding->pitch, 2e-4);
  EXPECT_NEAR(tape.winding->radius, 0.025 + 2e-4 - 4.5e-5, 1e-16);
  EXPECT_EQ(tape.mesh.cells_across, 4);
  EXPECT_EQ(tape.mesh.cell_length, 0.002);
  EXPECT_EQ(scene.materials[tape.material].name, "vinyl");
  EXPECT_EQ(scene.materials[scene.bodies[0].material].name, "paper");
  EXPECT_EQ(scene.mu(tape.material, scene.bodies[0].material), 0.7);
  EXPECT_EQ(scene.bodies[tape.winding->hub].name, "hub");
  EXPECT_EQ(scene.bodies[1].name, "table");
  EXPECT_EQ(scene.bodies[0].mesh.vertices.size(), 4u * 48u);
  EXPECT_LT((apply(tape.pose, Vec3::UnitX()) - Vec3(1, 2, 4)).norm(), 1e-15) << "the free end points up";
  EXPECT_LT((apply(scene.bodies[0].pose, Vec3::UnitZ()) - Vec3(1, 3, 3)).norm(), 1e-15) << "the axis is y";
  EXPECT_EQ(scene.grips[0].what.vertices.size(), 5u);
}

TEST(RollSection, SettingsComeFromOutside) {
  const tape::Scene scene = read(kRoll, {"roll.turns=8", "strip.cells_across=3", "strip.cell_length=0.0015", "roll.sense=right"});
  EXPECT_EQ(scene.strips[0].winding->turns, 8);
  EXPECT_EQ(scene.strips[0].mesh.cells_across, 3);
  EXPECT_EQ(scene.strips[0].mesh.cell_length, 0.0015);
}

TEST(RollSection, OtherStripsMayStandBesideIt) {
  const tape::Scene scene = read(kRoll + "strips: [{length: 0.1, position: [0, 1, 0]}]\n");
  ASSERT_EQ(scene.strips.size(), 2u);
  EXPECT_TRUE(scene.strips[0].winding);
  EXPECT_EQ(scene.strips[1].name, "tape2");
  EXPECT_FALSE(scene.strips[1].winding);
}

TEST(RollSection, MistakesAreRefusedByFileLineAndKey) {
  EXPECT_EQ(refusal(kRoll), "");
  const std::pair<const char*, const char*> overridden[] = {
      {"roll.turns=0", "--set: roll.turns = 0: out of range (allowed: (0, 1000])"},
      {"roll.turns=many", "--set: roll.turns = many: not a number"},
      {"roll.trns=3", "--set: roll.trns = 3: unknown key; did you mean turns?"},
      {"roll.length=3", "roll.length = 3: unknown key"},
      {"roll.sense=up", "roll.sense = up: unknown (allowed: left, right)"},
      {"roll.free_length=-1", "roll.free_length = -1: out of range"},
      {"roll.core=3", "roll.core = 3: must be a section"},
      {"roll.core.sides=2", "roll.core.sides = 2: out of range"},
      {"roll.core.bore=2", "roll.core.bore = 2: unknown key"},
      {"roll.position=[0, 0]", "roll.position = [0, 0]: must be a list of 3 numbers"},
      {"roll=3", "roll = 3: must be a section"},
      {"strip.length=3", "--set: strip.length = 3: follows from roll.turns and roll.free_length"},
      {"strip.position=[0, 0, 1]", "strip.position = [0, 0, 1]: the strip of a roll is where the roll is"},
      {"strip.path=[{line: 1}]", "strip.path = [a section]: the strip of a roll is where the roll is"},
      {"strip.name=hub", "wound.yaml:2: roll: there is a thing named hub already"},
      {"bodies={hub: {shape: sphere, radius: 1}}", "bodies.hub: there is a thing named hub already"},
      {"roll.core.inner_diameter=0.05", "wound.yaml:2: roll: roll.core.inner_diameter = 0.05 m: the core has no wall"},
      {"roll.pitch=9e-5", "wound.yaml:2: roll: roll.pitch = 9e-05 m: the layers touch (allowed: > 9e-05 m"},
      {"strip.cell_length=1e-6", "wound.yaml:2: roll: strip: "},
      {"roll.turns=900", " x 6 cells (allowed: 5e+05 together); strip.length"},
      {"film=~", "film: missing"},
  };
  for (const auto& [change, words] : overridden) {
    const std::string message = refusal(kRoll, {change});
    EXPECT_NE(message.find(words), std::string::npos) << change << "\nlacks: " << words << "\n" << message;
  }
  EXPECT_NE(refusal(kRoll + "strip: {length: 0.3}\n").find("wound.yaml:3: strip.length = 0.3: follows"), std::string::npos);
}
