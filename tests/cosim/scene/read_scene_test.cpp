#include "cosim/scene/read_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "tape/math/rotation.hpp"
#include "tape/model/motion.hpp"
#include "tape/model/strip_mesh.hpp"
#include "tape/solver/params.hpp"
using namespace cosim;

namespace {
namespace fs = std::filesystem;
constexpr Real kPi = std::numbers::pi;
const fs::path kScenes = fs::path(TAPE_SOURCE_DIR) / "data" / "scenes";

/// Reads a scene that stands beside the project's own.
tape::Scene read(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const SceneFile file = SceneFile::parse(text, kScenes / "test.yaml", overrides);
  tape::Scene scene = read_worlds(file).tape;
  file.require_all_used();
  return scene;
}
const std::string kStrip = "film: vinyl_19mm\nstrip: {length: 0.1}\n";
}  // namespace

TEST(ReadScene, TheExampleOfTheDesignIsUnderstood) {
  const std::string text = R"(scene: peel_table
film: vinyl_19mm                      # data/tapes/vinyl_19mm.yaml
time: {dt: 0.01, duration: 50}        # s
strip: {length: 0.3, cells_across: 6, cell_length: 3.1667e-3}
bodies: {table: {shape: box, size: [0.4, 0.1, 0.02], motion: static, material: abs}}
script: [{grip: tape.tip, as: pull}, {move: pull, by: [-0.3, 0, 0], speed: 0.006}]
solver: {velocity_tol: 1e-3}
record: {rate: 30, figures: [peel_force]}
)";
  const SceneFile file = SceneFile::parse(text, kScenes / "test.yaml");
  const tape::Scene scene = read_worlds(file).tape;
  tape::NewtonParams newton;
  file.read("solver", newton);
  EXPECT_EQ(newton.velocity_tol, 1e-3);
  EXPECT_EQ(file["record"]["rate"].number(Range::positive(), "1/s"), 30);
  EXPECT_EQ(file["record"]["figures"].texts(), std::vector<std::string>{"peel_force"});
  file.require_all_used();

  EXPECT_EQ(scene.name, "peel_table");
  EXPECT_EQ(scene.time.duration, 50);
  EXPECT_EQ(scene.gravity, Vec3(0, 0, -9.81));
  ASSERT_EQ(scene.strips.size(), 1u);
  EXPECT_EQ(scene.strips[0].name, "tape");
  EXPECT_EQ(scene.strips[0].mesh.length, 0.3);
  ASSERT_EQ(scene.bodies.size(), 1u);
  EXPECT_EQ(scene.bodies[0].motion, tape::Motion::fixed);
  EXPECT_EQ(scene.materials[scene.bodies[0].material].name, "abs");
  ASSERT_EQ(scene.grips.size(), 1u);
  EXPECT_EQ(scene.grips[0].what.vertices.size(), 7u);
  EXPECT_LT((grip_offset(scene.grips[0], 10) - Vec3(-0.06, 0, 0)).norm(), 1e-15);
  EXPECT_LT((grip_offset(scene.grips[0], 60) - Vec3(-0.3, 0, 0)).norm(), 1e-15);
}

TEST(ReadScene, FilmsHoldThePublishedNumbers) {
  const tape::Film vinyl = read(kStrip).films[0];  // the paper, Table I
  EXPECT_EQ(vinyl.width, 0.019);
  EXPECT_EQ(vinyl.thickness, 1.8e-4);
  EXPECT_EQ(vinyl.membrane_modulus, 5e7);
  EXPECT_EQ(vinyl.bending_modulus, 5e7);
  EXPECT_EQ(vinyl.poisson, 0.45);
  EXPECT_EQ(vinyl.dhat, 1.8e-4);
  EXPECT_NEAR(vinyl.width * vinyl.thickness * vinyl.density, 4.446e-3, 1e-15);  // [kg/m]
  const tape::Film packaging = read(kStrip, {"film=packaging_48mm"}).films[0];
  EXPECT_EQ(packaging.width, 0.048);
  EXPECT_EQ(packaging.membrane_modulus, 2.2e9);
}

TEST(ReadScene, AFilmCanBeChangedInTheScene) {
  const std::string text = "film: {from: vinyl_19mm, poisson: 0.3}\nstrip: {length: 0.1}\n";
  EXPECT_EQ(read(text).films[0].poisson, 0.3);
  EXPECT_EQ(read(text).films[0].thickness, 1.8e-4);
  EXPECT_EQ(read(text, {"film.poisson=0"}).films[0].poisson, 0);
}

TEST(ReadScene, PosesPathsAndMotionsArriveInRadians) {
  const tape::Scene scene = read(R"(film: vinyl_19mm
strip: {length: 0.1, position: [1, 2, 3], rotation_deg: {axis: [0, 0, 2], angle: 90}, path: [{line: 0.02}, {arc: 0.03, angle_deg: -45}]}
bodies:
  door:
    shape: cylinder
    radius: 0.1
    height: 0.2
    motion: driven
    rotation_deg: [0, 0, 30]
    waypoints: [{time: 2, rotation_deg: [0, 0, 90]}, {time: 4, position: [1, 0, 0], ease: true}]
  top: {shape: sphere, radius: 0.1, motion: dynamic, mass: 2, velocity: [1, 0, 0], angular_velocity_deg: [0, 0, 360], position: [0, 0, 1]}
)");
  const tape::Strip& strip = scene.strips[0];
  EXPECT_LT((apply(strip.pose, Vec3::UnitX()) - Vec3(1, 3, 3)).norm(), 1e-15);
  ASSERT_EQ(strip.path.size(), 2u);
  EXPECT_EQ(strip.path[0].length, 0.02);
  EXPECT_EQ(strip.path[0].turn, 0);
  EXPECT_NEAR(strip.path[1].length, 0.03 * kPi / 4, 1e-16);
  EXPECT_NEAR(strip.path[1].turn, -kPi / 4, 1e-15);
  const tape::Body& door = scene.bodies[0];
  EXPECT_LT((driven_pose(door, 1).rotation - tape::rotation_exp({0, 0, kPi / 3})).norm(), 1e-14) << "half way from 30 to 90 degrees";
  EXPECT_LT((driven_pose(door, 3).position - Vec3(0.5, 0, 0)).norm(), 1e-14);
  EXPECT_LT((driven_pose(door, 3).rotation - tape::rotation_exp({0, 0, kPi / 2})).norm(), 1e-14) << "a rotation left out stays";
  EXPECT_EQ(scene.bodies[1].mass, 2);
  EXPECT_LT((scene.bodies[1].angular_velocity - Vec3(0, 0, 2 * kPi)).norm(), 1e-14);
}

TEST(ReadScene, AnInterfaceNamesMaterialsOrThings) {
  const std::string text = R"(film: vinyl_19mm
strip: {length: 0.1, material: film}
bodies:
  a: {shape: box, size: [1, 1, 1], material: wood}
  b: {shape: box, size: [1, 1, 1], material: wood, position: [3, 0, 0]}
materials: {wood: {mu: 0.4}, film: {mu: 0.9}}
)";
  const auto mu = [](const tape::Scene& s, int body) { return s.mu(s.strips[0].material, s.bodies[body].material); };
  const tape::Scene plain = read(text);
  EXPECT_NEAR(mu(plain, 0), 0.6, 1e-15);  // sqrt(0.4 0.9)
  const tape::Scene material = read(text + "interfaces: [{between: [film, wood], mu: 0.1}]\n");
  EXPECT_EQ(mu(material, 0), 0.1);
  EXPECT_EQ(mu(material, 1), 0.1);
  const tape::Scene thing = read(text + "interfaces: [{between: [film, wood], mu: 0.1}, {between: [tape, b], mu: 0.2}]\n");
  EXPECT_EQ(mu(thing, 0), 0.1);
  EXPECT_EQ(mu(thing, 1), 0.2);
  const tape::Scene reversed = read(text + "interfaces: [{between: [tape, b], mu: 0.2}, {between: [film, wood], mu: 0.1}]\n");
  EXPECT_EQ(mu(reversed, 0), 0.1);
  EXPECT_EQ(mu(reversed, 1), 0.1) << "the later entry holds for all of the wood";
  const auto kappa = [](const tape::Scene& s, int body) { return s.kappa(s.strips[0].material, s.bodies[body].material); };
  EXPECT_EQ(kappa(plain, 0), tape::ContactParams{}.kappa);
  const tape::Scene stiff = read(text + "interfaces: [{between: [film, wood], kappa: 2e5}, {between: [tape, b], mu: 0.2}]\n");
  EXPECT_EQ(kappa(stiff, 0), 2e5);
  EXPECT_EQ(kappa(stiff, 1), 2e5) << "a thing with a material of its own keeps what was said before";
  EXPECT_EQ(stiff.kappa(stiff.bodies[0].material, stiff.bodies[1].material), tape::ContactParams{}.kappa);
}

TEST(ReadScene, TheScriptRunsInOrderAndBesidesWhereItSaysSo) {
  const tape::Scene scene = read(R"(film: vinyl_19mm
strip: {length: 0.1}
bodies: {ball: {shape: sphere, radius: 0.1, motion: dynamic, position: [0, 0, 1]}}
script:
  - {grip: tape.tip, as: right, stiffness: 100}
  - {grip: tape.root, as: left}
  - {wait: 1}
  - {move: right, by: [0.2, 0, 0], speed: 0.1, wait: false}
  - {move: left, by: [0, 0.3, 0], duration: 3}
  - {release: left}
  - {move: right, by: [0, 0, 0.5], speed: 0.5, at: 6}
  - {grip: {body: ball, point: [0, 0, 0.1]}, as: hook}
  - {grip: ball, to: ball2, as: weld}
  - {grip: tape.rows, rows: [-2, -1], to: ball, as: glue, at: 9}
)",
                                 {"bodies.ball2={shape: sphere, radius: 0.1, position: [0, 0, 2]}"});
  ASSERT_EQ(scene.grips.size(), 5u);
  const tape::Grip &right = scene.grips[0], &left = scene.grips[1], &glue = scene.grips[4];
  EXPECT_EQ(right.stiffness, 100);
  EXPECT_LT((grip_offset(right, 2) - Vec3(0.1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((grip_offset(left, 2) - Vec3(0, 0.1, 0)).norm(), 1e-15) << "at the same time";
  EXPECT_EQ(left.end, 4);
  EXPECT_LT((grip_offset(right, 5) - Vec3(0.2, 0, 0)).norm(), 1e-15);
  EXPECT_LT((grip_offset(right, 6.5) - Vec3(0.2, 0, 0.25)).norm(), 1e-15);
  EXPECT_EQ(scene.grips[2].start, 7) << "after the move that began at 6 s and took 1 s";
  EXPECT_EQ(scene.grips[2].what.points, std::vector<Vec3>{Vec3(0, 0, 0.1)});
  EXPECT_EQ(scene.grips[3].what.points.size(), 8u) << "corners hold position and rotation";
  EXPECT_EQ(glue.start, 9);
  EXPECT_EQ(glue.to, "ball");
  EXPECT_EQ(glue.what.vertices.size(), 14u);
}

TEST(ReadScene, InterfacesSayWhichFacesStickAndHow) {
  const tape::Scene scene = read(kStrip + R"(
bodies:
  table: {shape: box, size: [1, 1, 0.1], position: [0, 0, -1], material: abs}
  other: {shape: box, size: [1, 1, 0.1], position: [0, 0, 1], material: abs}
interfaces:
  - {between: [table, tape.sticky], law: per_pair, cn: 0.675, ct: 0.5, mu: 0.1}
  - {between: [tape.sticky, tape], law: per_pair, beta0: 1}
)");
  const int tape = scene.strips[0].material, table = scene.bodies[0].material, other = scene.bodies[1].material;
  const tape::Adhesion to_table = scene.adhesion(tape, table), from_table = scene.adhesion(table, tape), wound = scene.adhesion(tape, tape);
  EXPECT_EQ(to_table.law, tape::AdhesionLaw::per_pair);
  EXPECT_EQ(to_table.pair.cn, 0.675);
  EXPECT_EQ(to_table.pair.ct, 0.5);
  EXPECT_EQ(scene.mu(tape, table), 0.1);
  EXPECT_EQ(scene.adhesion(tape, other).law, tape::AdhesionLaw::none) << "a name of a thing does not speak for its material";
  for (int body_face : {0, 1}) {
    EXPECT_TRUE(to_table.sticks[1][body_face] && from_table.sticks[body_face][1]);
    EXPECT_FALSE(to_table.sticks[0][body_face] || from_table.sticks[body_face][0]) << "the backing does not stick";
  }
  EXPECT_TRUE(wound.sticks[1][0] && wound.sticks[0][1] && wound.sticks[1][1]);
  EXPECT_FALSE(wound.sticks[0][0]) << "backing to backing";
  EXPECT_EQ(wound.pair.beta0, 1);
}

TEST(ReadScene, RowsAreCountedAlikeOnEveryPattern) {
  for (const char* pattern : {"same", "alternating", "crossed", "irregular"}) {
    const tape::Scene scene =
        read(kStrip + "script: [{grip: tape.rows, rows: [0, 1], as: clamp}]\n", {std::string("strip.pattern=") + pattern});
    EXPECT_EQ(scene.grips[0].what.vertices.size(), std::string(pattern) == "crossed" ? 20u : 14u) << pattern;
  }
}

TEST(ReadScene, OverridesAreCheckedLikeTheFile) {
  EXPECT_EQ(read(kStrip, {"strip.length=0.25", "time.dt=1e-3"}).strips[0].mesh.length, 0.25);
  EXPECT_EQ(read(kStrip, {"time.dt=1e-3"}).time.dt, 1e-3);
  EXPECT_EQ(read(kStrip, {"gravity=[0, 0, 0]"}).gravity, Vec3::Zero());
  EXPECT_EQ(read("film: vinyl_19mm\nstrips: [{length: 0.1}, {length: 0.2, position: [0, 1, 0]}]\n", {"strips.1.length=0.3"})
                .strips[1]
                .mesh.length,
            0.3);
}

TEST(ReadScene, SwitchesAndPlacesAreKnownForThePlan) {
  const SceneFile file = SceneFile::parse("effects:\n  friction: off\n  gravity: on\n", "plan.yaml");
  const auto switches = file.switches("effects", {"friction", "gravity", "barrier"});
  ASSERT_EQ(switches.size(), 2u);
  EXPECT_FALSE(switches.at("friction").on);
  EXPECT_EQ(switches.at("gravity").where, "plan.yaml:3");
  EXPECT_EQ(file.where("effects.friction"), "plan.yaml:2");
  EXPECT_EQ(file.where("effects.barrier"), "");
  file.require_all_used();
}

TEST(ReadScene, MeshFilesAreReadScaledAndJoined) {
  const fs::path folder = fs::path(testing::TempDir()) / "tape_mesh_test";
  fs::create_directories(folder);
  // A tetrahedron with a corner at the origin and edges of 1, 2 and 3 along the axes: volume 1.
  std::ofstream(folder / "t.obj") << "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  std::ofstream stl(folder / "t.stl");
  const Vec3 v[] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  stl << "solid t\n";
  for (const tape::Index3& t : {tape::Index3(0, 2, 1), tape::Index3(0, 1, 3), tape::Index3(0, 3, 2), tape::Index3(1, 2, 3)}) {
    stl << "facet normal 0 0 0\nouter loop\n";
    for (int k : t) stl << "vertex " << v[k].transpose() << "\n";
    stl << "endloop\nendfacet\n";
  }
  stl << "endsolid t\n";
  stl.close();
  std::ofstream(folder / "t.dae") << R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g" name="g"><mesh><source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 2 0 0 0 3</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>
</technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="4">
<input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s" name="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
  for (const auto& [name, unit] : {std::pair{"t.obj", 1.0}, {"t.stl", 1.0}, {"t.dae", 0.01}}) {
    const std::string text = std::string("bodies: {t: {shape: mesh, scale: 0.1, motion: dynamic, file: ") + name + "}}\n";
    const tape::TriangleMesh mesh = read_worlds(SceneFile::parse(text, folder / "scene.yaml")).tape.bodies[0].mesh;
    EXPECT_EQ(mesh.vertices.size(), 4u) << name;
    EXPECT_EQ(mesh.triangles.size(), 4u) << name;
    Vec3 high = Vec3::Zero();
    for (const Vec3& x : mesh.vertices) high = high.cwiseMax(x);
    EXPECT_LT((high - 0.1 * unit * Vec3(1, 2, 3)).norm(), 1e-7 * unit) << name << ": " << high.transpose();
  }
}
