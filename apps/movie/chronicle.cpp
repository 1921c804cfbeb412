#include "apps/movie/chronicle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "apps/movie/things.hpp"

namespace tape::movie {
namespace {
constexpr Real kFlash = 0.5;  // [s] for which a cut is told
constexpr Real kHistory = 5;  // [s] that a chart looks back
}  // namespace

Chronicle::Chronicle(const std::vector<std::string>& bearers) : cut_(-std::numeric_limits<Real>::infinity()) {
  for (const std::string& bearer : bearers) charts_.push_back({.name = bearer, .unit = "N", .points = {}});
}

void Chronicle::add(const RecordedMesh& mesh, const RecordedFrame& frame) {
  time_ = frame.time;
  if (frame.mesh > std::exchange(mesh_, frame.mesh)) cut_ = time_;
  caption_ = fmt::format("{}   t = {:.2f} s", mesh.scene, time_);
  if (frame.phase >= 0) caption_ += "   " + mesh.phases[static_cast<std::size_t>(frame.phase)];
  for (render::Chart& chart : charts_) {
    const Real force = force_on(chart.name, mesh, frame);
    chart.points.emplace_back(time_, force);
    chart.high = std::max(chart.high, force);
    chart.from = std::max(chart.points[0].x(), time_ - kHistory), chart.to = chart.from + kHistory;
  }
}

bool Chronicle::just_cut() const { return time_ < cut_ + kFlash; }
}  // namespace tape::movie
