#include "cosim/scene/read_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "cosim/scene/bodies.hpp"
#include "cosim/scene/folder_name.hpp"
#include "cosim/scene/node.hpp"
#include "cosim/scene/pose.hpp"
#include "cosim/scene/robots.hpp"
#include "cosim/scene/roll.hpp"
#include "cosim/scene/script.hpp"
#include "tape/model/sharp_edge.hpp"
#include "tape/model/strip_mesh.hpp"

namespace cosim {
namespace {
using tape::InputError;
using tape::Scene;
using tape::Strip;

class SceneReader {
 public:
  explicit SceneReader(const SceneFile& file) : file_(file) {}

  BothWorlds read() {
    scene_.name = file_["scene"].text_or(file_.path().stem().string());
    require_folder_name(file_["scene"], scene_.name);
    time();
    file_.read("contact", scene_.contact);
    file_.read("cluster", scene_.cluster);
    file_.read("sleep", scene_.sleep);
    scene_.gravity = file_["gravity"].vector_or(scene_.gravity, kPlace, "m/s^2");
    scene_.seed = file_["seed"].integer_or(scene_.seed, Range::non_negative());
    materials();
    if (const Reader film = file_["film"]) scene_.films.push_back(load_film(film, file_.path()));
    strips();
    bodies();
    robots();
    require_materials_used();
    for (const Reader& entry : file_["interfaces"].items()) interface(entry);
    model();
    for (const Reader& entry : file_["cutting"]["blades"].items()) blade(entry);
    for (const Reader& entry : file_["axles"].items()) axle(entry);
    Script script = read_script(file_, meshes_, scene_, robots_);
    std::vector<Goal> goals = read_goals(file_, scene_, robots_);
    if (scene_.strips.empty() && scene_.bodies.empty()) file_.root().fail("there is nothing to simulate: neither a strip nor a body");
    return {std::move(scene_), std::move(robots_), std::move(script.events), std::move(goals), std::move(script.phases)};
  }

 private:
  void time() {
    const Reader section = file_["time"];
    section.read(scene_.time);
    const Real steps = scene_.time.duration / scene_.time.dt;
    if (constexpr Real kMostSteps = 1e9; !(steps <= kMostSteps))
      section["duration"].fail("asks for " + tape::to_text(steps) + " steps of time.dt (allowed: at most " + tape::to_text(kMostSteps) +
                               ")");
  }
  void materials() {
    const Reader section = file_["materials"];
    for (const std::string& name : section.keys()) section[name].read(scene_.materials[material(name)]);
  }
  /// A name that nothing has is a slip of the pen. What says nothing of its material is made of `default`.
  void require_materials_used() const {
    std::set<int> used;
    for (const Strip& strip : scene_.strips) used.insert(strip.material);
    for (const tape::Body& body : scene_.bodies) used.insert(body.material);
    for (const RobotPart& robot : robots_.robots) used.insert(robot.material);
    std::set<std::string, std::less<>> names;
    for (int m : used) names.insert(scene_.materials[static_cast<std::size_t>(m)].name);
    const Reader section = file_["materials"];
    for (const std::string& name : section.keys())
      if (name != "default" && !names.contains(name)) section[name].fail("nothing is made of it; " + suggestion(name, names));
  }
  /// Index of a material, which is made if there is none of this name.
  int material(const std::string& name) {
    for (std::size_t i = 0; i < scene_.materials.size(); ++i)
      if (scene_.materials[i].name == name) return static_cast<int>(i);
    scene_.materials.push_back({name});
    return static_cast<int>(scene_.materials.size()) - 1;
  }
  /// The model decides how the interfaces inside a roll adhere, over what they say.
  void model() {
    const Reader chosen = file_["model"];
    if (!chosen) return;
    scene_.model = chosen.choice<tape::Model>();
    bool roll = false;
    for (tape::AdhesivePair& pair : scene_.adhesives) {
      if (!inside_roll(pair.a, pair.b)) continue;
      tape::AdhesionLaw& law = pair.adhesion.law;
      if (has_bonds(*scene_.model))
        law = tape::AdhesionLaw::bond;
      else if (law == tape::AdhesionLaw::bond)
        law = tape::AdhesionLaw::per_pair;
      roll = true;
    }
    if (!roll) chosen.fail("the scene has no roll whose interfaces adhere");
  }
  /// Whether these materials are those of a roll and its hub.
  bool inside_roll(int a, int b) const {
    return std::any_of(scene_.strips.begin(), scene_.strips.end(), [&](const Strip& s) {
      const auto part = [&](int m) { return m == s.material || m == scene_.bodies[static_cast<std::size_t>(s.winding->hub)].material; };
      return s.winding && part(a) && part(b);
    });
  }
  /// A body or a link, whose edge is named or is where its mesh is sharp.
  void blade(const Reader& entry) {
    constexpr Real kSharp = std::numbers::pi / 4;
    const Reader name = entry.is_map() ? entry["body"] : entry;
    std::vector<std::string> names;
    for (const tape::Body& body : scene_.bodies) names.push_back(body.name);
    tape::Blade blade{name.text(), {}};
    const tape::Body& body = scene_.bodies[choose(name, names)];
    if (entry.is_map() && entry["edge"])
      for (const Reader& corner : entry["edge"].items()) blade.edge.push_back(corner.vector(kPlace, "m"));
    else
      blade.edge = tape::sharp_edge(body.mesh, kSharp);
    if (blade.edge.size() < 2)
      name.fail("its mesh has no single line of edges sharper than 45 degrees: give the blade as {body: NAME, edge: [[x, y, z], ...]}");
    scene_.blades.push_back(std::move(blade));
  }
  void claim_name(const std::string& name, const Reader& where) const {
    if (name.empty() || name.find_first_of(".: ") != std::string::npos)
      where.fail("a name is not empty, and holds neither dots, colons nor spaces");
    const auto same = [&](const auto& object) { return object.name == name; };
    if (std::any_of(scene_.strips.begin(), scene_.strips.end(), same) || std::any_of(scene_.bodies.begin(), scene_.bodies.end(), same))
      where.fail("there is a thing named " + name + " already");
  }

  void strips() {
    const Reader one = file_["strip"], list = file_["strips"], roll = file_["roll"];
    if (one && list) list.fail("give either strip or strips");
    if (roll) {
      wound_strip(one, roll);
    } else if (one) {
      strip(one);
    }
    for (const Reader& entry : list.items()) strip(entry);
  }
  void strip(const Reader& section) {
    Strip& strip = add_strip(section);
    section.read(strip.mesh);
    strip.pose = read_pose(section);
    for (const Reader& piece : section["path"].items()) strip.path.push_back(path_piece(piece));
    strip.velocity = section["velocity"].vector_or(strip.velocity, kPlace, "m/s");
    mesh_strip(section);
  }
  void wound_strip(const Reader& section, const Reader& roll) {
    Strip& strip = add_strip(section);
    claim_name("hub", roll);
    read_roll(roll, section, scene_, strip);
    scene_.bodies.back().material = material(roll["core"]["material"].text_or("default"));
    mesh_strip(roll);
  }
  /// What every strip has: name, film, material.
  Strip& add_strip(const Reader& section) {
    Strip strip;
    const std::size_t count = scene_.strips.size();
    const Reader name = section["name"];
    strip.name = name.text_or("tape" + (count ? std::to_string(count + 1) : ""));
    claim_name(strip.name, name ? name : section);
    if (const Reader film = section["film"]) {
      strip.film = static_cast<int>(scene_.films.size());
      scene_.films.push_back(load_film(film, file_.path()));
    } else if (!file_["film"]) {
      file_["film"].fail("missing; the name of a film in data/tapes");
    }
    strip.material = material(section["material"].text_or("default"));
    return scene_.strips.emplace_back(std::move(strip));
  }
  /// @param section  where its settings stand
  void mesh_strip(const Reader& section) {
    const Strip& strip = scene_.strips.back();
    try {
      meshes_.push_back(make_strip_mesh(strip.mesh, scene_.films[strip.film].width, scene_.seed));
    } catch (const InputError& e) {
      section.fail(e.what());
    }
  }
  static tape::PathPiece path_piece(const Reader& piece) {
    const Reader line = piece["line"], arc = piece["arc"];
    if (line.exists() == arc.exists()) piece.fail("needs either line: length or arc: radius");
    if (line) return {line.number(kSize, "m"), 0};
    const Reader angle = piece["angle_deg"];
    const Real turn = kRadian * angle.number(kAnyAngle, "deg");
    if (turn == 0) angle.fail("an arc needs an angle");
    return {arc.number(kSize, "m") * std::fabs(turn), turn};
  }

  void bodies() {
    const Reader section = file_["bodies"];
    for (const std::string& name : section.keys()) {
      const Reader body = section[name];
      claim_name(name, body);
      scene_.bodies.push_back(read_body(body, name, file_.path()));
      scene_.bodies.back().material = material(body["material"].text_or("default"));
    }
  }

  void robots() {
    for (const std::string& name : file_["robots"].keys()) claim_name(name, file_["robots"][name]);
    robots_ = read_robots(file_, scene_.gravity, [&](const std::string& name) { return material(name); });
    try {
      add_links(robots_, scene_);
    } catch (const robot::InputError& e) {
      file_["robots"].fail(e.what());
    }
  }

  void axle(const Reader& entry) {
    std::vector<std::string> names;
    for (const tape::Body& body : scene_.bodies) names.push_back(body.name);
    if (names.empty()) entry.fail("the scene has no body");
    tape::AxleJoint axle;
    const tape::Body& body = scene_.bodies[choose(entry["body"], names)];
    if (body.motion != tape::Motion::dynamic) entry["body"].fail("is not dynamic: it cannot turn");
    axle.body = body.name;
    if (const Reader to = entry["to"]) {
      axle.to = names[choose(to, names)];
      if (axle.to == axle.body) to.fail("a body cannot turn on itself");
    }
    for (const tape::AxleJoint& other : scene_.axles)
      if (other.body == axle.body) entry["body"].fail("has an axle already");
    axle.point = entry["point"].vector_or(axle.point, kPlace, "m");
    axle.axis = entry["axis"].vector_or(axle.axis, kPlace, "");
    if (!(axle.axis.norm() > 0)) entry["axis"].fail("has no direction");
    entry.read(axle.params);
    if (axle.params.speed != 0 && axle.params.torque == 0) entry["speed"].fail("never acts: torque = 0");
    scene_.axles.push_back(axle);
  }

  /// Friction and adhesion between two things, each a material or an object. A later entry of the list overrides an earlier one.
  void interface(const Reader& entry) {
    const std::vector<Reader> between = entry["between"].items();
    if (between.size() != 2) entry["between"].fail("must be a list of two names, of materials or of things");
    const Side first = side(between[0]), second = side(between[1]);
    const Reader mu = entry["mu"], kappa = entry["kappa"], law = entry["law"];
    if (!mu && !kappa && !law) entry.fail("says none of mu, kappa, law");
    const auto set_all = [&](std::vector<tape::MaterialPair>& pairs, Real value) {
      for_each_pair(first, second, [&](int a, int b) { set(pairs, {a, b, value}); });
    };
    if (mu) set_all(scene_.frictions, mu.number(Range::non_negative(), ""));
    if (kappa) set_all(scene_.barriers, kappa.number(Range::positive(), "Pa"));
    if (!law) return;
    tape::AdhesivePair adhesive;
    bool roll = false;
    for_each_pair(first, second, [&](int a, int b) { roll |= inside_roll(a, b); });
    adhesive.adhesion = adhesion(entry, law.choice<tape::AdhesionLaw>(), roll);
    for_each_pair(first, second, [&](int a, int b) {
      adhesive.a = a, adhesive.b = b;
      if (!of_strip(a) && !of_strip(b)) entry["between"].fail("names no strip: only tape sticks");
      for (int f = 0; f < 2; ++f)
        for (int g = 0; g < 2; ++g)
          adhesive.adhesion.sticks[f][g] = (first.faces[f] && second.faces[g]) || (a == b && second.faces[f] && first.faces[g]);
      set_adhesion(adhesive);
    });
  }
  /// @param roll  it is one inside a roll: the settings of all laws that a model may choose stand beside each other
  static tape::Adhesion adhesion(const Reader& entry, tape::AdhesionLaw law, bool roll) {
    tape::Adhesion out{.law = law, .sticks = {}, .pair = {}, .area = {}, .bond = {}};
    if (law == tape::AdhesionLaw::bond || roll) {
      entry.read(out.bond);
      if (out.bond.floor >= out.bond.reach) entry["bond_floor"].fail("not below bond_reach: no pair would ever bond");
    }
    if (law == tape::AdhesionLaw::per_pair || roll) {
      if (const Reader eta = entry["eta"]; eta && eta.number(Range::any(), "s") == 0)
        eta.fail("debonding has the rate 1/eta: 0 is none (allowed: > 0 s)");
      entry.read(out.pair);
      if (out.pair.beta0 == 0 && out.pair.gamma == 0) entry["gamma"].fail("0 with beta0 = 0: no pair would ever engage");
      // a_n is (2 drop)^2 at most, and slip costs C_t: below W neither debonds anything.
      const bool debonds = out.pair.ct > 0 || out.pair.work < 4 * out.pair.drop * out.pair.drop;
      if (entry["eta"] && !debonds) entry["eta"].fail("never acts: with ct = 0 and this drop no opening exceeds work");
      if (entry["slip"] && out.pair.ct == 0) entry["slip"].fail("never acts: ct = 0");
    }
    if (law == tape::AdhesionLaw::per_area) entry.read(out.area);
    return out;
  }
  bool of_strip(int material) const {
    return std::any_of(scene_.strips.begin(), scene_.strips.end(), [&](const Strip& s) { return s.material == material; });
  }

  /// One side of an interface: materials, and which faces of a strip are meant (backing, sticky).
  struct Side {
    std::vector<int> materials;
    bool faces[2];
  };
  template <class F>
  static void for_each_pair(const Side& first, const Side& second, const F& f) {
    for (int a : first.materials)
      for (int b : second.materials) f(a, b);
  }
  /// What a name stands for; `tape.sticky` and `tape.backing` are faces of a strip. An object that shares its material gets its own copy,
  /// so that the others keep theirs.
  Side side(const Reader& name) {
    const std::string text = name.text();
    const bool sticky = text.ends_with(".sticky"), backing = text.ends_with(".backing");
    Side out{materials_of(name, text.substr(0, text.size() - (sticky ? 7 : backing ? 8 : 0))), {!sticky, !backing}};
    for (int m : out.materials)
      if ((sticky || backing) && !of_strip(m)) name.fail("is no strip: only strips have a sticky face and a backing");
    return out;
  }
  std::vector<int> materials_of(const Reader& name, const std::string& text) {
    std::vector<std::string> objects, all;
    for (const Strip& s : scene_.strips) objects.push_back(s.name);
    for (const tape::Body& b : scene_.bodies) objects.push_back(b.name);
    all = objects;
    for (const tape::Material& m : scene_.materials) all.push_back(m.name);
    const std::size_t chosen = choose(name, text, all);
    if (chosen < objects.size()) return {own_material(chosen)};
    std::vector<int> same;  // with the copies that objects have of it
    for (std::size_t i = 0; i < scene_.materials.size(); ++i)
      if (const std::string& m = scene_.materials[i].name; m == all[chosen] || m.starts_with(all[chosen] + " of "))
        same.push_back(static_cast<int>(i));
    return same;
  }
  int own_material(std::size_t object) {
    const auto material_of = [&](std::size_t i) -> int& {
      const std::size_t strips = scene_.strips.size();
      return i < strips ? scene_.strips[i].material : scene_.bodies[i - strips].material;
    };
    int& mine = material_of(object);
    int users = 0;
    for (std::size_t i = 0; i < scene_.strips.size() + scene_.bodies.size(); ++i) users += material_of(i) == mine;
    if (users == 1) return mine;
    const int copy = static_cast<int>(scene_.materials.size());
    const std::size_t strips = scene_.strips.size();
    const std::string& owner = object < strips ? scene_.strips[object].name : scene_.bodies[object - strips].name;
    scene_.materials.push_back({scene_.materials[mine].name + " of " + owner, scene_.materials[mine].mu});
    for (std::vector<tape::MaterialPair>* pairs : {&scene_.frictions, &scene_.barriers})
      for (const tape::MaterialPair& p : std::vector<tape::MaterialPair>(*pairs)) {
        if (p.a != mine && p.b != mine) continue;
        pairs->push_back({p.a == mine ? copy : p.a, p.b == mine && p.a != mine ? copy : p.b, p.value});
        if (p.a == p.b) pairs->push_back({copy, copy, p.value});
      }
    for (tape::AdhesivePair p : std::vector<tape::AdhesivePair>(scene_.adhesives)) {
      if (p.a != mine && p.b != mine) continue;
      const tape::AdhesivePair known = p;
      (p.a == mine ? p.a : p.b) = copy;
      scene_.adhesives.push_back(p);
      if (known.a == known.b) scene_.adhesives.push_back({copy, copy, known.adhesion});
    }
    return mine = copy;
  }
  void set_adhesion(const tape::AdhesivePair& adhesive) {
    std::erase_if(scene_.adhesives, [&](const tape::AdhesivePair& p) {
      return (p.a == adhesive.a && p.b == adhesive.b) || (p.a == adhesive.b && p.b == adhesive.a);
    });
    if (adhesive.adhesion.law != tape::AdhesionLaw::none) scene_.adhesives.push_back(adhesive);
  }
  static void set(std::vector<tape::MaterialPair>& pairs, const tape::MaterialPair& wanted) {
    std::erase_if(
        pairs, [&](const tape::MaterialPair& p) { return (p.a == wanted.a && p.b == wanted.b) || (p.a == wanted.b && p.b == wanted.a); });
    pairs.push_back(wanted);
  }

  const SceneFile& file_;
  Scene scene_;
  RobotScene robots_;
  std::vector<tape::StripMesh> meshes_;  // [strips]
};
}  // namespace

BothWorlds read_worlds(const SceneFile& file) { return SceneReader(file).read(); }

tape::Film load_film(const Reader& asked_by, const std::filesystem::path& scene_file) {
  const Reader name = asked_by.is_map() ? asked_by["from"] : asked_by;
  const std::string text = name.text();
  const std::filesystem::path found = find_file(scene_file, "tapes", text.ends_with(".yaml") ? text : text + ".yaml");
  if (found.empty()) name.fail("no such film beside the scene, above it, or in data/tapes");
  const SceneFile file = SceneFile::load(found);
  tape::Film film;
  film.name = file["film"].text_or(found.stem().string());
  const Reader values = file.root();
  film.fields([&](const char* key, auto&, const char*, Range, const char*) {
    if (!values[key]) values[key].fail("missing");
  });
  values.read(film);
  file.require_all_used();
  if (asked_by.is_map()) asked_by.read(film);
  return film;
}
}  // namespace cosim
