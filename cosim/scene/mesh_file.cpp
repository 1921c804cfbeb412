#include "cosim/scene/mesh_file.hpp"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>

#include "cosim/scene/scene_file.hpp"
#include "tape/core/error.hpp"

namespace cosim {
namespace {
using tape::InputError;
using tape::TriangleMesh;

void append(const aiMesh& part, double scale, const std::string& asked_by, TriangleMesh& mesh) {
  const int first = static_cast<int>(mesh.vertices.size());
  for (unsigned v = 0; v < part.mNumVertices; ++v) {
    const tape::Vec3 x(part.mVertices[v].x, part.mVertices[v].y, part.mVertices[v].z);
    if (!x.allFinite()) throw InputError(asked_by + ": vertex " + std::to_string(mesh.vertices.size()) + " is not finite");
    mesh.vertices.push_back(scale * x);
  }
  for (unsigned f = 0; f < part.mNumFaces; ++f) {
    const aiFace& face = part.mFaces[f];
    if (face.mNumIndices != 3) continue;
    tape::Index3 t;
    for (unsigned k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= part.mNumVertices)
        throw InputError(asked_by + ": triangle " + std::to_string(mesh.triangles.size()) + " names a vertex that does not exist");
      t[k] = first + static_cast<int>(face.mIndices[k]);
    }
    mesh.triangles.push_back(t);
  }
}
}  // namespace

TriangleMesh parse_mesh(const std::string& bytes, const std::string& extension, double scale, const std::string& asked_by) {
  std::string format = extension;
  std::transform(format.begin(), format.end(), format.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (format != "stl" && format != "obj" && format != "dae")
    throw InputError(asked_by + ": ." + extension + " is no known mesh format (allowed: stl, obj, dae)");
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = nullptr;
  try {
    scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), aiProcess_Triangulate | aiProcess_PreTransformVertices, format.c_str());
  } catch (const std::exception& e) {
    throw InputError(asked_by + ": not a valid " + format + " file: " + e.what());
  }
  if (!scene) throw InputError(asked_by + ": not a valid " + format + " file: " + importer.GetErrorString());
  TriangleMesh mesh;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) append(*scene->mMeshes[m], scale, asked_by, mesh);
  if (mesh.triangles.empty()) throw InputError(asked_by + ": has no triangles");
  return tape::merge_vertices(mesh);
}

TriangleMesh load_mesh(const std::filesystem::path& file, double scale, const std::string& asked_by) {
  const std::string extension = file.extension().string();
  return parse_mesh(read_whole_file(file, asked_by), extension.empty() ? "" : extension.substr(1), scale, asked_by + " = " + file.string());
}
}  // namespace cosim
