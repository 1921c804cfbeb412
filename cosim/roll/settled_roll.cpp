#include "cosim/roll/settled_roll.hpp"

#include <algorithm>
#include <limits>
#include <sstream>
#include <type_traits>

#include "tape/core/error.hpp"

namespace cosim {
namespace {
/// Steps of a settle [s]: inertia, which is all that holds a free end of some decimetres, must not hold it up.
constexpr Real kDt = 1;
/// Newton solves a settling step to this share of the speed that counts as rest.
constexpr Real kAccuracy = 0.1;

const Strip& strip_of(const Setup& setup, std::size_t strip) { return setup.scene.strips.at(strip); }
int hub_of(const Setup& setup, std::size_t strip) { return strip_of(setup, strip).winding->hub; }

/// "prefix.name = value" of each field.
class SettingsText {
 public:
  template <class T>
  void add(const std::string& prefix, const T& settings) {
    T copy = settings;
    copy.fields([&](const char* name, auto& value, const char*, Range, const char*) { line(prefix + "." + name, text(value)); });
  }
  void line(const std::string& name, const std::string& value) { out_ += name + " = " + value + "\n"; }
  std::string str() const { return out_; }

 private:
  template <class V>
  static std::string text(const V& value) {
    if constexpr (std::is_same_v<V, Vec3>)
      return to_text(value.x()) + " " + to_text(value.y()) + " " + to_text(value.z());
    else if constexpr (std::is_same_v<V, std::string>)
      return value;
    else if constexpr (std::is_same_v<V, bool>)
      return value ? "on" : "off";
    else if constexpr (std::is_integral_v<V>)
      return std::to_string(value);
    else
      return to_text(value);
  }
  std::string out_;
};

std::string first_difference(const std::string& a, const std::string& b) {
  std::istringstream left(a), right(b);
  std::string of_a, of_b;
  while (std::getline(left, of_a) && std::getline(right, of_b))
    if (of_a != of_b) return "it was wound with " + of_a + ", the scene says " + of_b;
  return "it was wound with other settings";
}

/// Inside a roll every pair adheres at once, and slip counts from then on: counted from the start of each step it would never end, for
/// layers of chords drive each other towards where corner lies on corner.
void engage_pairs(Scene& scene) {
  for (AdhesivePair& pair : scene.adhesives) {
    pair.adhesion.pair.beta0 = 1;
    pair.adhesion.pair.slip = SlipFrom::bonding;
  }
}
/// Area sticks wherever it lies in the contact band.
Setup with_area_engaged(Setup setup) {
  for (AdhesivePair& pair : setup.scene.adhesives) pair.adhesion.area.reach = 1;
  return setup;
}
}  // namespace

bool holds_together(const Setup& setup, std::size_t strip) {
  const Strip& tape = strip_of(setup, strip);
  if (!tape.winding) return false;
  const AdhesionLaw law = setup.scene.adhesion(tape.material, tape.material).law;
  bool holds = false;
  for_each_effect([&]<class T>(std::type_identity<T>) {
    if constexpr (Remembers<T>) {
      const auto forced = setup.forced.find(std::string(T::name));
      holds |= law == T::of_law && (forced == setup.forced.end() || forced->second);
    }
  });
  return holds;
}

Setup roll_alone(const Setup& setup, std::size_t strip) {
  Setup alone = setup;
  Scene& scene = alone.scene;
  const Scene& full = setup.scene;
  Strip tape = strip_of(setup, strip);
  Body hub = full.bodies.at(static_cast<std::size_t>(hub_of(setup, strip)));
  const Pose& roll = tape.pose;
  hub.pose = {roll.rotation.transpose() * hub.pose.rotation, roll.rotation.transpose() * (hub.pose.position - roll.position)};
  hub.motion = Motion::fixed;
  hub.velocity.setZero(), hub.angular_velocity.setZero();
  tape.pose = {}, tape.velocity.setZero(), tape.settled.clear();
  tape.winding->hub = 0;
  const auto inside = [&](int a) { return a == tape.material || a == hub.material; };
  for (std::vector<MaterialPair>* pairs : {&scene.frictions, &scene.barriers})
    std::erase_if(*pairs, [&](const MaterialPair& p) { return !inside(p.a) || !inside(p.b); });
  std::erase_if(scene.adhesives, [&](const AdhesivePair& a) { return !inside(a.a) || !inside(a.b); });
  engage_pairs(scene);
  scene.contact.dhat = full.dhat();
  scene.films = {full.films.at(static_cast<std::size_t>(tape.film))};
  tape.film = 0;
  scene.strips = {tape};
  scene.bodies = {hub};
  scene.grips.clear(), scene.axles.clear(), scene.articulations.clear(), scene.blades.clear();
  scene.model.reset();
  scene.sleep = {};
  scene.gravity.setZero();
  scene.time = {.dt = kDt, .duration = 1};
  alone.newton = {.velocity_tol = kAccuracy * SettleParams{}.speed};
  alone.linear = {};
  alone.memory = {};
  return alone;
}

SettledRoll settle_roll(const Setup& alone, const SettleParams& params) {
  Setup cohesive = alone;
  bool other_law = false;
  for (AdhesivePair& pair : cohesive.scene.adhesives) other_law |= pair.adhesion.law != AdhesionLaw::per_pair;
  for (AdhesivePair& pair : cohesive.scene.adhesives) pair.adhesion.law = AdhesionLaw::per_pair;
  cohesive.forced.erase(std::string(Cohesion::name));
  const std::string name = "roll '" + alone.scene.strips[0].name + "'";
  SettledRoll roll{World::build(cohesive), {}, {}};
  roll.state = State::start(roll.world);
  const auto go_on = [&](const SettleParams& how) {
    const std::unique_ptr<Stepper> stepper = make_stepper(Backend::cpu, roll.world);
    const int before = roll.report.steps;
    SettleParams from_here = how;
    if (how.go_on) from_here.go_on = [&](int steps, Real speed) { return how.go_on(before + steps, speed); };
    roll.report = settle(*stepper, roll.state, from_here);
    roll.report.steps += before;
    if (roll.report.stopped) throw Interrupted(name + ": interrupted while it settled");
    if (!roll.report.failure.empty()) throw NumericalError(name + " does not come to rest: " + roll.report.failure);
  };
  go_on(params);
  if (!other_law) return roll;
  Setup wanted = alone;
  wanted.scene.strips[0].settled = roll.state.x;
  roll.world = World::build(with_area_engaged(wanted));
  roll.state = State::start(roll.world);
  SettleParams one_step = params;
  one_step.speed = std::numeric_limits<Real>::infinity();
  go_on(one_step);  // from then on what comes near sticks as its law says: engaged all along, a free end would wind itself up
  roll.world = World::build(wanted);
  go_on(params);
  roll.world.setup.scene.strips[0].settled.clear();
  return roll;
}

std::string roll_settings(const Setup& alone) {
  SettingsText text;
  const Scene& scene = alone.scene;
  const Strip& tape = scene.strips.at(0);
  const Body& hub = scene.bodies.at(0);
  text.add("film", scene.films.at(0));
  text.add("strip", tape.mesh);
  text.line("seed", std::to_string(scene.seed));
  text.line("roll.radius", to_text(tape.winding->radius));
  text.line("roll.pitch", to_text(tape.winding->pitch));
  text.line("roll.turns", to_text(tape.winding->turns));
  for (const Vec3& v : hub.mesh.vertices) text.line("hub vertex", to_text(v.x()) + " " + to_text(v.y()) + " " + to_text(v.z()));
  text.add("contact", scene.contact);
  const auto name = [&](int m) { return m == tape.material ? m == hub.material ? "tape and hub" : "tape" : "hub"; };
  for (const int a : {tape.material, hub.material})
    for (const int b : {tape.material, hub.material})
      for (const auto& [key, value] : {std::pair("mu", scene.mu(a, b)), std::pair("kappa", scene.kappa(a, b))})
        text.line(std::string(key) + " of " + name(a) + " on " + name(b), to_text(value));
  for (const AdhesivePair& pair : scene.adhesives) {
    const std::string between = std::string(name(pair.a)) + " on " + name(pair.b);
    const Adhesion& a = pair.adhesion;
    text.line(between + ": law", to_text(a.law));
    for (const auto& row : a.sticks) text.line(between + ": faces", std::string(row[0] ? "1" : "0") + (row[1] ? "1" : "0"));
    text.add(between, a.pair);  // whatever the law: cohesion of pairs settles the roll
    if (a.law == AdhesionLaw::per_area) text.add(between, a.area);
    if (a.law == AdhesionLaw::bond) text.add(between, a.bond);
  }
  for_each_effect([&]<class T>(std::type_identity<T>) { text.add(std::string(T::name), params<T>(alone.effects)); });
  for (const auto& [effect, on] : alone.forced) text.line("effects." + effect, on ? "on" : "off");
  return text.str();
}

void save_roll(const std::filesystem::path& file, const SettledRoll& roll) {
  save_snapshot(file.string(), roll.world, roll.state, roll_settings(roll.world.setup));
}

SettledRoll load_roll(const std::filesystem::path& file, const Setup& alone) {
  const std::string settings = snapshot_settings(file.string()), wanted = roll_settings(alone);
  if (settings != wanted) throw InputError(file.string() + ": not a roll of this scene: " + first_difference(settings, wanted));
  SettledRoll roll{World::build(alone), {}, {}};
  roll.state = load_snapshot(file.string(), roll.world);
  return roll;
}

void place_roll(const SettledRoll& roll, std::size_t strip, Setup& setup) {
  setup.scene.strips.at(strip).settled = roll.state.x;
  const Assembly a = assemble(setup.scene);
  const StripPart& tape = a.strips.at(strip);
  const BodyPart& hub = a.bodies.at(static_cast<std::size_t>(hub_of(setup, strip)));
  const auto vertex = [&](int v) { return v < tape.vertices ? tape.first_vertex + v : hub.first_vertex + v - tape.vertices; };
  const auto triangle = [&](int t) { return t < tape.triangles ? tape.first_triangle + t : hub.first_triangle + t - tape.triangles; };
  const auto append = [&]<class T>(const MemoryOf<T>& from, MemoryOf<T>& to) {
    if constexpr (Remembers<T>) {
      for (typename T::Memory m : from.pairs) {
        if constexpr (Samples<T>) {
          const int samples = params<T>(setup.effects).samples, each = samples * samples;
          m.sample = triangle(m.sample / each) * each + m.sample % each;
        } else {
          m.vertex = vertex(m.vertex);
        }
        m.triangle = triangle(m.triangle);
        to.pairs.push_back(m);
      }
      std::sort(to.pairs.begin(), to.pairs.end(), [](const auto& p, const auto& q) { return p.key() < q.key(); });
    }
  };
  std::apply([&](const auto&... from) { (append(from, std::get<std::remove_cvref_t<decltype(from)>>(setup.memory)), ...); },
             roll.state.memory);
}
}  // namespace cosim
