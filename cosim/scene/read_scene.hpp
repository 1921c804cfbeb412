#pragma once
#include "cosim/scene/scene_file.hpp"
#include "tape/model/scene.hpp"

namespace cosim {
/// Everything of a scene file that a tape::Scene holds: scene, film, time, contact, gravity, seed, strip or strips, roll, bodies,
/// materials, interfaces, script. README.md describes them.
/// @throws InputError "file:line: key = value: reason"
tape::Scene read_scene(const SceneFile& file);

/// A film out of data/tapes/. @param asked_by  the place that names it
tape::Film load_film(const Reader& asked_by, const std::filesystem::path& scene_file);
}  // namespace cosim
