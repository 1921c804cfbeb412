#include "apps/tapesim/pictures.hpp"
#include "cosim/scene/scene_file.hpp"

namespace tape::tapesim {
namespace {
template <Settings T>
std::string yaml(T settings) {
  std::string text;
  settings.fields([&](const char* name, auto& value, const char*, Range, const char*) {
    using V = std::remove_cvref_t<decltype(value)>;
    text += std::string(name) + ": ";
    if constexpr (std::is_same_v<V, Vec3>) {
      text += "[" + to_text(value.x()) + ", " + to_text(value.y()) + ", " + to_text(value.z()) + "]\n";
    } else {
      text += to_text(static_cast<Real>(value)) + "\n";
    }
  });
  return text;
}
template <Settings T>
T read_as(const cosim::Reader& camera) {
  T settings;
  camera.read(settings);
  return settings;
}
}  // namespace

CameraParams read_camera(const cosim::Reader& camera) {
  if (!camera) return {};
  if (camera["fx"]) return read_as<render::PinholeSettings>(camera);
  const auto look = read_as<render::LookAtSettings>(camera);
  try {
    render::Camera::make(look, 2, 2);  // a camera that sees something
  } catch (const InputError& e) {
    throw InputError(camera.where() + ": " + e.what());
  }
  return look;
}

CameraParams load_camera(const std::filesystem::path& file) {
  const cosim::SceneFile yaml_file = cosim::SceneFile::load(file);
  const cosim::Reader section = yaml_file["camera"];
  CameraParams camera = read_camera(section ? section : yaml_file.root());
  yaml_file.require_all_used();
  return camera;
}

std::string camera_text(const CameraParams& camera) {
  if (const auto* look = std::get_if<render::LookAtSettings>(&camera)) return yaml(*look);
  if (const auto* pinhole = std::get_if<render::PinholeSettings>(&camera)) return yaml(*pinhole);
  return "";
}

CameraParams parse_camera(const std::string& text) {
  if (text.empty()) return {};
  return read_camera(cosim::SceneFile::parse(text, "camera of the recording").root());
}

PictureParams read_pictures(const cosim::Reader& root) {
  PictureParams params;
  const cosim::Reader section = root["video"];
  section.read(params.view);
  section.read(params.video);
  for (const char* key : {"width", "height"})
    if (const cosim::Reader size = section[key]; size && size.integer(Range::any()) % 2) size.fail("must be even, as H.264 asks");
  params.camera = read_camera(root["camera"]);
  return params;
}
}  // namespace tape::tapesim
