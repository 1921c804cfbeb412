#include "apps/tapesim/pictures.hpp"
#include "cosim/episode/camera_file.hpp"
#include "cosim/scene/scene_file.hpp"

namespace tape::tapesim {
namespace {
/// A camera as a section in one line.
template <Settings T>
std::string yaml(T settings) {
  std::string text;
  settings.fields([&](const char* name, auto& value, const char*, Range, const char*) {
    using V = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::is_same_v<V, std::string>)
      if (value.empty()) return;
    text += (text.empty() ? "{" : ", ") + std::string(name) + ": ";
    if constexpr (std::is_same_v<V, Vec3>) {
      text += "[" + to_text(value.x()) + ", " + to_text(value.y()) + ", " + to_text(value.z()) + "]";
    } else if constexpr (std::is_same_v<V, std::string>) {
      text += "'" + value + "'";  // names hold no quotes
    } else {
      text += to_text(static_cast<Real>(value));
    }
  });
  return text + "}";
}
template <Settings T>
T read_as(const cosim::Reader& camera) {
  T settings;
  camera.read(settings);
  return settings;
}
CameraParams read_camera(const cosim::Reader& camera) {
  if (camera["fx"]) {
    cosim::read_distortion(camera["distortion"]);  // checked, no more: pictures are drawn as an ideal lens makes them
    return read_as<render::PinholeSettings>(camera);
  }
  const auto look = read_as<render::LookAtSettings>(camera);
  try {
    render::Camera::make(look, 2, 2);  // a camera that sees something
  } catch (const InputError& e) {
    throw InputError(camera.where() + ": " + e.what());
  }
  if (look.follow.find('\'') != std::string::npos) camera["follow"].fail("no thing has such a name");
  return look;
}
}  // namespace

std::vector<CameraParams> read_cameras(const cosim::Reader& camera) {
  if (!camera) return {};
  if (!camera.is_list()) return {read_camera(camera)};
  std::vector<CameraParams> cameras;
  for (const cosim::Reader& one : camera.items()) {
    cameras.push_back(read_camera(one));
    if (std::holds_alternative<render::PinholeSettings>(cameras.back())) one.fail("a calibrated camera has its own size and stands alone");
  }
  return cameras;
}

std::vector<CameraParams> load_cameras(const std::filesystem::path& file) {
  const cosim::SceneFile yaml_file = cosim::SceneFile::load(file);
  const cosim::Reader section = yaml_file["camera"];
  std::vector<CameraParams> cameras = read_cameras(section ? section : yaml_file.root());
  yaml_file.require_all_used();
  return cameras;
}

std::string camera_text(const std::vector<CameraParams>& cameras) {
  std::string text;
  for (const CameraParams& camera : cameras) {
    text += text.empty() ? "" : ", ";
    if (const auto* look = std::get_if<render::LookAtSettings>(&camera)) text += yaml(*look);
    if (const auto* pinhole = std::get_if<render::PinholeSettings>(&camera)) text += yaml(*pinhole);
  }
  if (cameras.empty()) return "";
  return "camera: " + (cameras.size() == 1 ? text : "[" + text + "]") + "\n";
}

std::vector<CameraParams> parse_cameras(const std::string& text) {
  if (text.empty()) return {};
  return read_cameras(cosim::SceneFile::parse(text, "camera of the recording")["camera"]);
}

PictureParams read_pictures(const cosim::Reader& root) {
  PictureParams params;
  const cosim::Reader section = root["video"];
  section.read(params.view);
  section.read(params.video);
  for (const char* key : {"width", "height"})
    if (const cosim::Reader size = section[key]; size && size.integer(Range::any()) % 2) size.fail("must be even, as H.264 asks");
  params.cameras = read_cameras(root["camera"]);
  return params;
}
}  // namespace tape::tapesim
