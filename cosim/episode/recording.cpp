#include "cosim/episode/recording.hpp"

#include "cosim/episode/camera_file.hpp"
#include "cosim/episode/episode_file.hpp"
#include "cosim/episode/import.hpp"
#include "cosim/scene/scene_file.hpp"
#include "robot/urdf/read_urdf.hpp"

namespace cosim {
namespace {
namespace fs = std::filesystem;

class Importer {
 public:
  Importer(const Reader& section, const fs::path& from) : section_(section), from_(from) {}

  Episode all() {
    episode_.name = from_.stem().string();
    episode_.origin = section_["origin"].text_or("");
    const Reader motion = section_["motion"];
    if (motion.items().empty()) motion.fail("missing; must be a list of what is imported: {csv: ...}, {lerobot: ...} or {vendor: ...}");
    for (const Reader& entry : motion.items()) episode_.streams.push_back(stream(entry));
    const Reader cameras = section_["cameras"], landmarks = section_["landmarks"];
    for (const std::string& name : cameras.keys()) episode_.cameras.push_back(camera(name, cameras[name]));
    for (const std::string& name : landmarks.keys()) episode_.landmarks.push_back(track(name, landmarks[name]));
    require_sound(episode_, section_.where());
    return std::move(episode_);
  }

 private:
  fs::path file(const Reader& name, const char* subfolder = "episodes") const { return named_file(name, from_, subfolder); }

  MotionStream stream(const Reader& entry) {
    if (const Reader csv = entry["csv"]) return table(csv, entry);
    if (const Reader lerobot = entry["lerobot"]) return data_set(lerobot, entry);
    if (const Reader vendor = entry["vendor"]) return controller(vendor, entry);
    entry.fail("must hold one of csv, lerobot, vendor");
  }
  MotionStream table(const Reader& csv, const Reader& entry) {
    const Reader section = entry["joints"];
    std::vector<TableJoint> joints;
    for (const std::string& name : section.keys())
      joints.push_back({.name = name,
                        .unit = section[name]["unit"].choice<Unit>(),
                        .measured = section[name]["measured"].text_or(""),
                        .commanded = section[name]["commanded"].text_or("")});
    return import_csv(file(csv), entry["stream"].text_or(csv.text()), entry["time"].text(), joints);
  }
  MotionStream data_set(const Reader& lerobot, const Reader& entry) {
    LeRobotUnits units{.usual = entry["unit"].choice<Unit>()};
    const Reader other = entry["units"];
    for (const std::string& joints : other.keys()) units.of.emplace_back(joints, other[joints].choice<Unit>());
    const fs::path folder = fs::absolute(from_).parent_path() / lerobot.text();
    if (!fs::is_directory(folder)) lerobot.fail("there is no such folder beside this file");
    return import_lerobot(folder, entry["episode"].integer(Range::closed(0, 1e9)), file(entry["table"]), units);
  }
  MotionStream controller(const Reader& vendor, const Reader& entry) {
    const Reader columns = entry["columns"], urdf = entry["urdf"];
    const bool recorded = choose(columns, {"recorded", "command"}) == 0;
    const Real period = entry["period"].number_or(1e-3, Range::above(0, 1), "s");
    try {
      return import_vendor(file(vendor), entry["stream"].text_or(vendor.text()), robot::read_urdf(file(urdf, "robots")),
                           entry["joints"].texts(), recorded ? robot::VendorColumns::recorded : robot::VendorColumns::command, period);
    } catch (const robot::InputError& e) {
      urdf.fail(e.what());
    }
  }

  EpisodeCamera camera(const std::string& name, const Reader& calibrated) {
    const PlacedCamera placed = load_camera(file(calibrated, "cameras"));
    return {.name = name, .calibration = placed.calibration, .poses = {placed.X_WC}};
  }
  LandmarkTrack track(const std::string& camera, const Reader& section) {
    LandmarkTrack track{.camera = camera, .body = section["body"].text_or("hub")};
    for (const EpisodeCamera& one : episode_.cameras)
      if (one.name == camera) track.width = one.calibration.width, track.height = one.calibration.height;
    track.undistorted = section["undistorted"].flag_or(false);
    return import_landmarks(file(section["marks"]), track);
  }

  Reader section_;
  fs::path from_;
  Episode episode_;
};
}  // namespace

fs::path named_file(const Reader& name, const fs::path& from, const std::string& subfolder) {
  fs::path found = find_file(from, subfolder, name.text());
  if (found.empty()) name.fail("there is no such file");
  return found;
}

Episode read_recording(const Reader& recording, const fs::path& from) {
  return recording.is_map() ? Importer(recording, from).all() : read_episode(named_file(recording, from, "episodes"));
}
}  // namespace cosim
