#include "apps/movie/stage.hpp"

#include <algorithm>
#include <limits>

#include "apps/report/strain.hpp"
#include "cosim/run/summary.hpp"

namespace tape::movie {
namespace {
using render::ColorBy;
constexpr Real kRoom = 0.25;  // around the first state, of its diagonal

bool same(const render::Bounds& a, const render::Bounds& b) { return a.min() == b.min() && a.max() == b.max(); }

/// Up to what 95 % of the states stay below, so that a short impact does not leave all others dark.
render::ColorBar bar_of(ColorBy color, const std::vector<Real>& peaks) {
  if (color == ColorBy::adhesion) return {"adhesion left (beta; bond: 1)", "", 0, 1};
  if (by_thing(color)) return {};
  const bool strain = color == ColorBy::strain, tension = color == ColorBy::tension;
  const std::string title = strain ? "largest strain" : tension ? "membrane tension" : "contact force";
  const cosim::Distribution d = cosim::distribution(peaks);
  render::ColorBar bar = render::bar_over({0, d.p95}, title + (d.max > d.p95 ? ", peaks cut" : ""), strain ? "" : tension ? "N/m" : "N");
  bar.low = 0;  // what is below is slack, or there is none
  return bar;
}
}  // namespace

bool Stage::operator==(const Stage& other) const {
  return same(bounds, other.bounds) && ground == other.ground && bar.title == other.bar.title && bar.high == other.bar.high &&
         same(moving, other.moving);
}

Survey::Survey(const PictureParams& params) : color_(params.view.color), frame_motion_(params.cameras.empty()) {}

void Survey::add(const RecordedMesh& mesh, const RecordedFrame& frame) {
  const std::vector<Vec3> x = vertex_positions(mesh, frame);
  for (const Vec3& p : x) whole_.extend(p);
  if (roomy_.isEmpty() && !whole_.isEmpty()) {
    const Vec3 room = Vec3::Constant(kRoom * whole_.diagonal().norm());
    roomy_ = render::Bounds(whole_.min() - room, whole_.max() + room);
    first_ = frame.bodies;
  }
  if (frame_motion_) extend_moving(mesh, frame, x);
  if (by_thing(color_) || color_ == ColorBy::adhesion) return;
  peaks_.push_back(0);
  for (const Real value : color_values(color_, mesh, frame, x))
    if (value > peaks_.back()) peaks_.back() = value;
}

void Survey::extend_moving(const RecordedMesh& mesh, const RecordedFrame& frame, const std::vector<Vec3>& x) {
  const auto moved = [&](std::size_t b) {
    return frame.bodies[b].position != first_[b].position || frame.bodies[b].rotation != first_[b].rotation;
  };
  for (std::size_t v = 0; v < x.size(); ++v)
    if (mesh.body[v] < 0 || moved(static_cast<std::size_t>(mesh.body[v]))) moving_.extend(x[v]);
}

Stage Survey::stage() const {
  Stage stage{.bounds = roomy_.contains(whole_) ? roomy_ : whole_, .ground = whole_.min().z(), .bar = bar_of(color_, peaks_), .moving = {}};
  if (frame_motion_) stage.moving = moving_.isEmpty() ? whole_ : moving_;
  return stage;
}

bool by_thing(ColorBy color) { return color == ColorBy::material || color == ColorBy::part; }

std::vector<Real> color_values(ColorBy color, const RecordedMesh& mesh, const RecordedFrame& frame, const std::vector<Vec3>& x) {
  constexpr Real kNone = std::numeric_limits<Real>::quiet_NaN();
  if (color == ColorBy::contact_force) {
    std::vector<Real> force = frame.contact_force;
    if (mesh.strip_vertices > 0) std::fill(force.begin() + mesh.strip_vertices, force.end(), kNone);
    return force;
  }
  if (color == ColorBy::adhesion) {
    std::vector<Real> engagement = frame.engagement;
    engagement.resize(x.size(), kNone);
    return engagement;
  }
  if (color == ColorBy::tension) {
    std::vector<report::FilmStiffness> film(mesh.triangles.size());
    for (const cosim::RecordedObject& o : mesh.objects)
      for (int t = o.first_triangle; t < o.first_triangle + o.triangles; ++t) film[static_cast<std::size_t>(t)] = {o.stretch, o.poisson};
    return report::vertex_tension(mesh.triangles, mesh.rest, x, mesh.strip_vertices, film);
  }
  return report::vertex_strain(mesh.triangles, mesh.rest, x, mesh.strip_vertices);
}
Stage stage_of(const cosim::StateReader& recording, const PictureParams& params) {
  if (recording.frames() == 0) throw InputError("the recording holds no state");
  Survey survey(params);
  for (int i = 0; i < recording.frames(); ++i) {
    const RecordedFrame frame = recording.frame(i);
    survey.add(recording.mesh(frame.mesh), frame);
  }
  return survey.stage();
}
}  // namespace tape::movie
