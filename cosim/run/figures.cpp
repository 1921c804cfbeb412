#include "cosim/run/figures.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <optional>

#include "cosim/roll/roll_figures.hpp"
#include "cosim/run/attachment.hpp"
#include "cosim/run/summary.hpp"
#include "tape/model/motion.hpp"
#include "tape/model/strip_mesh.hpp"

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

/// First grip that moves; none: the number of grips.
std::size_t moving_grip(const Scene& scene) {
  std::size_t g = 0;
  while (g < scene.grips.size() && scene.grips[g].motion.empty()) ++g;
  return g;
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

/// Of each link that the tape side has touched: force of all contacts on it, mean over the second half of the run, and largest.
FigureValues link_force(const World& world, const RunLog& log) {
  FigureValues values;
  for (std::size_t a = 0; a < world.setup.scene.articulations.size(); ++a) {
    const std::vector<std::string>& links = world.setup.scene.articulations[a].links;
    for (std::size_t l = 0; l < links.size(); ++l) {
      Vec3 sum = Vec3::Zero();
      Real most = 0;
      int late = 0;
      for (std::size_t r = 0; r < log.rows.size(); ++r) {
        const LinkReport& link = log.rows[r].report.articulations[a].links[l];
        const Vec3 force = link.normal.force + link.friction.force + link.adhesion.force + link.hold.force;
        most = std::max(most, force.norm());
        if (2 * r >= log.rows.size()) sum += force, ++late;
      }
      if (most == 0) continue;
      values.emplace_back("link_force_mean_N." + links[l], sum.norm() / late);
      values.emplace_back("link_force_max_N." + links[l], most);
    }
  }
  return values;
}

FigureValues momentum_exchange(const World&, const RunLog& log) {
  std::optional<Real> most;
  for (const StepRow& row : log.rows)
    if (const std::optional<Real> now = row.report.exchange_residual) most = std::max(most.value_or(0), *now);
  if (!most) return {};
  return {{"momentum_exchange_residual", *most}};
}

FigureValues max_strain(const World&, const RunLog& log) {
  Real most = 0;
  for (const StepRow& row : log.rows) most = std::max(most, row.report.max_strain);
  return {{"max_strain", most}};
}

/// Strip that is a roll; none: the number of strips.
std::size_t first_roll(const World& world) {
  const std::vector<Strip>& strips = world.setup.scene.strips;
  std::size_t s = 0;
  while (s < strips.size() && !strips[s].winding) ++s;
  return s;
}
std::size_t hub_of(const World& world) { return static_cast<std::size_t>(world.setup.scene.strips[first_roll(world)].winding->hub); }

FigureValues roll(const World& world, const RunLog& log) { return roll_figures(world, log.end, first_roll(world)); }

/// Turning of the hub about its axis since the start, over the steps from when the last grip of the hub was released.
FigureValues hub_range(const World& world, const RunLog& log) {
  const std::size_t hub = hub_of(world);
  Real from = 0;
  for (const Grip& grip : world.setup.scene.grips)
    if (grip.what.object == world.setup.scene.bodies[hub].name && grip.end.at(log.end.events) <= log.end.time)
      from = std::max(from, grip.end.at(log.end.events));
  Mat3 before = log.start.bodies[hub].pose.rotation;
  Real angle = 0, least = std::numeric_limits<Real>::infinity(), most = -least;
  for (const StepRow& row : log.rows) {
    const Mat3 now = row.report.body_pose[hub].rotation, turn = before.transpose() * now;
    angle += std::atan2(turn(1, 0) - turn(0, 1), turn(0, 0) + turn(1, 1));
    before = now;
    if (row.time < from) continue;
    least = std::min(least, angle), most = std::max(most, angle);
  }
  return {{"hub_range_deg", (most - least) * 180 / std::numbers::pi}};
}

FigureValues hub_travel(const World& world, const RunLog& log) {
  const std::size_t hub = hub_of(world);
  return {{"hub_travel_m", (log.end.bodies[hub].pose.position - log.start.bodies[hub].pose.position).norm()}};
}

/// Whether an interface holds a roll together: tape on tape, or tape on hub.
bool inside_roll(const World& world, const AdhesivePair& pair) {
  const Scene& scene = world.setup.scene;
  const int tape = scene.strips[0].material, hub = scene.bodies[hub_of(world)].material;
  return (pair.a == tape && (pair.b == tape || pair.b == hub)) || (pair.a == hub && pair.b == tape);
}
/// [m] end along the first strip of what adheres: in the interfaces of the roll if it is one, else in the first; 0 where nothing does.
Real boundary(const World& world, const StepReport& report) {
  const bool roll = first_roll(world) == 0;
  Real end = 0;
  for (std::size_t k = 0; k < report.adhesion.size(); ++k)
    if (roll ? inside_roll(world, world.setup.scene.adhesives[k]) : k == 0) end = std::max(end, report.adhesion[k].to);
  return end;
}
FigureValues boundary_advance(const World& world, const RunLog& log) {
  return {{"boundary_advance_m", boundary(world, log.rows.front().report) - boundary(world, log.rows.back().report)}};
}

/// Force of the first grip that moves, along its motion, while the front of the first interface advances: from one cell on.
FigureValues peel_force(const World& world, const RunLog& log) {
  const Scene& scene = world.setup.scene;
  const std::size_t g = moving_grip(scene);
  const Strip& strip = scene.strips[0];
  const Real cell = cell_length(strip.mesh, scene.films[static_cast<std::size_t>(strip.film)].width);
  const auto front = [](const StepRow& row) { return row.report.adhesion[0].to; };
  std::vector<Real> forces;
  for (const StepRow& row : log.rows) {
    const Vec3 moved =
        grip_offset(scene.grips[g], row.time, log.end.events) - grip_offset(scene.grips[g], row.time - row.report.dt, log.end.events);
    if (moved.norm() > 0 && front(row) < front(log.rows.front()) - cell / 2 && row.report.adhesion[0].live > 0)
      forces.push_back(row.report.grip_force[g].dot(moved.normalized()));
  }
  if (forces.empty()) return {};
  const Distribution over_steps = distribution(forces);
  return {{"peel_force_median_N", over_steps.p50}, {"peel_force_mean_N", over_steps.mean}, {"peel_force_max_N", over_steps.max}};
}

FigureValues cuts(const World& world, const RunLog& log) {
  Real made = 0, refused = 0, area = 0, all = 0;
  for (const StepRow& row : log.rows)
    for (const CutReport& cut : row.cuts) {
      (cut.refusal.empty() ? made : refused) += 1;
      area += cut.kerf_area;
    }
  for (std::size_t s = 0; s < world.assembly.strips.size(); ++s) all += pieces(world, s);
  return {{"cut_events", made}, {"cuts_refused", refused}, {"kerf_area_m2", area}, {"strip_pieces", all}};
}

constexpr Figure kFigures[] = {
    {"tip", "where the tip of the first strip ends, from its root: drop along -z, reach across", tip},
    {"grip_force", "force of each grip: mean over the second half of the run, and largest", grip_force},
    {"capstan_ratio", "larger over smaller mean force of the first two grips, over the second half of the run", capstan_ratio},
    {"body_travel", "how far each body that is not static ends from where it started", body_travel},
    {"rest_speed", "largest speed of a vertex or body at the end", rest_speed},
    {"max_strain", "largest principal membrane strain of the run", max_strain},
    {"peel_force", "force of the first grip that moves, along its motion, while the first interface peels: median, mean, largest",
     peel_force},
    {"boundary_advance", "tape that has come off: way of the end of the roll, or of the first interface, along the first strip",
     boundary_advance},
    {"hub_range", "range of the hub's turning about its axis since its last grip was released", hub_range},
    {"hub_travel", "how far the centre of the hub ends from where it started", hub_travel},
    {"link_force", "force of the tape side on each link that it touches: mean over the second half of the run, and largest", link_force},
    {"momentum_exchange",
     "momentum given to robots with a free base that did not arrive, of what was given: worst step; nothing if none was touched",
     momentum_exchange},
    {"cuts", "cuts made and refused, area of their kerfs, pieces of all strips at the end", cuts},
    {"roll", "turns, length, outer radius, mass and inertia of what is wound at the end", roll},
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

std::string why_unfit(std::string_view name, const World& world) {
  const Scene& scene = world.setup.scene;
  if (name == "tip" && scene.strips.empty()) return "the scene has no strip";
  if (name == "capstan_ratio" && scene.grips.size() < 2) return "the scene has fewer than two grips";
  if ((name == "link_force" || name == "momentum_exchange") && scene.articulations.empty()) return "the scene has no robot that moves";
  if (name == "cuts" && scene.blades.empty()) return "the scene has no blade";
  const bool of_roll = name == "hub_range" || name == "hub_travel" || name == "roll";
  if (of_roll && first_roll(world) == scene.strips.size()) return "the scene has no roll";
  const bool of_interface = name == "peel_force" || name == "boundary_advance";
  if (of_interface && (scene.adhesives.empty() || scene.strips.empty())) return "no strip of the scene adheres";
  if (name == "peel_force" && moving_grip(scene) == scene.grips.size()) return "no grip of the scene moves";
  return "";
}

void require_figures(const std::vector<std::string>& names, const World& world) {
  for (const std::string& name : names) {
    const auto refuse = [&](const std::string& why) { throw InputError(name + ": " + why); };
    if (!find(name)) {
      std::string known;
      for (const Figure& figure : kFigures) known += (known.empty() ? "" : ", ") + std::string(figure.name);
      refuse("there is no such figure; there are " + known);
    }
    if (const std::string why = why_unfit(name, world); !why.empty()) refuse(why);
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
