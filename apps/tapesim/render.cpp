#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "apps/movie/movie_file.hpp"
#include "apps/movie/things.hpp"
#include "apps/tapesim/commands.hpp"
#include "apps/tapesim/interrupt.hpp"
#include "apps/tapesim/progress.hpp"
#include "cosim/run/new_file.hpp"
#include "cosim/scene/node.hpp"

namespace tape::tapesim {
namespace {
struct RenderArguments {
  std::string folder, camera, color, out;
  std::vector<std::string> overlay;
  std::vector<int> stills;
  std::optional<int> width, height;
  bool no_ground = false;
  std::optional<double> track;
};

render::ColorBy color_of(const std::string& name) {
  const auto names = enum_names(render::ColorBy{});
  std::size_t i = 0;
  while (names[i] != name) ++i;  // the command line has been checked
  return static_cast<render::ColorBy>(i);
}

/// What the scene says, and the command line over that.
movie::PictureParams pictures(const RenderArguments& arguments, const cosim::RecordedMesh& mesh) {
  const std::vector<std::string> bearers = movie::bearers_of(mesh);
  movie::PictureParams params = movie::parse_pictures(mesh.pictures, bearers);
  if (!arguments.color.empty()) params.view.color = color_of(arguments.color);
  if (arguments.no_ground) params.view.ground = false;
  params.view.track = arguments.track.value_or(params.view.track);
  params.video.width = arguments.width.value_or(params.video.width);
  params.video.height = arguments.height.value_or(params.video.height);
  if (!arguments.camera.empty()) params.cameras = movie::load_cameras(arguments.camera);
  if (!arguments.overlay.empty()) params.overlay = arguments.overlay;
  for (const std::string& name : params.overlay)
    if (std::ranges::find(bearers, name) == bearers.end())
      throw InputError("--overlay " + name + ": no grip and no link robot:link has this name; " +
                       cosim::suggestion(name, {bearers.begin(), bearers.end()}));
  return params;
}

int render(const RenderArguments& arguments) {
  const std::filesystem::path folder = arguments.folder, out = arguments.out.empty() ? folder : std::filesystem::path(arguments.out);
  const cosim::StateReader recording(folder / "state.h5");
  const movie::PictureParams params = pictures(arguments, recording.mesh());
  cosim::make_folder(out);
  remember_interrupts();
  for (int frame : arguments.stills) {
    const std::filesystem::path file = out / fmt::format("still_{}.png", frame);
    movie::write_still(recording, params, frame, file);
    fmt::print("{}\n", file.string());
    if (interrupted()) return kInterrupted;
  }
  if (!arguments.stills.empty()) return kDone;
  if (!movie::write_video(recording, params, out / "video.mp4", watched_video())) {
    fmt::print("interrupted: no video; to make it, give the same command again\n");
    return kInterrupted;
  }
  fmt::print("{}\n", (out / "video.mp4").string());
  return kDone;
}
}  // namespace

void add_render(CLI::App& app, Action& chosen) {
  auto arguments = std::make_shared<RenderArguments>();
  CLI::App* command = app.add_subcommand("render", "makes a video, with a still of each phase, or stills from a recorded run");
  command->add_option("RUNDIR", arguments->folder, "folder of a run; its state.h5 is read")->required();
  command->add_option("--camera", arguments->camera,
                      "YAML file with eye, target, up, fov, follow, mount, or with fx, fy, cx, cy, width, height, position, rotation; "
                      "`camera: [{...}, {...}]`: several side by side, those with `inset` in a corner");
  std::vector<std::string> colors;
  for (std::string_view name : enum_names(render::ColorBy{})) colors.emplace_back(name);
  command->add_option("--color", arguments->color, "what colours mean (default: as the scene says, and so below)")
      ->check(CLI::IsMember(colors));
  command
      ->add_option("--still", arguments->stills,
                   "instead of the video: a PNG of this recorded state; may be repeated; negative counts from the end")
      ->allow_extra_args(false);
  command->add_option("--width", arguments->width, "[px] of the picture, unless the camera is calibrated")->check(CLI::Range(16, 7680));
  command->add_option("--height", arguments->height, "[px] of the picture, unless the camera is calibrated")->check(CLI::Range(16, 4320));
  command->add_flag("--no-ground", arguments->no_ground, "without the ground and its lines");
  command->add_option("--overlay", arguments->overlay, "shows the force of this grip, or link as robot:link; may be repeated")
      ->allow_extra_args(false);
  command->add_option("--track", arguments->track, "[m] paints the row of the first strip that lies here at rest")
      ->check(CLI::Range(0.0, 100.0));
  command->add_option("--out", arguments->out, "folder for the pictures (default: RUNDIR)");
  command->callback([=, &chosen] { chosen = [=] { return render(*arguments); }; });
}
}  // namespace tape::tapesim
