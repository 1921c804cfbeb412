#include "apps/tapesim/study_error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "apps/report/closed_forms.hpp"
#include "tape/math/rotation.hpp"

namespace tape::tapesim {
namespace {
constexpr Real kSame = 1e-9;  // [m] places along the strip closer than this are one row

/// Where the first strip is clamped. A bending hinge in the last held row belongs half to the free part and half to the held one, so
/// that the strip bends as one clamped half a cell before that row.
struct Clamp {
  Real last_row;  ///< [m] along the strip
  Real cell;      ///< [m]
};
Clamp find_clamp(const World& world) {
  std::set<Real> held;
  if (!world.assembly.strips.empty())
    for (const Assembly::GripPart& grip : world.assembly.grips)
      for (int v : grip.vertices)
        if (v < world.assembly.strips[0].vertices) held.insert(world.assembly.rest[static_cast<std::size_t>(v)].x());
  const Real last = held.empty() ? 0 : *held.rbegin();
  const auto before = std::find_if(held.rbegin(), held.rend(), [&](Real along) { return along < last - kSame; });
  if (before == held.rend()) throw InputError("heavy_elastica: the first strip needs a grip on two rows or more at its root");
  return {last, last - *before};
}

Vec3 row_centre(const World& world, const State& state, Real along) {
  Vec3 sum = Vec3::Zero();
  int n = 0;
  for (int v = 0; v < world.assembly.strips[0].vertices; ++v)
    if (std::abs(world.assembly.rest[static_cast<std::size_t>(v)].x() - along) < kSame) {
      sum += state.x[static_cast<std::size_t>(v)];
      ++n;
    }
  return sum / n;
}

Real elastica_error(const World& world, const cosim::RunLog& log) {
  const Scene& scene = world.setup.scene;
  const Clamp clamp = find_clamp(world);
  const Film& film = scene.films[static_cast<std::size_t>(scene.strips[0].film)];
  const Real length = scene.strips[0].mesh.length - clamp.last_row + clamp.cell / 2;
  const Real stiffness = film.plate_stiffness() * (1 - film.poisson * film.poisson);  // [N m] per width, of a beam
  const Real weight = film.density * film.thickness * scene.gravity.norm();           // [N/m^2]
  const report::ElasticaTip exact = report::heavy_elastica(weight * length * length * length / stiffness);
  const Vec3 root = row_centre(world, log.end, clamp.last_row), tip = row_centre(world, log.end, scene.strips[0].mesh.length);
  const Real drop = (root.z() - tip.z()) / length, reach = ((tip - root).head<2>().norm() + clamp.cell / 2) / length;
  return std::max(std::abs(drop - exact.drop), std::abs(reach - exact.reach));
}

Real capstan_error(const World& world, const cosim::RunLog& log, Real angle) {
  const Scene& scene = world.setup.scene;
  if (scene.strips.empty() || scene.bodies.empty() || scene.grips.size() < 2)
    throw InputError("capstan: the scene needs a strip, a body and two grips");
  const Real mu = scene.mu(scene.strips[0].material, scene.bodies[0].material);
  const Real ratio = cosim::measure_figures({"capstan_ratio"}, world, log).at(0).second;
  return std::abs(ratio / report::capstan_ratio(mu, angle) - 1);
}

Real kendall_error(const World& world, const cosim::RunLog& log, Real angle) {
  if (const std::string why = cosim::why_unfit("peel_force", world); !why.empty()) throw InputError("kendall: " + why);
  const Scene& scene = world.setup.scene;
  const Adhesion& first = scene.adhesives[0].adhesion;
  if (first.law != AdhesionLaw::per_area)
    throw InputError("kendall: the law of the first interface must be per_area, which has a toughness");
  const Film& film = scene.films[static_cast<std::size_t>(scene.strips[0].film)];
  const Real exact = film.width * report::peel_force(first.area.toughness, angle, film.membrane_modulus * film.thickness);
  for (const auto& [name, value] : cosim::measure_figures({"peel_force"}, world, log))
    if (name == "peel_force_mean_N") return std::abs(value / exact - 1);
  throw NothingMeasured("nothing was peeled");
}

/// The hub of the first roll at equal times over the run.
void follow_hub(const World& world, const cosim::RunLog& log, Measured& measured) {
  constexpr int kTimes = 500;
  if (const std::string why = cosim::why_unfit("hub_travel", world); !why.empty()) throw InputError("measure = hub_path: " + why);
  const auto hub =
      static_cast<std::size_t>(std::find_if(world.setup.scene.strips.begin(), world.setup.scene.strips.end(), [](const Strip& s) {
                                 return s.winding.has_value();
                               })->winding->hub);
  std::size_t row = 0;
  for (int k = 1; k <= kTimes; ++k) {
    const Real time = log.start.time + (log.rows.back().time - log.start.time) * k / kTimes;
    while (row + 1 < log.rows.size() && log.rows[row].time < time - 1e-9) ++row;
    const Pose& pose = log.rows[row].report.body_pose[hub];
    measured.points.push_back(pose.position);
    measured.turns.push_back(rotation_log(pose.rotation));
  }
}

Real figure_value(const std::string& key, const World& world, const cosim::RunLog& log) {
  std::vector<std::string> names;
  for (const cosim::Figure& figure : cosim::all_figures())
    if (cosim::why_unfit(figure.name, world).empty()) names.emplace_back(figure.name);
  std::string known;
  for (const auto& [name, value] : cosim::measure_figures(names, world, log)) {
    if (name == key) return value;
    known += (known.empty() ? "" : ", ") + name;
  }
  for (const std::string& name : names)
    if (key.starts_with(name)) throw NothingMeasured(key + ": the run has no such value");
  throw InputError("measure = " + key + ": the scene has no such figure; it has state, hub_path, " + known);
}
}  // namespace

Measured measure(const Reference& reference, const World& world, const cosim::RunLog& log) {
  if (log.rows.empty()) throw InputError("a study needs a scene with at least one step: time.duration / time.dt");
  Measured measured;
  if (reference.kind == Reference::Kind::heavy_elastica) {
    measured.error = elastica_error(world, log);
  } else if (reference.kind == Reference::Kind::capstan) {
    measured.error = capstan_error(world, log, reference.angle);
  } else if (reference.kind == Reference::Kind::kendall) {
    measured.error = kendall_error(world, log, reference.angle);
  } else if (reference.measure == "state") {
    if (world.assembly.strips.empty()) throw InputError("measure = state: the scene has no strip");
    measured.points = cosim::middle_line(world, log.end, 101);
  } else if (reference.measure == "hub_path") {
    follow_hub(world, log, measured);
    measured.value = figure_value("hub_range_deg", world, log);
  } else {
    measured.value = figure_value(reference.measure, world, log);
  }
  return measured;
}

Real distance(const Reference& reference, const Measured& run, const Measured& finest) {
  if (finest.points.empty()) return std::abs(run.value - finest.value);
  Real most = 0, sum = 0;
  for (std::size_t i = 0; i < run.points.size(); ++i) {
    const Real apart = (run.points[i] - finest.points[i]).norm();
    most = std::max(most, apart), sum += apart * apart;
  }
  return reference.measure == "state" ? most : std::sqrt(sum / static_cast<Real>(run.points.size()));
}

Real turn_distance(const Measured& run, const Measured& finest) {
  Real sum = 0;
  for (std::size_t i = 0; i < run.turns.size(); ++i)
    sum += rotation_log(rotation_exp(run.turns[i]) * rotation_exp(finest.turns[i]).transpose()).squaredNorm();
  return run.turns.empty() ? 0 : std::sqrt(sum / static_cast<Real>(run.turns.size())) * 180 / std::numbers::pi;
}

std::string error_label(const Reference& reference) {
  switch (reference.kind) {
    case Reference::Kind::heavy_elastica:
      return "error of tip drop and reach / length, against the exact curve";
    case Reference::Kind::capstan:
      return "relative error of the pull ratio, against exp(mu angle)";
    case Reference::Kind::kendall:
      return "relative error of the mean peel force, against Kendall's";
    case Reference::Kind::finest:
      break;
  }
  if (reference.measure == "state") return "largest distance of middle lines from the finest run [m]";
  if (reference.measure == "hub_path") return "RMS distance of the hub's centre from the finest run [m]";
  return "difference of " + reference.measure + " from the finest run";
}
}  // namespace tape::tapesim
