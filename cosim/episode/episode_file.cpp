#include "cosim/episode/episode_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cosim/run/hdf5_file.hpp"

namespace cosim {
namespace {
constexpr const char* kFormat = "tapesim episode 1";
constexpr const char* kUndistorted = "undistorted";
constexpr const char* kDistorted = "as recorded";

template <class T, class F>
std::string listed(const std::vector<T>& all, F&& text) {
  std::string list;
  for (const T& one : all) list += (list.empty() ? "" : ", ") + text(one);
  return list;
}
/// "a, b, c"
std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> all;
  for (std::size_t begin = 0, end = 0; end != list.npos; begin = end + 1) {
    end = list.find(',', begin);
    const std::string item = list.substr(begin, end == list.npos ? end : end - begin);
    const std::size_t first = item.find_first_not_of(' ');
    all.push_back(first == item.npos ? "" : item.substr(first, item.find_last_not_of(' ') - first + 1));
  }
  return all;
}

class Writer {
 public:
  explicit Writer(const std::filesystem::path& name) : file_(name) {}
  void write(const Episode& episode) {
    file_.write_text("format", kFormat);
    file_.write_text("name", episode.name);
    file_.write_text("origin", episode.origin);
    for (const MotionStream& stream : episode.streams) write("motion/" + stream.name + "/", stream);
    for (const EpisodeCamera& camera : episode.cameras) write("cameras/" + camera.name + "/", camera);
    for (const LandmarkTrack& track : episode.landmarks) write("landmarks/" + track.camera + "/", track);
    file_.commit();
  }

 private:
  void times(const std::string& array, const std::vector<Real>& times) {
    file_.write(array, times, {times.size()});
    file_.write_text(array, "unit", "s");
  }
  void positions(const std::string& array, const MotionStream& stream, const std::vector<robot::VecX>& rows) {
    if (rows.empty()) return;
    std::vector<double> values;
    for (const robot::VecX& row : rows) values.insert(values.end(), row.begin(), row.end());
    file_.write(array, values, {rows.size(), stream.joints.size()});
    file_.write_text(array, "joints", listed(stream.joints, [](const RecordedJoint& joint) { return joint.name; }));
    file_.write_text(array, "units", listed(stream.joints, [](const RecordedJoint& joint) { return to_text(joint.unit); }));
  }
  void write(const std::string& folder, const MotionStream& stream) {
    times(folder + "time", stream.times);
    positions(folder + "measured", stream, stream.measured);
    positions(folder + "commanded", stream, stream.commanded);
  }
  void write(const std::string& folder, const EpisodeCamera& camera) {
    const Calibration& c = camera.calibration;
    file_.write(folder + "size", std::vector<int>{c.width, c.height}, {2});
    file_.write(folder + "intrinsics", std::vector<double>{c.fx, c.fy, c.cx, c.cy}, {4});
    file_.write_text(folder + "intrinsics", "unit", "px");
    file_.write(folder + "distortion", std::vector<double>{c.lens.k1, c.lens.k2, c.lens.p1, c.lens.p2, c.lens.k3}, {5});
    file_.write_text(folder + "distortion", "model", "brown_conrady");
    std::vector<double> poses;
    for (const Pose& pose : camera.poses) {
      for (Eigen::Index row = 0; row < 3; ++row)
        for (Eigen::Index column = 0; column < 3; ++column) poses.push_back(pose.rotation(row, column));
      poses.insert(poses.end(), pose.position.begin(), pose.position.end());
    }
    file_.write(folder + "pose", poses, {camera.poses.size(), 12});
    file_.write_text(folder + "pose", "frame", camera.mount);
    file_.write_text(folder + "pose", "unit", "m");
    if (!camera.times.empty()) times(folder + "pose_time", camera.times);
  }
  void write(const std::string& folder, const LandmarkTrack& track) {
    std::vector<double> time, pixel;
    std::vector<int> kind, visible, estimated;
    for (const Landmark& mark : track.landmarks) {
      time.push_back(mark.time);
      pixel.insert(pixel.end(), mark.pixel.begin(), mark.pixel.end());
      kind.push_back(static_cast<int>(mark.kind));
      visible.push_back(mark.visible);
      estimated.push_back(mark.estimated);
    }
    const hsize_t n = track.landmarks.size();
    times(folder + "time", time);
    file_.write(folder + "pixel", pixel, {n, 2});
    file_.write_text(folder + "pixel", "unit", "px");
    file_.write_text(folder + "pixel", "picture", track.undistorted ? kUndistorted : kDistorted);
    file_.write_text(folder + "pixel", "body", track.body);
    file_.write(folder + "kind", kind, {n});
    file_.write_text(folder + "kind", "meaning", "0 rim, 1 side_box");
    file_.write(folder + "visible", visible, {n});
    file_.write(folder + "estimated", estimated, {n});
    file_.write(folder + "size", std::vector<int>{track.width, track.height}, {2});
  }

  Hdf5Writer file_;
};

class EpisodeReader {
 public:
  explicit EpisodeReader(const std::filesystem::path& name) : name_(name.string()), file_(name) {}
  Episode read() const {
    const std::string format = file_.read_text("format");
    if (format != kFormat) fail(fmt::format("format '{}' (allowed: {})", format, kFormat));
    Episode episode{.name = file_.read_text("name"), .origin = file_.read_text("origin")};
    for (const std::string& stream : file_.members("motion")) episode.streams.push_back(motion(stream));
    for (const std::string& one : file_.members("cameras")) episode.cameras.push_back(camera(one));
    for (const std::string& of : file_.members("landmarks")) episode.landmarks.push_back(landmarks(of));
    require_sound(episode, name_);
    return episode;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError(name_ + ": " + what); }
  void require_text(const std::string& array, const char* attribute, const std::string& wanted) const {
    if (const std::string text = file_.read_text(array, attribute); text != wanted)
      fail(fmt::format("{} of {} is {} (allowed: {})", attribute, array, text, wanted));
  }
  /// @param shape  0: any number
  void require_shape(const std::string& array, const Shape& shape) const {
    const Shape found = file_.shape(array);
    bool same = found.size() == shape.size();
    for (std::size_t i = 0; same && i < shape.size(); ++i) same = shape[i] == 0 || shape[i] == found[i];
    const auto text = [](hsize_t n) { return n == 0 ? std::string("n") : std::to_string(n); };
    if (!same) fail(fmt::format("{} has shape [{}] (allowed: [{}])", array, listed(found, text), listed(shape, text)));
  }
  std::vector<double> reals(const std::string& array, const Shape& shape) const {
    require_shape(array, shape);
    return file_.read_reals(array);
  }
  std::vector<int> ints(const std::string& array, const Shape& shape, int low, int high) const {
    require_shape(array, shape);
    std::vector<int> values = file_.read_ints(array);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (values[i] < low || values[i] > high) fail(fmt::format("{}[{}] = {} (allowed: {} to {})", array, i, values[i], low, high));
    return values;
  }
  std::vector<Real> times(const std::string& array) const {
    require_text(array, "unit", "s");
    return reals(array, {0});
  }

  std::vector<RecordedJoint> joints(const std::string& array) const {
    const std::vector<std::string> names = split(file_.read_text(array, "joints")), units = split(file_.read_text(array, "units"));
    if (names.size() != units.size()) fail(fmt::format("{} has {} joints, {} units (allowed: as many)", array, names.size(), units.size()));
    constexpr auto kUnits = enum_names(Unit{});
    std::vector<RecordedJoint> all;
    for (std::size_t j = 0; j < names.size(); ++j) {
      const auto unit = std::find(kUnits.begin(), kUnits.end(), units[j]);
      if (unit == kUnits.end())
        fail(fmt::format("{}: unit '{}' of joint {} (allowed: rad, deg, m, mm, or 1 for a share)", array, units[j], names[j]));
      all.push_back({names[j], static_cast<Unit>(unit - kUnits.begin())});
    }
    return all;
  }
  std::vector<robot::VecX> rows(const std::string& array, std::size_t count, std::size_t joints) const {
    const std::vector<double> values = reals(array, {count, joints});
    std::vector<robot::VecX> all;
    for (std::size_t i = 0; i < count; ++i)
      all.emplace_back(robot::VecX::Map(values.data() + i * joints, static_cast<Eigen::Index>(joints)));
    return all;
  }
  MotionStream motion(const std::string& name) const {
    const std::string folder = "motion/" + name + "/";
    MotionStream stream{.name = name, .joints = {}, .times = times(folder + "time")};
    for (const char* what : {"measured", "commanded"}) {
      const std::string array = folder + what;
      if (!file_.holds(array)) continue;
      const std::vector<RecordedJoint> own = joints(array);
      const auto same = [](const RecordedJoint& a, const RecordedJoint& b) { return a.name == b.name && a.unit == b.unit; };
      if (!stream.joints.empty() && !std::equal(own.begin(), own.end(), stream.joints.begin(), stream.joints.end(), same))
        fail(array + " has other joints or units than " + folder + "measured (allowed: the same in the same order)");
      stream.joints = own;
      (std::string(what) == "measured" ? stream.measured : stream.commanded) = rows(array, stream.times.size(), own.size());
    }
    return stream;
  }

  EpisodeCamera camera(const std::string& name) const {
    const std::string folder = "cameras/" + name + "/";
    const std::vector<int> size = ints(folder + "size", {2}, 1, 16384);
    require_text(folder + "intrinsics", "unit", "px");
    const std::vector<double> k = reals(folder + "intrinsics", {4});
    require_text(folder + "distortion", "model", "brown_conrady");
    const std::vector<double> d = reals(folder + "distortion", {5});
    require_text(folder + "pose", "unit", "m");
    const std::vector<double> poses = reals(folder + "pose", {0, 12});
    EpisodeCamera camera{.name = name, .calibration = {}, .mount = file_.read_text(folder + "pose", "frame"), .poses = {}};
    camera.calibration = {.fx = k[0], .fy = k[1], .cx = k[2], .cy = k[3], .width = size[0], .height = size[1]};
    camera.calibration.lens = {.k1 = d[0], .k2 = d[1], .p1 = d[2], .p2 = d[3], .k3 = d[4]};
    for (const double* p = poses.data(); p != poses.data() + poses.size(); p += 12) {
      using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
      camera.poses.push_back({Rows::Map(p), Vec3::Map(p + 9)});
    }
    if (file_.holds(folder + "pose_time")) camera.times = times(folder + "pose_time");
    return camera;
  }

  LandmarkTrack landmarks(const std::string& of) const {
    const std::string folder = "landmarks/" + of + "/";
    const std::vector<int> size = ints(folder + "size", {2}, 1, 16384);
    const std::string picture = file_.read_text(folder + "pixel", "picture");
    if (picture != kUndistorted && picture != kDistorted)
      fail(fmt::format("picture of {}pixel is '{}' (allowed: {}, {})", folder, picture, kDistorted, kUndistorted));
    require_text(folder + "pixel", "unit", "px");
    LandmarkTrack track{.camera = of, .body = file_.read_text(folder + "pixel", "body"), .width = size[0], .height = size[1]};
    track.undistorted = picture == kUndistorted;
    const std::vector<Real> time = times(folder + "time");
    const hsize_t n = time.size();
    const std::vector<double> pixel = reals(folder + "pixel", {n, 2});
    const std::vector<int> kind = ints(folder + "kind", {n}, 0, 1), visible = ints(folder + "visible", {n}, 0, 1),
                           estimated = ints(folder + "estimated", {n}, 0, 1);
    for (std::size_t i = 0; i < n; ++i)
      track.landmarks.push_back(
          {time[i], {pixel[2 * i], pixel[2 * i + 1]}, static_cast<LandmarkKind>(kind[i]), visible[i] == 1, estimated[i] == 1});
    return track;
  }

  std::string name_;
  Hdf5Reader file_;
};
}  // namespace

void write_episode(const std::filesystem::path& file, const Episode& episode) {
  require_sound(episode, file.string());
  Writer(file).write(episode);
}

Episode read_episode(const std::filesystem::path& file) { return EpisodeReader(file).read(); }
}  // namespace cosim
