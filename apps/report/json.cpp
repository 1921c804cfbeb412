#include "apps/report/json.hpp"

#include <algorithm>

#include "tape/model/strip_mesh.hpp"

namespace tape::report {
namespace {
Json effects_json(const RunSummary& summary) {
  Json effects = Json::object();
  for (const cosim::EffectSummary& e : summary.effects)
    effects[e.plan.name] = {{"on", e.plan.on}, {"why", e.plan.why}, {"ms_per_step", e.ms_per_step}};
  return effects;
}
Json conditions_json(const RunSummary& summary) {
  Json conditions = Json::array();
  for (const cosim::Condition& c : summary.conditions)
    conditions.push_back({{"name", c.name}, {"value", c.value}, {"required", c.required}, {"met", c.met}});
  return conditions;
}
Json adhesion_json(const Scene& scene, const AdhesivePair& pair) {
  const auto name = [&](int material) {  // of what has it: an object of an interface has its own
    for (const Strip& s : scene.strips)
      if (s.material == material) return s.name;
    for (const Body& b : scene.bodies)
      if (b.material == material) return b.name;
    return scene.materials[static_cast<std::size_t>(material)].name;
  };
  const Adhesion& a = pair.adhesion;
  Json json = {{"between", {name(pair.a), name(pair.b)}}, {"law", to_text(a.law)}, {"faces", Json::array()}};
  for (const Face first : {Face::backing, Face::sticky})
    for (const Face second : {Face::backing, Face::sticky})
      if (a.sticks[static_cast<int>(first)][static_cast<int>(second)]) json["faces"].push_back({to_text(first), to_text(second)});
  if (a.law == AdhesionLaw::per_pair) add_fields(json, a.pair);
  if (a.law == AdhesionLaw::per_area) add_fields(json, a.area);
  if (a.law == AdhesionLaw::bond) add_fields(json, a.bond);
  return json;
}
Json numbers(const robot::VecX& v) { return std::vector<double>(v.begin(), v.end()); }
Json robot_json(const cosim::RobotPart& part, const Scene& scene) {
  Json json = {{"model", part.model->name}, {"base", part.params.fixed_base ? "fixed" : "free"}};
  double mass = 0;
  for (const robot::Link& link : part.model->links) mass += link.inertial.mass;
  json["links"] = part.model->links.size(), json["mass_kg"] = mass;
  const Vec3 position = part.params.X_WB.translation();
  const Eigen::AngleAxisd turn(part.params.X_WB.linear());
  json["position"] = numbers(position), json["rotation_vector"] = numbers(Vec3(turn.angle() * turn.axis()));
  json["start"] = numbers(part.start), json["velocity"] = numbers(part.velocity);
  if (part.target.size() > 0) json["target"] = numbers(part.target);
  json["friction"] = part.params.friction, json["xi"] = part.xi;
  json["material"] = scene.materials[static_cast<std::size_t>(part.material)].name;
  for (std::size_t k = 0; k < part.params.drives.size(); ++k) {
    const robot::DriveGains& drive = part.params.drives[k];
    const robot::Joint& joint = part.model->joints[k];
    json["drives"][joint.name] = {{"kp", drive.kp}, {"kd", drive.kd}, {"effort", std::min(drive.effort, joint.effort)}};
  }
  for (const cosim::RobotMotion& motion : part.motions)
    json["motions"].push_back({{"start", motion.start.time}, {"after_event", motion.start.after}, {"duration", motion.duration}});
  json["assumed"] = part.model->notes;
  return json;
}
}  // namespace

Json settings_json(const Setup& setup, const cosim::RobotScene& robots) {
  Json json = Json::object();
  const Scene& scene = setup.scene;
  add_fields(json["time"], scene.time);
  add_fields(json["contact"], scene.contact);
  json["contact"]["dhat"] = scene.dhat();  // what a 0 stands for
  json["gravity"] = {scene.gravity.x(), scene.gravity.y(), scene.gravity.z()};
  json["seed"] = scene.seed;
  for (const Film& film : scene.films) add_fields(json["films"][film.name], film);
  for (const Strip& strip : scene.strips) {
    const Film& film = scene.films[static_cast<std::size_t>(strip.film)];
    add_fields(json["strips"][strip.name], strip.mesh);
    json["strips"][strip.name]["cell_length"] = cell_length(strip.mesh, film.width);  // whole cells
    json["strips"][strip.name]["film"] = film.name;
    if (strip.winding)
      json["strips"][strip.name]["winding"] = {{"radius", strip.winding->radius},
                                               {"pitch", strip.winding->pitch},
                                               {"turns", strip.winding->turns},
                                               {"settled", !strip.settled.empty()}};
  }
  for (const Material& material : scene.materials) json["materials"][material.name] = {{"mu", material.mu}};
  for (const auto& [key, pairs] : {std::pair("mu", &scene.frictions), std::pair("kappa", &scene.barriers)})
    for (const MaterialPair& pair : *pairs)
      json["interfaces"].push_back(
          {{"between", {scene.materials[static_cast<std::size_t>(pair.a)].name, scene.materials[static_cast<std::size_t>(pair.b)].name}},
           {key, pair.value}});
  for (const AdhesivePair& pair : scene.adhesives) json["adhesion"].push_back(adhesion_json(scene, pair));
  if (std::any_of(scene.strips.begin(), scene.strips.end(), [&](const Strip& s) { return scene.reduces(s); }))
    add_fields(json["cluster"], scene.cluster);
  for (const AxleJoint& axle : scene.axles) {
    json["axles"].push_back({{"body", axle.body}, {"to", axle.to}});
    add_fields(json["axles"].back(), axle.params);
  }
  for (const Blade& blade : scene.blades) json["cutting"]["blades"].push_back(blade.body);
  if (!scene.blades.empty()) add_fields(json["cutting"], setup.cutting);
  for (const cosim::RobotPart& part : robots.robots) json["robots"][part.name] = robot_json(part, scene);
  if (!robots.robots.empty()) {
    json["physics"] = {{"substep", robots.world.substep}};
    add_fields(json["exchange"], robots.exchange);
  }
  add_fields(json["solver"], setup.newton);
  add_fields(json["solver"], setup.linear);
  for_each_effect([&]<class T>(std::type_identity<T>) {
    Json section = Json::object();
    add_fields(section, params<T>(setup.effects));
    if (!section.empty()) json[std::string(T::name)] = section;
  });
  for (const auto& [name, on] : setup.forced) json["effects"][name] = on;
  return json;
}

namespace {
Json cuts_json(const RunSummary& s) {
  Json list = Json::array();
  for (const auto& [time, cut] : s.cuts) {
    Json one = {{"time_s", time}, {"blade", cut.blade}, {"strip", cut.strip}, {"pressure_Pa", cut.pressure}};
    if (!cut.refusal.empty()) {
      one["refused"] = cut.refusal;
    } else {
      one.update({{"pieces", cut.pieces},
                  {"kerf_area_m2", cut.kerf_area},
                  {"kerf_mass_kg", cut.kerf_mass},
                  {"smallest_angle_deg", cut.smallest_angle},
                  {"deviation_m", cut.deviation},
                  {"momentum_correction_m_per_s", cut.largest_change}});
    }
    list.push_back(one);
  }
  return list;
}
}  // namespace

namespace {
Json distribution_json(const cosim::Distribution& d) { return {{"mean", d.mean}, {"p50", d.p50}, {"p95", d.p95}, {"max", d.max}}; }
Json stages_json(const std::vector<StageReport>& stages) {
  Json json = Json::object();
  for (const StageReport& stage : stages) json[stage.name] = stage.ms;
  return json;
}
Json phases_json(const RunSummary& s) {
  Json list = Json::array();
  for (const cosim::PhaseSummary& p : s.phases)
    list.push_back({{"name", p.name},
                    {"start_s", p.start},
                    {"end_s", p.end},
                    {"steps", p.steps},
                    {"wall_s", p.wall},
                    {"step_ms", distribution_json(p.step_ms)},
                    {"newton_mean", p.newton_mean},
                    {"effects_ms_per_step", stages_json(p.effects)},
                    {"stages_ms_per_step", stages_json(p.stages)}});
  return list;
}
}  // namespace

Json report_json(const Provenance& provenance, const World& world, const cosim::RobotScene& robots, const RunSummary& s) {
  Json json = {{"status", s.status}};
  if (!s.failure.empty()) json["failure"] = s.failure;
  json["scene"] = world.setup.scene.name;
  json["scene_file"] = provenance.scene_file;
  json["model"] = world.setup.scene.model ? Json(to_text(*world.setup.scene.model)) : Json();
  json["backend"] = provenance.backend;
  json["threads"] = provenance.threads;
  json["version"] = provenance.version;
  json["settings"] = settings_json(world.setup, robots);
  json["steps"] = s.steps;
  json["resumed_from_step"] = provenance.first_step;
  json["sim_time_s"] = s.sim_time;
  json["wall_s"] = s.wall;
  json["real_time_factor"] = s.wall > 0 ? s.sim_time / s.wall : 0;
  json["step_ms"] = distribution_json(s.step_ms);
  json["newton"] = {{"mean", s.newton_mean}, {"max", s.newton_max}, {"failed_steps", s.failed_steps}};
  json["linear"] = {{"solver", s.linear_solver}, {"iterations_mean", s.linear_iterations_mean}};
  json["hessian_mode"] = to_text(world.setup.newton.hessian);
  json["hessian_fallbacks"] = s.hessian_fallbacks;
  json["stop_error_estimate_m"] = s.stop_error_estimate;
  json["min_gap_m"] = s.min_gap;
  json["intersections"] = s.intersections;
  json["energy_drift"] = s.energy_drift;
  json["state_hash"] = s.state_hash;
  json["effects"] = effects_json(s);
  json["stages_ms_per_step"] = stages_json(s.stages);
  if (!s.phases.empty()) json["phases"] = phases_json(s);
  if (!world.setup.scene.blades.empty()) json["cuts"] = cuts_json(s);
  json["conditions"] = conditions_json(s);
  json["figures"] = Json::object();
  for (const auto& [name, value] : s.figures) json["figures"][name] = value;
  return json;
}
}  // namespace tape::report
