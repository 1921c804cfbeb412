#include "robot/urdf/mesh_file.hpp"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cstring>

#include "robot/urdf/isolated.hpp"

namespace robot {
namespace {
std::string extension(const std::filesystem::path& file) {
  std::string text = file.extension().string();
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// @return false: a face names a vertex that does not exist
bool add(const aiMesh& part, const Mat3& to_link, TriangleMesh& mesh) {
  const int first = static_cast<int>(mesh.vertices.size());
  const bool turn_over = to_link.determinant() < 0;
  for (unsigned v = 0; v < part.mNumVertices; ++v) {
    const aiVector3D& p = part.mVertices[v];
    mesh.vertices.push_back(to_link * Vec3(p.x, p.y, p.z));
  }
  for (unsigned f = 0; f < part.mNumFaces; ++f) {
    const aiFace& face = part.mFaces[f];
    std::array<int, 3> t{};
    for (unsigned k = 0; k < 3; ++k) {
      if (face.mNumIndices != 3 || face.mIndices[k] >= part.mNumVertices) return false;
      t[k] = first + static_cast<int>(face.mIndices[k]);
    }
    if (turn_over) std::swap(t[1], t[2]);
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.triangles.push_back(t);
  }
  return true;
}
/// A mesh, or why there is none.
struct Imported {
  TriangleMesh mesh;
  std::string refusal = {};
};
Imported import_mesh(const std::filesystem::path& file, const Vec3& scale, bool honour_up_axis) {
  const std::string kind = extension(file);
  const bool gltf = kind == ".gltf" || kind == ".glb", collada = kind == ".dae" || kind == ".zae";
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, honour_up_axis ? 0 : 1);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
                                                          aiComponent_TEXCOORDS | aiComponent_MATERIALS | aiComponent_BONEWEIGHTS);
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_RemoveComponent |
                                                              aiProcess_PreTransformVertices | aiProcess_JoinIdenticalVertices);
  if (!scene) return {{}, std::string("cannot be read as a mesh: ") + importer.GetErrorString()};

  Mat3 up = Mat3::Identity();  // assimp turns COLLADA files to y-up, unless it is told not to
  if (gltf || (collada && honour_up_axis)) up << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  Imported out;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m)
    if (!add(*scene->mMeshes[m], scale.asDiagonal() * up, out.mesh)) return {{}, "a face of the mesh names a vertex that does not exist"};
  if (out.mesh.triangles.empty()) return {{}, "the mesh has no triangle"};
  for (const Vec3& v : out.mesh.vertices)
    if (!v.allFinite()) return {{}, "a vertex of the mesh is not finite"};
  return out;
}

/// As bytes that go from one process to the other: number of vertices and these, triangles; or a refusal.
std::string packed(const Imported& from) {
  if (!from.refusal.empty()) return 'E' + from.refusal;
  const auto append = [](std::string& to, const auto* data, std::size_t count) {
    to.append(reinterpret_cast<const char*>(data), count * sizeof *data);
  };
  const std::size_t vertices = from.mesh.vertices.size();
  std::string bytes = "M";
  append(bytes, &vertices, 1);
  for (const Vec3& v : from.mesh.vertices) append(bytes, v.data(), 3);
  for (const auto& t : from.mesh.triangles) append(bytes, t.data(), 3);
  return bytes;
}
TriangleMesh unpacked(const std::string& bytes, const std::string& name) {
  if (bytes[0] == 'E') throw InputError(name + ": " + bytes.substr(1));
  const char* at = bytes.data() + 1;
  const auto take = [&](auto* to, std::size_t count) {
    std::memcpy(to, at, count * sizeof *to);
    at += count * sizeof *to;
  };
  std::size_t vertices = 0;
  take(&vertices, 1);
  TriangleMesh mesh;
  mesh.vertices.resize(vertices);
  for (Vec3& v : mesh.vertices) take(v.data(), 3);
  mesh.triangles.resize(static_cast<std::size_t>(bytes.data() + bytes.size() - at) / sizeof(mesh.triangles[0]));
  for (auto& t : mesh.triangles) take(t.data(), 3);
  return mesh;
}
}  // namespace

TriangleMesh read_mesh(const std::filesystem::path& file, const Vec3& scale, bool honour_up_axis) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  const std::size_t megabytes = 200 + (error ? 0 : size / 25'000);  // the importer takes some ten times the size of the file
  const auto bytes = run_isolated([&] { return packed(import_mesh(file, scale, honour_up_axis)); }, 60, megabytes);
  if (!bytes) throw InputError(file.string() + ": cannot be read as a mesh: the importer breaks down on it");
  return unpacked(*bytes, file.string());
}
}  // namespace robot
