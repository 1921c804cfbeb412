#include "cosim/run/figures.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace cosim {
namespace {
/// Mean over the vertices of the first strip whose rest place along it is in [from, to] m.
Vec3 mean_between(const World& world, const State& state, Real from, Real to) {
  Vec3 sum = Vec3::Zero();
  int n = 0;
  for (int v = 0; v < world.assembly.strips[0].vertices; ++v) {
    const Real along = world.assembly.rest[static_cast<std::size_t>(v)].x();
    if (along < from || along > to) continue;
    sum += state.x[static_cast<std::size_t>(v)];
    ++n;
  }
  return sum / n;
}

/// Mean force [N] of a grip over the second half of the steps, when what started has settled.
Vec3 settled_force(const RunLog& log, std::size_t grip) {
  Vec3 sum = Vec3::Zero();
  const std::size_t from = log.rows.size() / 2;
  for (std::size_t r = from; r < log.rows.size(); ++r) sum += log.rows[r].report.grip_force[grip];
  return sum / static_cast<Real>(std::max<std::size_t>(1, log.rows.size() - from));
}

FigureValues tip(const World& world, const RunLog& log) {
  constexpr Real kEdge = 1e-9;  // [m]
  const Real length = world.setup.scene.strips[0].mesh.length;
  const Vec3 root = mean_between(world, log.end, -kEdge, kEdge), end = mean_between(world, log.end, length - kEdge, length + kEdge);
  return {{"tip_drop_m", root.z() - end.z()}, {"tip_reach_m", (end - root).head<2>().norm()}};
}

FigureValues grip_force(const World& world, const RunLog& log) {
  FigureValues values;
  for (std::size_t g = 0; g < world.setup.scene.grips.size(); ++g) {
    Real most = 0;
    for (const StepRow& row : log.rows) most = std::max(most, row.report.grip_force[g].norm());
    const std::string& name = world.setup.scene.grips[g].name;
    values.emplace_back("grip_force_mean_N." + name, settled_force(log, g).norm());
    values.emplace_back("grip_force_max_N." + name, most);
  }
  return values;
}

FigureValues capstan_ratio(const World&, const RunLog& log) {
  const Real a = settled_force(log, 0).norm(), b = settled_force(log, 1).norm();
  return {{"capstan_ratio", std::max(a, b) / std::min(a, b)}};
}

FigureValues body_travel(const World& world, const RunLog& log) {
  FigureValues values;
  for (std::size_t b = 0; b < world.setup.scene.bodies.size(); ++b)
    if (world.assembly.bodies[b].motion != Motion::fixed)
      values.emplace_back("travel_m." + world.setup.scene.bodies[b].name,
                          (log.end.bodies[b].pose.position - log.start.bodies[b].pose.position).norm());
  return values;
}

FigureValues rest_speed(const World&, const RunLog& log) {
  Real most = 0;
  for (const Vec3& v : log.end.v) most = std::max(most, v.norm());
  for (const BodyState& body : log.end.bodies) most = std::max(most, body.velocity.norm());
  return {{"rest_speed_m_per_s", most}};
}

FigureValues max_strain(const World&, const RunLog& log) {
  Real most = 0;
  for (const StepRow& row : log.rows) most = std::max(most, row.report.max_strain);
  return {{"max_strain", most}};
}

constexpr Figure kFigures[] = {
    {"tip", "where the tip of the first strip ends, from its root: drop along -z, reach across", tip},
    {"grip_force", "force of each grip: mean over the second half of the run, and largest", grip_force},
    {"capstan_ratio", "larger over smaller mean force of the first two grips, over the second half of the run", capstan_ratio},
    {"body_travel", "how far each body that is not static ends from where it started", body_travel},
    {"rest_speed", "largest speed of a vertex or body at the end", rest_speed},
    {"max_strain", "largest principal membrane strain of the run", max_strain},
};

const Figure* find(const std::string& name) {
  for (const Figure& figure : kFigures)
    if (figure.name == name) return &figure;
  return nullptr;
}

/// Barycentric weights of a point in a flat triangle.
Vec3 weights(const std::array<Vec2, 3>& t, const Vec2& p) {
  const auto cross = [](const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); };
  const Real area = cross(t[1] - t[0], t[2] - t[0]);
  const Real u = cross(t[2] - t[1], p - t[1]) / area, v = cross(t[0] - t[2], p - t[2]) / area;
  return {u, v, 1 - u - v};
}
}  // namespace

std::span<const Figure> all_figures() { return kFigures; }

void require_figures(const std::vector<std::string>& names, const World& world) {
  for (const std::string& name : names) {
    const auto refuse = [&](const std::string& why) { throw InputError(name + ": " + why); };
    if (!find(name)) {
      std::string known;
      for (const Figure& figure : kFigures) known += (known.empty() ? "" : ", ") + std::string(figure.name);
      refuse("there is no such figure; there are " + known);
    }
    if (name == "tip" && world.assembly.strips.empty()) refuse("the scene has no strip");
    if (name == "capstan_ratio" && world.setup.scene.grips.size() < 2) refuse("the scene has fewer than two grips");
  }
}

FigureValues measure_figures(const std::vector<std::string>& names, const World& world, const RunLog& log) {
  FigureValues values;
  if (log.rows.empty()) return values;
  for (const std::string& name : names) {
    const FigureValues more = find(name)->measure(world, log);
    values.insert(values.end(), more.begin(), more.end());
  }
  return values;
}

std::vector<Vec3> middle_line(const World& world, const State& state, int n) {
  const StripPart& strip = world.assembly.strips.at(0);
  const Real length = world.setup.scene.strips[0].mesh.length;
  std::vector<Vec3> line;
  for (int i = 0; i < n; ++i) {
    const Vec2 p(length * i / (n - 1), 0);
    Real best = -std::numeric_limits<Real>::infinity();
    Vec3 found = Vec3::Zero();
    for (int t = strip.first_triangle; t < strip.first_triangle + strip.triangles; ++t) {
      const Index3& triangle = world.assembly.triangles[static_cast<std::size_t>(t)];
      const auto at = [&](int corner) { return static_cast<std::size_t>(triangle[corner]); };
      const Vec3 w = weights({world.assembly.rest[at(0)], world.assembly.rest[at(1)], world.assembly.rest[at(2)]}, p);
      if (w.minCoeff() <= best) continue;  // the triangle that holds p best; on an edge either serves
      best = w.minCoeff();
      found = w[0] * state.x[at(0)] + w[1] * state.x[at(1)] + w[2] * state.x[at(2)];
    }
    line.push_back(found);
  }
  return line;
}
}  // namespace cosim
