#include "robot/urdf/mesh_uri.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "robot/model/robot_model.hpp"

namespace robot {
namespace {
namespace fs = std::filesystem;

std::string percent_decoded(const std::string& text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto hex = [&](std::size_t k) { return k < text.size() && std::isxdigit(static_cast<unsigned char>(text[k])); };
    if (text[i] == '%' && hex(i + 1) && hex(i + 2)) {
      decoded += static_cast<char>(std::strtol(text.substr(i + 1, 2).c_str(), nullptr, 16));
      i += 2;
    } else {
      decoded += text[i];
    }
  }
  return decoded;
}

/// From that of the URDF file to the root of the file system.
std::vector<fs::path> folders_upward(const fs::path& urdf) {
  std::vector<fs::path> folders;
  for (fs::path folder = fs::absolute(urdf).lexically_normal().parent_path();; folder = folder.parent_path()) {
    folders.push_back(folder);
    if (folder == folder.parent_path()) return folders;
  }
}

std::vector<fs::path> package_candidates(const std::string& path, const fs::path& urdf, const fs::path& package_root) {
  const std::size_t slash = std::min(path.find('/'), path.size());
  const std::size_t after = std::min(path.find_first_not_of('/', slash), path.size());
  const fs::path name = path.substr(0, slash), rest = path.substr(after);
  std::vector<fs::path> candidates;
  if (!package_root.empty()) candidates = {package_root / name / rest, package_root / rest};
  const std::vector<fs::path> upward = folders_upward(urdf);
  for (const fs::path& folder : upward) {
    if (folder.filename() == name) candidates.push_back(folder / rest);
    candidates.push_back(folder / name / rest);
  }
  for (const fs::path& folder : upward) candidates.push_back(folder / rest);
  return candidates;
}

std::vector<fs::path> relative_candidates(const fs::path& path, const fs::path& urdf, const fs::path& package_root) {
  std::vector<fs::path> candidates;
  for (const fs::path& folder : folders_upward(urdf)) candidates.push_back((folder / path).lexically_normal());
  if (!package_root.empty()) candidates.insert(candidates.begin() + 1, package_root / path);
  return candidates;
}

/// Every place that `uri` can mean, the likeliest first.
std::vector<fs::path> candidates(std::string uri, const fs::path& urdf, const fs::path& package_root) {
  std::replace(uri.begin(), uri.end(), '\\', '/');
  for (const std::string scheme : {"package://", "model://"})
    if (uri.starts_with(scheme)) return package_candidates(uri.substr(scheme.size()), urdf, package_root);
  if (uri.starts_with("file://")) uri.erase(0, 7);
  if (fs::path(uri).is_absolute()) return {uri};
  return relative_candidates(uri, urdf, package_root);
}
}  // namespace

fs::path find_mesh(const std::string& uri, const fs::path& urdf, const fs::path& package_root, const std::string& owner) {
  std::string tried;
  for (const std::string& spelling : {uri, percent_decoded(uri)})
    for (const fs::path& file : candidates(spelling, urdf, package_root)) {
      std::error_code ignored;
      if (fs::is_regular_file(file, ignored)) return file;
      if (spelling == uri) tried += "\n  " + file.string();
    }
  throw InputError(fmt::format("{}: {}: there is no mesh {}; looked for{}", urdf.string(), owner, uri, tried));
}
}  // namespace robot
