#include <fmt/format.h>

#include <memory>
#include <optional>

#include "apps/tapesim/commands.hpp"
#include "apps/tapesim/interrupt.hpp"
#include "apps/tapesim/pictures.hpp"
#include "cosim/run/new_file.hpp"

namespace tape::tapesim {
namespace {
struct RenderArguments {
  std::string folder, camera, color = "material", out;
  std::vector<int> stills;
  int width = 960, height = 540;
  bool no_ground = false;
  double track = -1;
};

render::ColorBy color_of(const std::string& name) {
  const auto names = enum_names(render::ColorBy{});
  std::size_t i = 0;
  while (names[i] != name) ++i;  // the command line has been checked
  return static_cast<render::ColorBy>(i);
}

int render(const RenderArguments& arguments) {
  const std::filesystem::path folder = arguments.folder, out = arguments.out.empty() ? folder : std::filesystem::path(arguments.out);
  const cosim::StateReader recording(folder / "state.h5");
  PictureParams params;
  params.view = {color_of(arguments.color), !arguments.no_ground, arguments.track};
  params.video.width = arguments.width;
  params.video.height = arguments.height;
  params.cameras = arguments.camera.empty() ? parse_cameras(recording.mesh().pictures) : load_cameras(arguments.camera);
  cosim::make_folder(out);
  remember_interrupts();
  for (int frame : arguments.stills) {
    const std::filesystem::path file = out / fmt::format("still_{}.png", frame);
    write_still(recording, params, frame, file);
    fmt::print("{}\n", file.string());
    if (interrupted()) return kInterrupted;
  }
  if (!arguments.stills.empty()) return kDone;
  if (!write_video(recording, params, out / "video.mp4")) {
    fmt::print("interrupted: no video; to make it, give the same command again\n");
    return kInterrupted;
  }
  fmt::print("{}\n", (out / "video.mp4").string());
  return kDone;
}
}  // namespace

void add_render(CLI::App& app, Action& chosen) {
  auto arguments = std::make_shared<RenderArguments>();
  CLI::App* command = app.add_subcommand("render", "makes a video or stills from a recorded run");
  command->add_option("RUNDIR", arguments->folder, "folder of a run; its state.h5 is read")->required();
  command->add_option("--camera", arguments->camera,
                      "YAML file with eye, target, up, fov, follow, or with fx, fy, cx, cy, width, height, position, rotation; "
                      "`camera: [{...}, {...}]`: several side by side");
  std::vector<std::string> colors;
  for (std::string_view name : enum_names(render::ColorBy{})) colors.emplace_back(name);
  command->add_option("--color", arguments->color, "what colours mean")->check(CLI::IsMember(colors));
  command
      ->add_option("--still", arguments->stills,
                   "instead of the video: a PNG of this recorded state; may be repeated; negative counts from the end")
      ->allow_extra_args(false);
  command->add_option("--width", arguments->width, "[px] of the picture, unless the camera is calibrated")->check(CLI::Range(16, 7680));
  command->add_option("--height", arguments->height, "[px] of the picture, unless the camera is calibrated")->check(CLI::Range(16, 4320));
  command->add_flag("--no-ground", arguments->no_ground, "without the ground and its lines");
  command->add_option("--track", arguments->track, "[m] paints the row of the first strip that lies here at rest")
      ->check(CLI::Range(0.0, 100.0));
  command->add_option("--out", arguments->out, "folder for the pictures (default: RUNDIR)");
  command->callback([=, &chosen] { chosen = [=] { return render(*arguments); }; });
}
}  // namespace tape::tapesim
