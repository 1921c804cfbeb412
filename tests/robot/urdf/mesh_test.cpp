#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <cstring>

#include "robot/model/inertia.hpp"
#include "robot/model/primitives.hpp"
#include "robot/urdf/mesh_file.hpp"
#include "robot/urdf/mesh_uri.hpp"
#include "tests/robot/urdf/robot_file.hpp"
using namespace robot;
using namespace robot::test;
using testing::AllOf;
using testing::HasSubstr;

namespace {
const Vec3 kSize(1, 2, 3);  // a box from the origin, so that every axis and side can be told

TriangleMesh box() {
  TriangleMesh mesh = box_shape(kSize).mesh;
  for (Vec3& v : mesh.vertices) v += kSize / 2;
  return mesh;
}

std::string ascii_stl() {
  std::string text = "solid box\n";
  const TriangleMesh mesh = box();
  for (const auto& t : mesh.triangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (int i : t) {
      const Vec3& v = mesh.vertices[i];
      text += "vertex " + std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z()) + "\n";
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid box\n";
}

template <class T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string binary_stl() {
  const TriangleMesh mesh = box();
  std::string bytes = "solid, says the header of many a binary file";
  bytes.resize(80, ' ');
  append(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    bytes.append(12, '\0');
    for (int i : t)
      for (Real c : mesh.vertices[i]) append(bytes, static_cast<float>(c));
    bytes.append(2, '\0');
  }
  return bytes;
}

/// With faces of four corners, and a line.
std::string obj() {
  std::string text = "# box\no box\n";
  for (int k = 0; k < 8; ++k)
    text += "v " + std::to_string(k & 1) + " " + std::to_string(2 * (k >> 1 & 1)) + " " + std::to_string(3 * (k >> 2)) + "\n";
  return text + "l 1 8\nf 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n";
}

std::string coordinates() {
  std::string text;
  for (const Vec3& v : box().vertices)
    for (Real c : v) text += std::to_string(c) + " ";
  return text;
}

std::string dae(const std::string& asset, const std::string& placement = "") {
  std::string indices;
  for (const auto& t : box().triangles)
    for (int i : t) indices += std::to_string(i) + " ";
  return R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>)" +
         asset + R"(</asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="f" count="24">)" +
         coordinates() + R"(</float_array><technique_common><accessor source="#f" count="8" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="12"><input semantic="VERTEX" source="#v" offset="0"/><p>)" +
         indices + R"(</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n">)" +
         placement + R"(<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

std::string base64(const std::string& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[word >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string gltf_buffer() {
  std::string bytes;
  for (const Vec3& v : box().vertices)
    for (Real c : v) append(bytes, static_cast<float>(c));
  for (const auto& t : box().triangles)
    for (int i : t) append(bytes, static_cast<std::uint16_t>(i));
  return bytes;
}

/// @param uri  of the buffer; empty in a binary file
std::string gltf(const std::string& uri) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3","min":[0,0,0],"max":[1,2,3]},
{"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":72}],
"buffers":[{"byteLength":168)" +
         (uri.empty() ? "" : ",\"uri\":\"" + uri + "\"") + "}]}";
}

std::string glb() {
  std::string json = gltf(""), bytes;
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::string buffer = gltf_buffer();
  bytes = "glTF";
  append(bytes, std::uint32_t{2});
  append(bytes, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + buffer.size()));
  append(bytes, static_cast<std::uint32_t>(json.size()));
  bytes += "JSON" + json;
  append(bytes, static_cast<std::uint32_t>(buffer.size()));
  bytes += std::string("BIN\0", 4) + buffer;
  return bytes;
}

/// A closed box between two corners that faces outward.
void expect_box(const TriangleMesh& mesh, const Vec3& low, const Vec3& high, const std::string& what) {
  Eigen::AlignedBox3d bounds;
  for (const Vec3& v : mesh.vertices) bounds.extend(v);
  EXPECT_LT((bounds.min() - low).norm() + (bounds.max() - high).norm(), 1e-6) << what << ": " << bounds.min() << ", " << bounds.max();
  EXPECT_EQ(mesh.vertices.size(), 8u) << what;
  EXPECT_EQ(mesh.triangles.size(), 12u) << what;
  EXPECT_NEAR(solid(mesh, 1).mass, (high - low).prod(), 1e-5) << what;
}

const Vec3 kZero = Vec3::Zero();
}  // namespace

TEST(MeshFile, EveryFormatGivesTheSameBox) {
  const Folder folder;
  expect_box(read_mesh(folder.write("a.stl", ascii_stl())), kZero, kSize, "ASCII STL");
  expect_box(read_mesh(folder.write("b.STL", binary_stl())), kZero, kSize, "binary STL");
  expect_box(read_mesh(folder.write("c.obj", obj())), kZero, kSize, "OBJ");
  expect_box(read_mesh(folder.write("d.dae", dae(""))), kZero, kSize, "COLLADA");
}

TEST(MeshFile, GltfIsTurnedFromYUpToZUp) {
  const Folder folder;  // (x, y, z) -> (x, -z, y)
  const std::string data = "data:application/octet-stream;base64," + base64(gltf_buffer());
  expect_box(read_mesh(folder.write("e.gltf", gltf(data))), {0, -3, 0}, {1, 0, 2}, "glTF");
  expect_box(read_mesh(folder.write("f.glb", glb())), {0, -3, 0}, {1, 0, 2}, "binary glTF");
}

TEST(MeshFile, ColladaHasItsUnitAndPlacementAndKeepsItsAxesUnlessAskedOtherwise) {
  const Folder folder;
  const std::string millimetres = R"(<unit name="mm" meter="0.001"/>)", y_up = "<up_axis>Y_UP</up_axis>", z_up = "<up_axis>Z_UP</up_axis>";
  expect_box(read_mesh(folder.write("mm.dae", dae(millimetres + z_up))), kZero, kSize / 1000, "mm");
  expect_box(read_mesh(folder.write("z.dae", dae(z_up))), kZero, kSize, "Z_UP");
  expect_box(read_mesh(folder.write("y.dae", dae(y_up))), kZero, kSize, "Y_UP");
  expect_box(read_mesh(folder.write("z.dae", dae(z_up)), Vec3::Ones(), true), kZero, kSize, "Z_UP, honoured");
  expect_box(read_mesh(folder.write("y.dae", dae(millimetres + y_up)), Vec3::Ones(), true), Vec3(0, -3, 0) / 1000, Vec3(1, 0, 2) / 1000,
             "Y_UP, honoured");
  expect_box(read_mesh(folder.write("t.dae", dae(z_up, "<translate>10 20 30</translate>"))), {10, 20, 30}, {11, 22, 33}, "placed");
}

TEST(MeshFile, IsScaledAndAMirroredOneStillFacesOutward) {
  const Folder folder;
  const fs::path stl = folder.write("a.stl", ascii_stl());
  expect_box(read_mesh(stl, {0.5, 0.1, 0.01}), kZero, {0.5, 0.2, 0.03}, "scaled");
  expect_box(read_mesh(stl, {1, -1, 1}), {0, -2, 0}, {1, 0, 3}, "mirrored");
}

TEST(MeshFile, WhatIsNoMeshIsRefusedByName) {
  const Folder folder;
  for (const fs::path& file : {folder.write("empty.stl", ""), folder.write("text.dae", "no COLLADA"), folder.write("a.xyz", "1 2 3"),
                               folder.write("points.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n")}) {
    try {
      read_mesh(file);
      ADD_FAILURE() << "accepted " << file;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr(file.string()));
    }
  }
}

TEST(MeshUri, IsFoundWhereItCanBeMeant) {
  const Folder folder;
  const fs::path urdf = folder.path() / "ws" / "my_robot" / "urdf" / "r.urdf";
  const fs::path mesh = folder.write("ws/my_robot/meshes/a b.stl", "x"), other = folder.write("ws/other/meshes/c.stl", "x");
  const fs::path beside = folder.write("ws/my_robot/urdf/d.stl", "x");
  const auto find = [&](const std::string& uri, const fs::path& root = {}) {
    return fs::weakly_canonical(find_mesh(uri, urdf, root, "l"));
  };
  EXPECT_EQ(find("package://my_robot/meshes/a b.stl"), mesh);            // the folder above has the name
  EXPECT_EQ(find("package://other/meshes/c.stl"), other);                // a package next to it
  EXPECT_EQ(find("package://My Robot V3.1_URDF/meshes/a b.stl"), mesh);  // no folder has the name
  EXPECT_EQ(find("package://my_robot/meshes/a%20b.stl"), mesh);          // as in an address
  EXPECT_EQ(find("model://my_robot/meshes/a b.stl"), mesh);
  EXPECT_EQ(find("package://my_robot//meshes//a b.stl"), mesh);
  EXPECT_EQ(find("d.stl"), beside);
  EXPECT_EQ(find("../meshes/a b.stl"), mesh);
  EXPECT_EQ(find("..\\meshes\\a b.stl"), mesh);
  EXPECT_EQ(find("meshes/a b.stl"), mesh);  // relative to the package
  EXPECT_EQ(find("file://" + mesh.string()), mesh);
  EXPECT_EQ(find(mesh.string()), mesh);
}

TEST(MeshUri, AFolderOfThePackagesNameComesBeforeOthersThatHaveTheFile) {
  const Folder folder;
  const fs::path named = folder.write("ws/pkg/meshes/a.stl", "x");
  folder.write("ws/pkg/sub/meshes/a.stl", "x");
  EXPECT_EQ(find_mesh("package://pkg/meshes/a.stl", folder.path() / "ws" / "pkg" / "sub" / "r.urdf", {}, "l"), named);
}

TEST(MeshUri, ThePackageRootComesFirst) {
  const Folder folder;
  const fs::path urdf = folder.path() / "p" / "r.urdf";
  const fs::path near = folder.write("p/m.stl", "x"), packages = folder.write("root/p/m.stl", "x"),
                 package = folder.write("root/m.stl", "x");
  EXPECT_EQ(find_mesh("package://p/m.stl", urdf, {}, "l"), near);
  EXPECT_EQ(find_mesh("package://p/m.stl", urdf, folder.path() / "root", "l"), packages);
  EXPECT_EQ(find_mesh("package://q/m.stl", urdf, folder.path() / "root", "l"), package);
}

TEST(MeshUri, AMissingMeshIsNamedWithLinkAddressAndPlaces) {
  const std::string mesh = R"(<visual><geometry><mesh filename="package://p q/meshes/none.stl"/></geometry></visual>)";
  EXPECT_THAT(refusal(link_text("palm", mesh)),
              AllOf(HasSubstr("/r.urdf: link 'palm': there is no mesh package://p q/meshes/none.stl; looked for\n"),
                    HasSubstr("/p q/meshes/none.stl\n"), HasSubstr("\n  /meshes/none.stl")));
  EXPECT_THAT(refusal(link_text("palm", R"(<collision><geometry><mesh filename="file:///none.stl"/></geometry></collision>)")),
              HasSubstr("there is no mesh file:///none.stl; looked for\n  /none.stl"));
}

TEST(MeshUri, AMeshOfARobotComesWithScaleFileAndPlace) {
  const Folder folder;
  const fs::path mesh = folder.write("My Robot/meshes/a b.stl", ascii_stl());
  const std::string shape =
      R"(<origin xyz="1 0 0"/><geometry><mesh filename="package://Other Name/meshes/a b.stl" scale="0.1 0.1 -0.1"/></geometry>)";
  const fs::path urdf = folder.write("My Robot/urdf/My Robot.urdf",
                                     robot_text(link_text("a", "<visual>" + shape + "</visual><collision>" + shape + "</collision>")));
  const RobotModel model = read_urdf(urdf);
  const Shape& s = model.links[0].collision.at(0);
  EXPECT_EQ(s.kind, Shape::Kind::mesh);
  EXPECT_EQ(fs::path(s.file), mesh);
  EXPECT_EQ(s.X_LS.translation(), Vec3(1, 0, 0));
  expect_box(s.mesh, Vec3(0, 0, -0.3), Vec3(0.1, 0.2, 0), "scaled");
  EXPECT_EQ(model.links[0].visual.at(0).mesh.vertices, s.mesh.vertices);
}
