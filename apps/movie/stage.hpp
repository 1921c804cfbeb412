#pragma once
#include <vector>

#include "apps/movie/params.hpp"
#include "cosim/run/state_file.hpp"

namespace tape::movie {
using cosim::RecordedFrame, cosim::RecordedMesh;

/// What all pictures of a motion have in common.
struct Stage {
  render::Bounds bounds;  ///< [m] that shadows are drawn in
  Real ground = 0;        ///< [m] height
  render::ColorBar bar;   ///< what colours mean, where they mean values
  render::Bounds moving;  ///< [m] of strips and bodies that move; looked at where the cameras are left open
  bool operator==(const Stage& other) const;
};

/// Finds the stage of a motion, from its first state on.
class Survey {
 public:
  explicit Survey(const PictureParams& params);
  void add(const RecordedMesh& mesh, const RecordedFrame& frame);
  /// Of the motion so far. The first state gives some room around it, so that most motions keep the stage that they begin on.
  Stage stage() const;

 private:
  void extend_moving(const RecordedMesh& mesh, const RecordedFrame& frame, const std::vector<Vec3>& x);
  render::ColorBy color_;
  bool frame_motion_;
  std::vector<Pose> first_;  // of bodies
  render::Bounds roomy_, whole_, moving_;
  std::vector<Real> peaks_;  // of each state
};

/// That of a whole recording.  @throws InputError where it holds no state
Stage stage_of(const cosim::StateReader& recording, const PictureParams& params);

/// Whether colours tell things apart, not values.
bool by_thing(render::ColorBy color);
/// [nv] what colours mean: of strips; forces of bodies only where there is no strip, for they stand on vertices that may be far from where
/// the contact is.
std::vector<Real> color_values(render::ColorBy color, const RecordedMesh& mesh, const RecordedFrame& frame, const std::vector<Vec3>& x);
}  // namespace tape::movie
