#include "cosim/scene/mesh_file.hpp"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <charconv>
#include <string_view>

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
/// The importer of DAE files (assimp 5.2) reserves whatever a count asks for, and reads index lists for ever where they hold anything
/// but numbers. This looks at the text before it does: whole numbers only, and none above the size of the file.
class DaeGuard {
 public:
  DaeGuard(std::string_view text, const std::string& asked_by) : text_(text), asked_by_(asked_by) {}

  void attribute(std::string_view name) const {
    for (std::size_t at = text_.find(name); at != text_.npos; at = text_.find(name, at + 1)) {
      const std::size_t equals = text_.find_first_not_of(kSpace, at + name.size());
      if (equals >= text_.size() || text_[equals] != '=') continue;
      const std::size_t value = std::min(text_.find_first_of("\"'", equals), text_.size() - 1) + 1;
      require_number(text_.substr(value, text_.find_first_of("\"'", value) - value));
    }
  }
  void content(const std::string& element) const {
    for (std::size_t at = text_.find("<" + element); at != text_.npos; at = text_.find("<" + element, at + 1)) {
      const std::size_t after = at + 1 + element.size();
      if (after >= text_.size() || (text_[after] != '>' && kSpace.find(text_[after]) == kSpace.npos)) continue;
      std::size_t i = std::min(text_.find('>', after), text_.size() - 1) + 1;
      const std::size_t end = std::min(text_.find('<', i), text_.size());
      while ((i = text_.find_first_not_of(kSpace, i)) < end) {
        const std::size_t stop = std::min(text_.find_first_of(kSpace, i), end);
        require_number(text_.substr(i, stop - i));
        i = stop;
      }
      if (text_.substr(end).starts_with("<!")) require_number(text_.substr(end, 2));
    }
  }

 private:
  static constexpr std::string_view kSpace = " \t\r\n";
  void require_number(std::string_view digits) const {
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || value > text_.size())
      throw InputError(asked_by_ + ": not a valid dae file: a count or index is " + std::string(digits.substr(0, 20)));
  }
  std::string_view text_;
  const std::string& asked_by_;
};
}  // namespace

TriangleMesh parse_mesh(const std::string& bytes, const std::string& extension, double scale, const std::string& asked_by) {
  std::string format = extension;
  std::transform(format.begin(), format.end(), format.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (format != "stl" && format != "obj" && format != "dae")
    throw InputError(asked_by + ": ." + extension + " is no known mesh format (allowed: stl, obj, dae)");
  if (format == "dae") {
    const DaeGuard guard(bytes, asked_by);
    for (const char* name : {"count", "stride", "offset"}) guard.attribute(name);
    for (const char* name : {"p", "v", "h", "vcount"}) guard.content(name);
  }
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
