#include "cosim/scene/mesh_file.hpp"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cstring>

#include "cosim/scene/scene_file.hpp"
#include "robot/urdf/isolated.hpp"
#include "tape/core/error.hpp"

namespace cosim {
namespace {
using tape::InputError;
using tape::TriangleMesh;

/// Corners of all triangles, nine floats each, as the importer gives them; on failure 'E' and its message.
std::string import_triangles(const std::string& bytes, const std::string& format) {
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene =
      importer.ReadFileFromMemory(bytes.data(), bytes.size(), aiProcess_Triangulate | aiProcess_PreTransformVertices, format.c_str());
  if (!scene) return std::string("E") + importer.GetErrorString();
  std::string corners = "T";
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& part = *scene->mMeshes[m];
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      for (unsigned k = 0; k < face.mNumIndices && face.mNumIndices == 3; ++k) {
        if (face.mIndices[k] >= part.mNumVertices) return "Ea face names a vertex that does not exist";
        const aiVector3D& v = part.mVertices[face.mIndices[k]];
        const float x[3] = {v.x, v.y, v.z};
        corners.append(reinterpret_cast<const char*>(x), sizeof x);
      }
    }
  }
  return corners;
}
}  // namespace

TriangleMesh parse_mesh(const std::string& bytes, const std::string& extension, double scale, const std::string& asked_by) {
  std::string format = extension;
  std::transform(format.begin(), format.end(), format.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (format != "stl" && format != "obj" && format != "dae")
    throw InputError(asked_by + ": ." + extension + " is no known mesh format (allowed: stl, obj, dae)");
  if (bytes.empty()) throw InputError(asked_by + ": the file is empty");
  const std::size_t megabytes = 200 + bytes.size() / 25'000;  // the importer takes some ten times the size of the file
  const auto corners = robot::run_isolated([&] { return import_triangles(bytes, format); }, 60, megabytes);
  if (!corners) throw InputError(asked_by + ": not a valid " + format + " file: the importer breaks down on it");
  if (corners->starts_with('E')) throw InputError(asked_by + ": not a valid " + format + " file: " + corners->substr(1));
  if (corners->size() == 1) throw InputError(asked_by + ": has no triangles");
  TriangleMesh mesh;
  for (std::size_t at = 1; at < corners->size(); at += 3 * sizeof(float)) {
    float x[3];
    std::memcpy(x, corners->data() + at, sizeof x);
    const int v = static_cast<int>(mesh.vertices.size());
    mesh.vertices.push_back(scale * tape::Vec3(x[0], x[1], x[2]));
    if (!mesh.vertices.back().allFinite())
      throw InputError(asked_by + ": triangle " + std::to_string(v / 3) + " has a corner that is not finite");
    if (v % 3 == 2) mesh.triangles.push_back({v - 2, v - 1, v});
  }
  return tape::merge_vertices(mesh);
}

TriangleMesh load_mesh(const std::filesystem::path& file, double scale, const std::string& asked_by) {
  const std::string extension = file.extension().string(), name = asked_by + " = " + file.string();
  return parse_mesh(read_whole_file(file, name), extension.empty() ? "" : extension.substr(1), scale, name);
}
}  // namespace cosim
