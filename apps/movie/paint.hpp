#pragma once
#include "apps/movie/stage.hpp"
#include "apps/render/scene.hpp"

namespace tape::movie {
/// The surfaces of a state in their colours.
render::RenderScene painted(const ViewParams& view, const Stage& stage, const RecordedMesh& mesh, const RecordedFrame& frame);
/// What explains these colours.
render::Legend legend_of(const ViewParams& view, const Stage& stage, const RecordedMesh& mesh);
}  // namespace tape::movie
