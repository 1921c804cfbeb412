#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "cosim/scene/read_scene.hpp"
#include "tape/core/error.hpp"
using namespace cosim;

namespace {
namespace fs = std::filesystem;
/// What a scene is refused with; empty if it is accepted.
std::string refusal(const std::string& text, const fs::path& path = fs::path(TAPE_SOURCE_DIR) / "data" / "scenes" / "bad.yaml",
                    const std::vector<std::string>& overrides = {}) {
  try {
    const SceneFile file = SceneFile::parse(text, path, overrides);
    read_worlds(file);
    file.require_all_used();
  } catch (const tape::InputError& e) {
    return e.what();
  }
  return "";
}
struct Bad {
  const char* text;  // three good lines stand before it
  const char* where;
  std::vector<const char*> says;
};
const std::string kGood = "film: vinyl_19mm\nstrip: {length: 0.1}\nscene: bad\n";
}  // namespace

TEST(BadScene, IsRefusedByFileLineAndKey) {
  ASSERT_EQ(refusal(kGood), "");
  const Bad cases[] = {
      {"time: {dt: fast}", ":4: ", {"time.dt = fast", "not a number", "(0, 1] s"}},
      {"time: {dt: 3 ms}", ":4: ", {"time.dt = 3 ms", "not a number", "(0, 1] s"}},
      {"time: {dt: -0.01}", ":4: ", {"time.dt = -0.01", "out of range"}},
      {"time: {dt: .nan}", ":4: ", {"time.dt = .nan", "not a number"}},
      {"time: {dt: nan}", ":4: ", {"time.dt = nan", "out of range"}},
      {"time: {dt: 1e999}", ":4: ", {"time.dt = 1e999", "out of range"}},
      {"time: {duration: [1]}", ":4: ", {"time.duration = [1]", "must be a number"}},
      {"time: {dt: 1e-300}", ":4: ", {"time.duration", "steps of time.dt", "at most 1e+09"}},
      {"time: {duration: 1e300}", ":4: ", {"time.duration = 1e300", "steps", "at most 1e+09"}},
      {"time: 3", ":4: ", {"time = 3", "must be a section"}},
      {"time:\n  dt: 0.01\n  dt: 0.02", ":6: ", {"dt", "duplicate key", ":5"}},
      {"time: {dt: 0.01", ":", {"not valid YAML"}},
      {"scene: again", ":4: ", {"scene", "duplicate key", ":3"}},
      {"contact: {dhut: 1e-3}", ":4: ", {"contact.dhut", "unknown key", "did you mean dhat?"}},
      {"gravty: [0, 0, 0]", ":4: ", {"gravty", "unknown key", "did you mean gravity?"}},
      {"zzzzzzzz: 1", ":4: ", {"zzzzzzzz", "unknown key", "allowed: ", "bodies", "interfaces"}},
      {"gravity: [0, 0]", ":4: ", {"gravity", "list of 3 numbers"}},
      {"gravity: -9.81", ":4: ", {"gravity = -9.81", "list of 3 numbers"}},
      {"gravity: [0, 0, down]", ":4: ", {"gravity.2 = down", "not a number"}},
      {"seed: 1.5", ":4: ", {"seed = 1.5", "not a whole number"}},
      {"strips: [{length: 1}]", ":4: ", {"strips", "either strip or strips"}},
      {"exchange: {schedule: posed}\nrobots: {a: {urdf: weight.urdf, base: free}}", ":5: ", {"robots.a.base = free", "posed"}},
      {"bodies: {a: {size: [1, 1, 1]}}", ":4: ", {"bodies.a.shape", "missing"}},
      {"bodies: {a: {shape: box}}", ":4: ", {"bodies.a.size", "missing"}},
      {"bodies: {a: {shape: bax, size: [1, 1, 1]}}", ":4: ", {"bodies.a.shape = bax", "did you mean box", "capsule"}},
      {"bodies: {a: {shape: box, size: [1, 1, 0]}}", ":4: ", {"bodies.a.size.2 = 0", "out of range", "m)"}},
      {"bodies: {a: {shape: box, size: [1, 1, 1], radius: 2}}", ":4: ", {"bodies.a.radius", "unknown key"}},
      {"bodies: {a: {shape: box, size: [1, 1, 1], motion: dynamc}}", ":4: ", {"bodies.a.motion = dynamc", "dynamic"}},
      {"bodies: {a: {shape: ring, inner_radius: 2, outer_radius: 1, height: 1}}", ":4: ", {"bodies.a.inner_radius = 2", "(0, 1)"}},
      {"bodies: {a: {shape: sheet, size: [1, 1], motion: dynamic}}", ":4: ", {"bodies.a", "is open"}},
      {"bodies: {a: {shape: box, size: [1, 1, 1], velocity: [1, 0, 0]}}", ":4: ", {"bodies.a.velocity", "static"}},
      {"bodies: {a: {shape: box, size: [1, 1, 1], motion: dynamic, mass: 1, density: 1}}",
       ":4: ",
       {"bodies.a.mass", "either density or mass"}},
      {"bodies: {a: {shape: box, size: [1, 1, 1], waypoints: [{time: 1}]}}", ":4: ", {"bodies.a.waypoints", "driven"}},
      {"bodies: {a: {shape: box, size: [1, 1, 1], motion: driven, waypoints: [{time: 1}, {time: 1}]}}",
       ":4: ",
       {"waypoints.1.time = 1", "not after"}},
      {"bodies: {a: {shape: box, size: [1, 1, 1], rotation_deg: {axis: [0, 0, 0], angle: 3}}}",
       ":4: ",
       {"rotation_deg.axis", "no direction"}},
      {"bodies: {tape: {shape: box, size: [1, 1, 1]}}", ":4: ", {"bodies.tape", "already"}},
      {"bodies: {a: {shape: mesh, file: none.stl}}", ":4: ", {"bodies.a.file = none.stl", "no such file"}},
      {"bodies: {a: {shape: mesh, file: drape.yaml}}", ":4: ", {"bodies.a.file", "no known mesh format"}},
      {"materials: {wood: {mu: -1}}", ":4: ", {"materials.wood.mu = -1", "out of range"}},
      {"bodies: {a: {shape: box, size: [1, 1, 1], material: wood}}\nmaterials: {wod: {mu: 1}}",
       ":5: ",
       {"materials.wod", "nothing is made of it", "did you mean wood"}},
      {"interfaces: [{between: [tape, tabel], mu: 1}]", ":4: ", {"interfaces.0.between.1 = tabel", "unknown"}},
      {"interfaces: [{between: [tape.sticky, tape], law: per_pair, eta: 0}]",
       ":4: ",
       {"interfaces.0.eta = 0", "debonding has the rate 1/eta", "> 0 s"}},
      {"interfaces: [{between: [tape.sticky, tape], law: per_pair, gamma: 0}]",
       ":4: ",
       {"interfaces.0.gamma = 0", "no pair would ever engage"}},
      {"interfaces: [{between: [tape.sticky, tape], law: per_pear}]", ":4: ", {"interfaces.0.law = per_pear", "did you mean per_pair"}},
      {"interfaces: [{between: [tape.sticky, tape], law: per_pair, cnn: 1}]", ":4: ", {"interfaces.0.cnn", "did you mean cn"}},
      {"interfaces: [{between: [tape.sticky, tape]}]", ":4: ", {"interfaces.0", "none of mu, kappa, law"}},
      {"interfaces: [{between: [default.top, tape], law: per_pair}]", ":4: ", {"interfaces.0.between.0 = default.top", "unknown"}},
      {"bodies: {a: {shape: box, size: [1, 1, 1], material: wood}}\ninterfaces: [{between: [a.sticky, tape], law: per_pair}]",
       ":5: ",
       {"interfaces.0.between.0 = a.sticky", "only strips have a sticky face"}},
      {"bodies: {a: {shape: box, size: [1, 1, 1], material: wood}}\ninterfaces: [{between: [a, wood], law: per_pair}]",
       ":5: ",
       {"interfaces.0.between", "only tape sticks"}},
      {"interfaces: [{between: [tape], mu: 1}]", ":4: ", {"interfaces.0.between", "two names"}},
      {"interfaces: [{between: [tape, tape]}]", ":4: ", {"interfaces.0", "none of mu, kappa, law"}},
      {"script: [{gripp: tape.tip}]", ":4: ", {"script.0", "one of grip, move, phase, release, robot, wait, wait_until"}},
      {"script: [{phase: a}, {phase: a}]", ":4: ", {"script.1.phase = a", "already"}},
      {"script: [{phase: a/b}]", ":4: ", {"script.0.phase = a/b", "letters, digits, _, -"}},
      {"script: [{phase: 1}]", ":4: ", {"script.0.phase = 1", "starts with a letter"}},
      {"script: [{wait: 2}, {phase: a}, {phase: b, at: 1}]", ":4: ", {"script.2.phase = b", "before the phase ahead of it, a"}},
      {"script: [{grip: tape.tipp}]", ":4: ", {"script.0.grip = tape.tipp", "tip, root, rows"}},
      {"script: [{grip: tap.tip}]", ":4: ", {"script.0.grip = tap.tip", "did you mean tape.tip"}},
      {"script: [{grip: tape.rows, rows: [0, 99]}]", ":4: ", {"script.0.rows.1 = 99", "out of range"}},
      {"script: [{grip: tape.tip, as: a}, {move: b, by: [1, 0, 0], speed: 1}]", ":4: ", {"script.1.move = b", "a"}},
      {"script: [{move: b, by: [1, 0, 0], speed: 1}]", ":4: ", {"script.0.move = b", "no grip"}},
      {"script:\n - {grip: tape.tip, as: a}\n - {move: a, by: [1, 0, 0]}", ":6: ", {"script.1", "speed or duration"}},
      {"script:\n - {grip: tape.tip, as: a}\n - {move: a, by: [0, 0, 0], speed: 1}", ":6: ", {"script.1.by", "needs a length"}},
      {"script:\n - {grip: tape.tip, as: a}\n - {release: a, at: 2}\n - {move: a, by: [1, 0, 0], speed: 1}",
       ":7: ",
       {"script.2.move = a", "released at 2 s"}},
      {"script:\n - {grip: tape.tip, as: a}\n - {move: a, by: [1, 0, 0], speed: 1, wait: false}\n - {move: a, by: [1, 0, 0], speed: 1}",
       ":7: ",
       {"script.2.move = a", "before the move"}},
      {"script: [{grip: tape.tip, to: table}]", ":4: ", {"script.0.to = table", "none of its kind"}},
      {"script: [{grip: tape.tip}, {grip: tape.tip}]", ":4: ", {"script.1.grip", "already"}},
      {"a: &x [*x]", ":4: ", {"alias"}},
      {"? {a: 1}\n: 2", ":4: ", {"key must be plain text"}},
      {"---\nb: 1", ":", {"second document"}},
  };
  for (const Bad& bad : cases) {
    const std::string message = refusal(kGood + bad.text);
    EXPECT_NE(message.find(std::string("bad.yaml") + bad.where), std::string::npos) << bad.text << "\n" << message;
    for (const char* words : bad.says)
      EXPECT_NE(message.find(words), std::string::npos) << bad.text << "\nlacks: " << words << "\n" << message;
  }
}

TEST(BadScene, ANameThatIsNoFolderAndASceneOfNothingAreRefused) {
  EXPECT_NE(refusal("film: vinyl_19mm\nstrip: {length: 0.1}\nscene: ../bad\n").find("bad.yaml:3: scene = ../bad: "), std::string::npos);
  EXPECT_NE(refusal("film: vinyl_19mm\n").find("neither a strip nor a body"), std::string::npos);
}

TEST(BadScene, AMistakeInTheStripIsRefused) {
  const std::pair<const char*, const char*> cases[] = {
      {"strip: {length: 0}", "strip.length = 0"},
      {"strip: {length: 0.1, patern: same}", "did you mean pattern?"},
      {"strip: {length: 0.1, pattern: crosed}", "did you mean crossed?"},
      {"strip: {length: 0.1, pattern: crossed, grid_angle: 30}", "strip.grid_angle"},
      {"strip: {length: 0.1, cells_across: 2.5}", "not a whole number"},
      {"strip: {length: 100, cell_length: 1.0e-6}", "cells"},
      {"strip: {length: 0.1, path: [{arc: 0.1}]}", "strip.path.0.angle_deg: missing"},
      {"strip: {length: 0.1, path: [{arc: 0.1, line: 1}]}", "either line"},
      {"strip: {length: 0.1, path: [{arc: -0.1, angle_deg: 3}]}", "strip.path.0.arc = -0.1"},
      {"strip: {length: 0.1, film: vinyl}", "strip.film = vinyl: no such film"},
      {"strip: {length: 0.1, name: a.b}", "neither dots, colons nor spaces"},
      {"strip: [0.1]", "must be a section"},
      {"scene: ..", "scene = ..: names a folder of results"},
      {"physics: {substep: 1.0e-12}", "physics.substep = 1.0e-12"},
      {"bodies: {a: {shape: box, size: [1, 1, 1], cells: [1.5, 1, 1]}}", "cells = [1.5, 1, 1]: are whole numbers"},
      {"bodies: {\"arm:x\": {shape: box, size: [1, 1, 1]}}", "neither dots, colons nor spaces"},
  };
  for (const auto& [text, words] : cases) {
    const std::string message = refusal(std::string("film: vinyl_19mm\n") + text);
    EXPECT_NE(message.find("bad.yaml:2: "), std::string::npos) << text << "\n" << message;
    EXPECT_NE(message.find(words), std::string::npos) << text << "\n" << message;
  }
  EXPECT_NE(refusal("strip: {length: 0.1}").find("film: missing"), std::string::npos);
  const std::string twice = refusal("bodies: {arm: {shape: box, size: [1, 1, 1]}}\nrobots: {arm: {urdf: arm7.urdf}}\n");
  EXPECT_NE(twice.find("robots.arm: there is a thing named arm already"), std::string::npos) << twice;
}

TEST(BadScene, AnOverrideIsRefusedByItsOwnText) {
  const std::pair<const char*, const char*> cases[] = {
      {"strip.length=abc", "--set: strip.length = abc: not a number"},
      {"strip.length", "must be path.to.key=value"},
      {"strip.length=", "has no value"},
      {"strip..length=1", "must be path.to.key=value"},
      {"strip.lengt=1", "did you mean length?"},
      {"scene.name.x=1", "which is no section"},
      {"bodies={a: 1}", "bodies.a = 1: must be a section"},
      {"time.dt={", "not valid YAML"},
      {"=1", "must be path.to.key=value"},
  };
  for (const auto& [text, words] : cases) {
    const std::string message = refusal(kGood, "bad.yaml", {text});
    EXPECT_NE(message.find("--set"), std::string::npos) << text << "\n" << message;
    EXPECT_NE(message.find(words), std::string::npos) << text << "\n" << message;
  }
}

TEST(BadScene, FilesThatAreMissingEmptyOrFoldersAreRefused) {
  const auto load = [](const fs::path& file) -> std::string {
    try {
      SceneFile::load(file);
    } catch (const tape::InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(load("nowhere/none.yaml").find("nowhere/none.yaml: there is no such file"), std::string::npos);
  EXPECT_NE(load(testing::TempDir()).find("is not a file"), std::string::npos);
  const fs::path empty = fs::path(testing::TempDir()) / "empty.yaml";
  std::ofstream(empty) << "# nothing\n";
  EXPECT_NE(load(empty).find("empty.yaml:1: the file is empty"), std::string::npos);
}

TEST(BadScene, AMistakeInAFilmOrAMeshNamesThatFile) {
  const fs::path folder = fs::path(testing::TempDir()) / "tape_bad_scene_test";
  fs::create_directories(folder / "tapes");
  std::ofstream(folder / "tapes" / "thin.yaml") << "width: 0.019\nthickness: -1\n";
  std::ofstream(folder / "tapes" / "odd.yaml")
      << "width: 0.019\nthickness: 1e-4\ndensity: 1\nmembrane_modulus: 1\nbending_modulus: 1\npoisson: 0\nxi: 0\ndhat: 1e-4\ncolour: red\n";
  std::ofstream(folder / "nan.obj") << "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(folder / "flat.obj") << "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n";
  std::ofstream(folder / "fin.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n";
  std::ofstream(folder / "cut.stl") << "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0";
  std::ofstream(folder / "none.obj") << "# nothing\n";
  std::ofstream(folder / "empty.stl") << "";
  const auto message = [&](const std::string& text) { return refusal(text, folder / "scene.yaml"); };
  const auto mesh = [&](const std::string& file) { return message("bodies:\n  a: {shape: mesh, file: " + file + "}\n"); };
  EXPECT_NE(message("film: thin\n").find("thin.yaml:1: density: missing"), std::string::npos) << message("film: thin\n");
  EXPECT_NE(message("film: odd\n").find("odd.yaml:9: colour = red: unknown key"), std::string::npos) << message("film: odd\n");
  EXPECT_NE(mesh("nan.obj").find("scene.yaml:2: bodies.a"), std::string::npos) << mesh("nan.obj");
  EXPECT_NE(mesh("nan.obj").find("not finite"), std::string::npos) << mesh("nan.obj");
  EXPECT_NE(mesh("flat.obj").find("bodies.a (flat.obj): triangle 0 is degenerate"), std::string::npos) << mesh("flat.obj");
  EXPECT_NE(mesh("fin.obj").find("not manifold: 3 triangles"), std::string::npos) << mesh("fin.obj");
  EXPECT_NE(mesh("cut.stl").find("scene.yaml:2: bodies.a.file"), std::string::npos) << mesh("cut.stl");
  EXPECT_NE(mesh("none.obj").find("scene.yaml:2: bodies.a.file"), std::string::npos) << mesh("none.obj");
  EXPECT_NE(mesh("empty.stl").find("empty.stl: the file is empty"), std::string::npos) << mesh("empty.stl");
}
