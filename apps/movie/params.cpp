#include "apps/movie/params.hpp"

#include <algorithm>

#include "cosim/episode/camera_file.hpp"
#include "cosim/scene/scene_file.hpp"

namespace tape::movie {
namespace {
std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}
std::string in_quotes(const std::string& name) { return "'" + name + "'"; }  // names hold no quotes

/// Settings as keys and values of a section.
template <Settings T>
std::vector<std::string> entries(T settings) {
  std::vector<std::string> list;
  settings.fields([&](const char* name, auto& value, const char*, Range, const char*) {
    using V = std::remove_cvref_t<decltype(value)>;
    std::string text;
    if constexpr (std::is_same_v<V, Vec3>) {
      text = "[" + to_text(value.x()) + ", " + to_text(value.y()) + ", " + to_text(value.z()) + "]";
    } else if constexpr (std::is_same_v<V, std::string>) {
      if (!value.empty()) text = in_quotes(value);
    } else if constexpr (std::is_same_v<V, bool>) {
      text = value ? "true" : "false";
    } else if constexpr (NamedEnum<V>) {
      text = to_text(value);
    } else {
      text = to_text(static_cast<Real>(value));
    }
    if (!text.empty()) list.push_back(std::string(name) + ": " + text);
  });
  return list;
}
std::string section(const std::vector<std::string>& entries) { return "{" + joined(entries) + "}"; }
std::string camera_text(const CameraParams& camera) {
  std::vector<std::string> list = std::visit([](const auto& lens) { return entries(lens); }, camera.lens);
  if (camera.inset) list.push_back("inset: " + section(entries(*camera.inset)));
  return section(list);
}

template <Settings T>
T read_as(const cosim::Reader& reader) {
  T settings;
  reader.read(settings);
  return settings;
}
/// Names go into the text of a recording in quotes.
void require_name(const cosim::Reader& where, const std::string& name) {
  if (name.find('\'') != std::string::npos) where.fail("a name holds no quotes");
}
CameraParams read_camera(const cosim::Reader& camera) {
  const cosim::Reader inset = camera["inset"];
  if (camera["fx"]) {
    if (inset) inset.fail("a calibrated camera has its own size and is no inset");
    auto pinhole = read_as<render::PinholeSettings>(camera);
    pinhole.calibration.lens =
        cosim::read_distortion(camera["distortion"]);  // of landmarks: pictures are drawn as an ideal lens makes them
    require_name(camera["name"], pinhole.name);
    require_name(camera["mount"], pinhole.mount);
    return {pinhole};
  }
  const auto look = read_as<render::LookAtSettings>(camera);
  try {
    render::Camera::make(look, 2, 2);  // a camera that sees something
  } catch (const InputError& e) {
    throw InputError(camera.where() + ": " + e.what());
  }
  require_name(camera["follow"], look.follow);
  require_name(camera["mount"], look.mount);
  if (inset) return {look, read_as<InsetParams>(inset)};
  return {look};
}

/// Pictures side by side are of one size.
void require_one_size(const std::vector<CameraParams>& cameras, const std::vector<cosim::Reader>& where) {
  const auto* first = std::get_if<render::PinholeSettings>(&cameras[0].lens);
  for (std::size_t i = 1; i < cameras.size(); ++i) {
    const auto* other = std::get_if<render::PinholeSettings>(&cameras[i].lens);
    if (!first && !other) continue;
    if (!first || !other || first->calibration.width != other->calibration.width || first->calibration.height != other->calibration.height)
      where[i].fail("a calibrated camera has its own size; beside it stand only those of the same");
  }
}
/// A picture for the insets to stand in, and a corner for each.
void require_room(const std::vector<CameraParams>& cameras, const std::vector<cosim::Reader>& where) {
  std::vector<Corner> taken;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (!cameras[i].inset) continue;
    const Corner corner = cameras[i].inset->corner;
    if (std::ranges::find(taken, corner) != taken.end()) where[i]["inset"].fail("there is another inset in this corner");
    taken.push_back(corner);
  }
  if (taken.size() == cameras.size()) where[0]["inset"].fail("there is no camera without inset, for the picture that it stands in");
}
}  // namespace

std::vector<CameraParams> read_cameras(const cosim::Reader& camera) {
  if (!camera) return {};
  const std::vector<cosim::Reader> items = camera.is_list() ? camera.items() : std::vector<cosim::Reader>{camera};
  std::vector<CameraParams> cameras;
  for (const cosim::Reader& one : items) cameras.push_back(read_camera(one));
  if (cameras.empty()) return cameras;
  require_one_size(cameras, items);
  require_room(cameras, items);
  return cameras;
}

std::vector<CameraParams> load_cameras(const std::filesystem::path& file) {
  const cosim::SceneFile yaml_file = cosim::SceneFile::load(file);
  const cosim::Reader given = yaml_file["camera"];
  std::vector<CameraParams> cameras = read_cameras(given ? given : yaml_file.root());
  yaml_file.require_all_used();
  return cameras;
}

std::string pictures_text(const PictureParams& params) {
  std::vector<std::string> video = entries(params.view), names, cameras;
  for (const std::string& entry : entries(params.video)) video.push_back(entry);
  for (const std::string& name : params.overlay) names.push_back(in_quotes(name));
  video.push_back("overlay: [" + joined(names) + "]");
  for (const CameraParams& camera : params.cameras) cameras.push_back(camera_text(camera));
  return "video: " + section(video) + "\ncamera: [" + joined(cameras) + "]\n";
}

PictureParams parse_pictures(const std::string& text, const std::vector<std::string>& bearers) {
  return read_pictures(cosim::SceneFile::parse(text, "pictures of the recording").root(), bearers);
}

PictureParams read_pictures(const cosim::Reader& root, const std::vector<std::string>& bearers) {
  PictureParams params;
  const cosim::Reader video = root["video"];
  video.read(params.view);
  video.read(params.video);
  for (const char* key : {"width", "height"})
    if (const cosim::Reader size = video[key]; size && size.integer(Range::any()) % 2) size.fail("must be even, as H.264 asks");
  if (video["overlay"])
    for (const cosim::Reader& name : video["overlay"].items()) {
      params.overlay.push_back(bearers[choose(name, bearers)]);
      require_name(name, params.overlay.back());
    }
  params.cameras = read_cameras(root["camera"]);
  return params;
}

void require_video(const PictureParams& params) {
  video::VideoSettings settings = params.video;
  const auto* pinhole = params.cameras.empty() ? nullptr : std::get_if<render::PinholeSettings>(&params.cameras[0].lens);
  if (pinhole) {
    settings.width = static_cast<int>(params.cameras.size()) * pinhole->calibration.width;
    settings.height = pinhole->calibration.height;
  }
  require_valid(settings);
  video::require_ffmpeg();
}
}  // namespace tape::movie
