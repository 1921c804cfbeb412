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
/// Names go into the text of a recording in single quotes.
void require_name(const cosim::Reader& where, const std::string& name) {
  if (name.find('\'') != std::string::npos) where.fail("a name holds no quotes");
}
CameraParams read_camera(const cosim::Reader& camera) {
  if (camera["fx"]) {
    auto pinhole = read_as<render::PinholeSettings>(camera);
    pinhole.calibration.lens = cosim::read_distortion(camera["distortion"]);
    require_name(camera["name"], pinhole.name);
    require_name(camera["mount"], pinhole.mount);
    return pinhole;
  }
  const auto look = read_as<render::LookAtSettings>(camera);
  try {
    render::Camera::make(look, 2, 2);  // a camera that sees something
  } catch (const InputError& e) {
    throw InputError(camera.where() + ": " + e.what());
  }
  require_name(camera["follow"], look.follow);
  require_name(camera["mount"], look.mount);
  return look;
}

/// Pictures side by side are of one size.
void require_one_size(const std::vector<CameraParams>& cameras, const std::vector<cosim::Reader>& where) {
  const auto* first = std::get_if<render::PinholeSettings>(&cameras[0]);
  for (std::size_t i = 1; i < cameras.size(); ++i) {
    const auto* other = std::get_if<render::PinholeSettings>(&cameras[i]);
    if (!first && !other) continue;
    if (!first || !other || first->calibration.width != other->calibration.width || first->calibration.height != other->calibration.height)
      where[i].fail("a calibrated camera has its own size; beside it stand only those of the same");
  }
}
}  // namespace

std::vector<CameraParams> read_cameras(const cosim::Reader& camera) {
  if (!camera) return {};
  if (!camera.is_list()) return {read_camera(camera)};
  std::vector<CameraParams> cameras;
  const std::vector<cosim::Reader> items = camera.items();
  for (const cosim::Reader& one : items) cameras.push_back(read_camera(one));
  if (!cameras.empty()) require_one_size(cameras, items);
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
