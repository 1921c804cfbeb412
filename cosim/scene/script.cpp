#include "cosim/scene/script.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "cosim/scene/pose.hpp"
#include "cosim/scene/robots.hpp"

namespace cosim {
namespace {
using tape::Grip;
using tape::GripTarget;
using tape::Moment;

constexpr Real kForever = 1e6;    // [s]
constexpr Real kRoundOff = 1e-9;  // [s] of times that are sums
const Range kTime = Range::closed(0, kForever);

class Compiler {
 public:
  Compiler(const SceneFile& file, const std::vector<tape::StripMesh>& meshes, tape::Scene& scene, RobotScene& robots)
      : file_(file), meshes_(meshes), scene_(scene), robots_(robots) {}

  void entry(const Reader& entry) {
    if (!entry.is_map()) entry.fail("must be a section such as {wait: 1}");
    const Reader at = entry["at"];
    const Moment start = at ? Moment(at.number(kTime, "s")) : now_;
    if (entry["grip"]) {
      grip(entry, start);
    } else if (entry["move"]) {
      move(entry, start);
    } else if (entry["release"]) {
      release(entry, start);
    } else if (const Reader name = entry["phase"]) {
      phase(name, start);
    } else if (entry["robot"]) {
      go_on(entry, start, add_robot_motion(entry, file_, start, nominal(start), nominal_times(), robots_));
    } else if (const Reader until = entry["wait_until"]) {
      now_ = {0, event(until, start, entry["timeout"].number(Range::above(0, kForever), "s"))};
    } else if (const Reader wait = entry["wait"]) {
      now_ = {start.time + wait.number(kTime, "s"), start.after};
    } else {
      entry.fail("must hold one of grip, move, phase, release, robot, wait, wait_until");
    }
  }
  Script script() && { return {std::move(events_), std::move(phases_)}; }

 private:
  /// When each event happens if none does before its time is over.
  std::vector<Real> nominal_times() const {
    std::vector<Real> times;
    for (const Event& e : events_) times.push_back(e.start.at(times) + e.timeout);
    return times;
  }
  Real nominal(const Moment& m) const { return m.at(nominal_times()); }

  /// @return its index
  int event(const Reader& what, const Moment& start, Real timeout) {
    events_.push_back({read_claim(what, scene_, robots_), start, timeout});
    return static_cast<int>(events_.size()) - 1;
  }
  /// After an entry that takes `duration` [s], or stops before if it says until when.
  /// @param until  of the move
  void go_on(const Reader& entry, const Moment& start, const Lasting& lasting) {
    if (const Reader until = entry["until"]) *lasting.until = event(until, start, lasting.duration);
    now_ = !entry["wait"].flag_or(true) ? start
           : *lasting.until < 0         ? Moment(start.time + lasting.duration, start.after)
                                        : Moment(0, *lasting.until);
  }

  void grip(const Reader& entry, const Moment& start) {
    Grip grip;
    grip.what = target(entry);
    const Reader name = entry["as"];
    grip.name = name.text_or(entry["grip"].is_map() ? grip.what.object : entry["grip"].text());
    if (find(grip.name)) (name ? name : entry["grip"]).fail("there is a grip of this name already");
    grip.stiffness = entry["stiffness"].number_or(0, Range::positive(), "N/m");
    grip.start = start;
    if (const Reader to = entry["to"]) {
      grip.to = scene_.bodies[choose(to, body_names())].name;
      if (grip.to == grip.what.object) to.fail("a body cannot be gripped to itself");
    }
    scene_.grips.push_back(std::move(grip));
    now_ = start;
  }

  void move(const Reader& entry, const Moment& start) {
    const Reader name = entry["move"];
    Grip& grip = held(name, start);
    if (!grip.to.empty()) name.fail("this grip ties to " + grip.to + " and moves with it");
    const Vec3 by = entry["by"].vector(kPlace, "m");
    const Reader speed = entry["speed"], duration = entry["duration"];
    if (speed.exists() == duration.exists()) entry.fail("needs either speed or duration");
    const Real time = speed ? by.norm() / speed.number(Range::above(0, 1e4), "m/s") : duration.number(Range::above(0, kForever), "s");
    if (!(time > 0)) entry["by"].fail("a move with a speed needs a length");
    if (!grip.motion.empty()) {
      const Grip::Move& last = grip.motion.back();
      const Real end = nominal(last.start) + last.duration;
      if (nominal(start) < end - kRoundOff)
        name.fail("starts at " + tape::to_text(nominal(start)) + " s, before the move ahead of it ends at " + tape::to_text(end) + " s");
    }
    grip.motion.push_back({start, time, by});
    go_on(entry, start, {time, &grip.motion.back().until});
  }

  void release(const Reader& entry, const Moment& start) {
    held(entry["release"], start).end = start;
    now_ = start;
  }

  void phase(const Reader& entry, const Moment& start) {
    const std::string name = entry.text();
    const auto plain = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-'; };
    if (name.empty() || !std::isalpha(static_cast<unsigned char>(name[0])) || !std::ranges::all_of(name, plain))
      entry.fail("the name of a phase, which files bear, starts with a letter (allowed after it: letters, digits, _, -)");
    if (name.size() > 64) entry.fail("the name of a phase has up to 64 characters, as files bear it");
    if (std::ranges::find(phases_, name, &Phase::name) != phases_.end()) entry.fail("there is a phase of this name already");
    if (!phases_.empty() && nominal(start) < nominal(phases_.back().start))
      entry.fail("begins before the phase ahead of it, " + phases_.back().name);
    phases_.push_back({name, start});
    now_ = start;
  }

  /// The grip of that name, which must hold at `time`.
  Grip& held(const Reader& name, const Moment& at) {
    const Real time = nominal(at);
    std::vector<std::string> names;
    for (const Grip& g : scene_.grips) names.push_back(g.name);
    if (names.empty()) name.fail("no grip has been made yet");
    Grip& grip = scene_.grips[choose(name, names)];
    if (time < nominal(grip.start)) name.fail("is gripped at " + tape::to_text(nominal(grip.start)) + " s only");
    if (time >= nominal(grip.end)) name.fail("was released at " + tape::to_text(nominal(grip.end)) + " s");
    return grip;
  }
  const Grip* find(const std::string& name) const {
    const auto it = std::find_if(scene_.grips.begin(), scene_.grips.end(), [&](const Grip& g) { return g.name == name; });
    return it == scene_.grips.end() ? nullptr : &*it;
  }

  GripTarget target(const Reader& entry) const {
    const Reader what = entry["grip"];
    if (what.is_map()) return points_of(what);
    const std::string text = what.text();
    const std::size_t dot = text.rfind('.');
    for (std::size_t s = 0; s < scene_.strips.size() && dot != std::string::npos; ++s)
      if (scene_.strips[s].name == text.substr(0, dot)) return part_of(s, text.substr(dot + 1), entry);
    std::vector<std::string> names = body_names();
    for (const tape::Strip& strip : scene_.strips)
      for (const char* part : {".tip", ".root", ".rows"}) names.push_back(strip.name + part);
    return corners_of(scene_.bodies[choose(what, names)], what);
  }

  GripTarget part_of(std::size_t s, const std::string& part, const Reader& entry) const {
    const tape::Strip& strip = scene_.strips[s];
    const Real cell = tape::cell_length(strip.mesh, scene_.films[strip.film].width);
    GripTarget target{.object = strip.name, .vertices = {}, .points = {}};
    if (part == "root") {
      target.vertices = root_vertices(meshes_[s], cell / 4);
    } else if (part == "tip") {
      target.vertices = tip_vertices(meshes_[s], cell / 4);
    } else if (part == "rows") {
      const int last = static_cast<int>(std::round(strip.mesh.length / cell));
      const Reader rows = entry["rows"];
      const std::vector<Real> range = rows.numbers(2, Range::closed(-last - 1, last), "rows; -1 is the last");
      const auto from_start = [&](Real row) { return std::round(row < 0 ? row + last + 1 : row); };
      target.vertices = vertices_between(meshes_[s], (from_start(range[0]) - 0.4) * cell, (from_start(range[1]) + 0.4) * cell);
      if (target.vertices.empty()) rows.fail("there are no vertices");
    } else {
      entry["grip"].fail("unknown part of a strip (allowed: tip, root, rows)");
    }
    return target;
  }
  /// Points of a body: `point` alone leaves its rotation free.
  GripTarget points_of(const Reader& what) const {
    const tape::Body& body = scene_.bodies[choose(what["body"], body_names())];
    require_dynamic(body, what["body"]);
    GripTarget target{.object = body.name, .vertices = {}, .points = {}};
    for (const Reader& point : what["points"].items()) target.points.push_back(point.vector(kPlace, "m"));
    if (const Reader point = what["point"]) target.points.push_back(point.vector(kPlace, "m"));
    if (target.points.empty()) what.fail("needs point: [x, y, z] or points: [[x, y, z], ...], in the frame of the body's mesh");
    return target;
  }
  /// The corners of a body's box: holds its position and its rotation.
  GripTarget corners_of(const tape::Body& body, const Reader& what) const {
    require_dynamic(body, what);
    Vec3 low = body.mesh.vertices[0], high = low;
    for (const Vec3& v : body.mesh.vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
    GripTarget target{.object = body.name, .vertices = {}, .points = {}};
    for (Real x : {low.x(), high.x()})
      for (Real y : {low.y(), high.y()})
        for (Real z : {low.z(), high.z()}) target.points.push_back({x, y, z});
    return target;
  }
  static void require_dynamic(const tape::Body& body, const Reader& where) {
    if (body.motion != tape::Motion::dynamic) where.fail("the body is " + to_text(body.motion) + "; only a dynamic one can be gripped");
  }
  std::vector<std::string> body_names() const {
    std::vector<std::string> names;
    for (const tape::Body& body : scene_.bodies) names.push_back(body.name);
    return names;
  }

  const SceneFile& file_;
  const std::vector<tape::StripMesh>& meshes_;
  tape::Scene& scene_;
  RobotScene& robots_;
  Moment now_;
  std::vector<Event> events_;
  std::vector<Phase> phases_;
};
}  // namespace

Script read_script(const SceneFile& file, const std::vector<tape::StripMesh>& meshes, tape::Scene& scene, RobotScene& robots) {
  Compiler compiler(file, meshes, scene, robots);
  for (const Reader& entry : file["script"].items()) compiler.entry(entry);
  Script script = std::move(compiler).script();
  scene.events = static_cast<int>(script.events.size());
  return script;
}
}  // namespace cosim
