#include "robot/urdf/mesh_file.hpp"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>

namespace robot {
namespace {
std::string extension(const std::filesystem::path& file) {
  std::string text = file.extension().string();
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

void add(const aiMesh& part, const Mat3& to_link, TriangleMesh& mesh) {
  const int first = static_cast<int>(mesh.vertices.size());
  const bool turn_over = to_link.determinant() < 0;
  for (unsigned v = 0; v < part.mNumVertices; ++v) {
    const aiVector3D& p = part.mVertices[v];
    mesh.vertices.push_back(to_link * Vec3(p.x, p.y, p.z));
  }
  for (unsigned f = 0; f < part.mNumFaces; ++f) {
    std::array<int, 3> t{};
    for (unsigned k = 0; k < 3; ++k) t[k] = first + static_cast<int>(part.mFaces[f].mIndices[k]);
    if (turn_over) std::swap(t[1], t[2]);
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.triangles.push_back(t);
  }
}
}  // namespace

TriangleMesh read_mesh(const std::filesystem::path& file, const Vec3& scale, bool honour_up_axis) {
  const std::string kind = extension(file);
  const bool gltf = kind == ".gltf" || kind == ".glb", collada = kind == ".dae" || kind == ".zae";
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, honour_up_axis ? 0 : 1);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
                                                          aiComponent_TEXCOORDS | aiComponent_MATERIALS | aiComponent_BONEWEIGHTS);
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_RemoveComponent |
                                                              aiProcess_PreTransformVertices | aiProcess_JoinIdenticalVertices);
  if (!scene) throw InputError(file.string() + ": cannot be read as a mesh: " + importer.GetErrorString());

  Mat3 up = Mat3::Identity();  // assimp turns COLLADA files to y-up, unless it is told not to
  if (gltf || (collada && honour_up_axis)) up << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  TriangleMesh mesh;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) add(*scene->mMeshes[m], scale.asDiagonal() * up, mesh);
  if (mesh.triangles.empty()) throw InputError(file.string() + ": the mesh has no triangle");
  for (const Vec3& v : mesh.vertices)
    if (!v.allFinite()) throw InputError(file.string() + ": a vertex of the mesh is not finite");
  return mesh;
}
}  // namespace robot
