#pragma once
#include <string>
#include <vector>

#include "cosim/run/state_file.hpp"

/// What names in a `camera`, `video` section stand for in a recording.
namespace tape::movie {
using cosim::RecordedFrame, cosim::RecordedMesh;

/// Vertices of a strip or body.
std::vector<int> vertices_of(const RecordedMesh& mesh, const cosim::RecordedObject& object);
/// Vertices of the row of the first strip that lies nearest to this place [m] at rest.
std::vector<int> row_at(const RecordedMesh& mesh, Real along);
/// Middle [m] of the vertices of a thing, or of TAPE.tip.  @throws InputError if nothing is named so
Vec3 place_of(const std::string& name, const RecordedMesh& mesh, const RecordedFrame& frame);
/// Frame of a body, or of a link as robot:link.  @throws InputError if nothing is named so
Pose frame_of(const std::string& name, const RecordedMesh& mesh, const RecordedFrame& frame);
/// Names of what bears a force: grips, and links as robot:link.
std::vector<std::string> bearers_of(const RecordedMesh& mesh);
/// [N] magnitude of what one of these bears: contacts, adhesion, holds.
Real force_on(const std::string& bearer, const RecordedMesh& mesh, const RecordedFrame& frame);
}  // namespace tape::movie
