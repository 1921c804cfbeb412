#include "apps/tapesim/replay_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/movie/paint.hpp"
#include "apps/movie/things.hpp"
#include "apps/render/legend.hpp"
#include "apps/score/overlay.hpp"
#include "cosim/exchange/exchange.hpp"

namespace tape::tapesim {
namespace {
constexpr int kWidth = 1920;       // [px] of pictures side by side, at most
constexpr int kLetters = 22;       // [px]
constexpr Real kSameFrame = 0.02;  // [s] from a picture to the landmark that is shown in it

cosim::EpisodeCamera camera_of(const cosim::Replay& replay) {
  if (replay.camera.empty()) throw InputError(replay.name + ": names no camera, whose pictures these would be");
  return replay.episode.camera(replay.camera, replay.name);
}

/// The frame with a landmark nearest in time; null: none is near.
const score::FrameError* frame_near(const std::vector<score::FrameError>& frames, Real time) {
  const score::FrameError* best = nullptr;
  for (const score::FrameError& frame : frames)
    if (std::abs(frame.time - time) < std::abs(best ? best->time - time : kSameFrame)) best = &frame;
  return best;
}

std::string error_text(const score::FrameError* frame) {
  if (!frame) return "";
  return frame->in_front ? fmt::format(", {:.1f} px{}", frame->error(), frame->estimated ? " from an estimated landmark" : "")
                         : ", not in front";
}
}  // namespace

void require_pictures(const cosim::Replay& replay) {
  const cosim::EpisodeCamera camera = camera_of(replay);
  if (!replay.photographs.files.empty()) (void)score::read_photograph(replay.photographs.files.front(), camera.calibration);
}

EpisodeEye::EpisodeEye(const LoadedReplay& replay)
    : camera_(camera_of(replay.replay)),
      photographs_(replay.replay.photographs),
      start_(replay.replay.start),
      hub_(replay.loaded.world, replay.landmarks()->body),
      renderer_(camera_.calibration.width, camera_.calibration.height) {}

render::Picture EpisodeEye::simulated(const movie::ViewParams& view, const movie::Stage& stage, const cosim::RecordedMesh& mesh,
                                      const cosim::RecordedFrame& frame) {
  const Pose X_WB = camera_.mount == "world" ? Pose{} : movie::frame_of(camera_.mount, mesh, frame);
  const render::Camera camera = score::camera_at(camera_, start_ + frame.time, X_WB);
  render::Picture picture = renderer_.draw(movie::painted(view, stage, mesh, frame), camera);
  score::draw_rim(picture, camera, hub_.at(frame.bodies[static_cast<std::size_t>(hub_.body())]));
  return picture;
}

render::Picture EpisodeEye::photograph(Real time) const {
  const Real at = (start_ + time - photographs_.first) * photographs_.rate;
  const auto last = static_cast<Real>(photographs_.files.size() - 1);
  const auto nearest = static_cast<std::size_t>(std::clamp<Real>(std::round(at), 0, last));
  return score::undistorted(score::read_photograph(photographs_.files[nearest], camera_.calibration), camera_.calibration);
}

render::Picture start_picture(LoadedReplay& replay) {
  const World& world = replay.loaded.world;
  const cosim::RunInput& run = replay.loaded.input.run;
  const State start = State::start(world);
  const std::unique_ptr<Stepper> stepper = cosim::make_stepper(Backend::cpu, world, run.robots);
  auto* coupled = dynamic_cast<cosim::CoupledStepper*>(stepper.get());
  const auto mesh = cosim::RecordedMesh::of(world, run.robots, run.phases, "", "");
  const auto frame =
      cosim::RecordedFrame::of(world, start, {.robots = coupled ? coupled->records(start) : std::vector<cosim::RobotRecord>()});
  movie::Survey survey(replay.loaded.input.pictures);
  survey.add(mesh, frame);
  EpisodeEye eye(replay);
  const render::Picture seen = eye.simulated(replay.loaded.input.pictures.view, survey.stage(), mesh, frame);
  return eye.has_photographs() ? score::blended(eye.photograph(0), seen) : seen;
}

ReplayPictures::Column::Column(const ReplayRun& shown, const std::filesystem::path& folder)
    : run(shown),
      recording(folder / "state.h5"),
      params(movie::parse_pictures(recording.mesh().pictures, movie::bearers_of(recording.mesh()))),
      stage(movie::stage_of(recording, params)) {
  for (int i = 0; i < recording.frames(); ++i) times.push_back(recording.frame(i).time);
}

render::Picture ReplayPictures::at(Real time) {
  const render::Font font(kLetters);
  std::vector<render::Picture> pictures;
  const auto add = [&](render::Picture picture, const std::string& title) {
    draw_caption(picture, font, title);
    pictures.push_back(std::move(picture));
  };
  if (eye_.has_photographs()) {
    render::Picture picture = eye_.photograph(time);
    if (const score::FrameError* frame = frame_near(columns_.front().run.frames, time)) {
      score::FrameError real = *frame;
      real.in_front = false;
      score::draw_landmarks(picture, real);
    }
    add(std::move(picture), fmt::format("photograph, {:.2f} s", time));
  }
  for (Column& column : columns_) {
    const cosim::RecordedFrame state = column.recording.frame(static_cast<int>(score::nearest(column.times, time)));
    render::Picture picture = eye_.simulated(column.params.view, column.stage, column.recording.mesh(state.mesh), state);
    const score::FrameError* frame = frame_near(column.run.frames, time);
    if (frame) score::draw_landmarks(picture, *frame);
    add(std::move(picture), fmt::format("{}, {:.2f} s{}", column.run.model, state.time, error_text(frame)));
  }
  const auto columns = static_cast<int>(std::ceil(std::sqrt(static_cast<Real>(pictures.size()))));
  return score::tiled(pictures, columns, kWidth);
}

bool ReplayPictures::write_video(const std::filesystem::path& file, const std::function<bool(int done, int all)>& watch) {
  video::VideoSettings settings = columns_.front().params.video;
  const render::Picture first = at(0);
  settings.width = first.width, settings.height = first.height;
  Real end = 0;
  for (const Column& column : columns_) end = std::max(end, column.times.back());
  const int all = 1 + static_cast<int>(std::floor(end * settings.rate));
  video::VideoWriter video(file, settings);
  for (int k = 0; k < all; ++k) {
    video.add(at(k / settings.rate));
    if (!watch(k + 1, all)) return false;
  }
  video.finish();
  return true;
}
}  // namespace tape::tapesim
