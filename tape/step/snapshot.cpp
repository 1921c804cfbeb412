#include <algorithm>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>

#include "tape/contact/intersection.hpp"
#include "tape/core/hdf5_handle.hpp"
#include "tape/step/engagement.hpp"

namespace tape {
namespace {
constexpr const char* kReals = "reals";
constexpr const char* kIntegers = "integers";
constexpr const char* kRemnantReals = "remnant_reals";
constexpr const char* kRemnantIntegers = "remnant_integers";
constexpr const char* kHash = "state_hash";
constexpr const char* kWorld = "world_hash";
constexpr const char* kSettings = "settings";

/// The state as two flat arrays, in a fixed order.
struct Flat {
  std::vector<Real> reals;
  std::vector<std::int64_t> integers;
};

template <class Visit>
void visit_state(State& s, const Visit& visit) {
  visit(s.time);
  for (Vec3& p : s.x) visit(p);
  for (Vec3& p : s.v) visit(p);
  for (BodyState& b : s.bodies) visit(b.pose.rotation), visit(b.pose.position), visit(b.velocity), visit(b.angular_momentum);
  for (Vec3& p : s.grip_base) visit(p);
  visit(s.step);
  for (int& c : s.grip_closed) visit(c);
  for (std::vector<Real>* numbers : {&s.outside, &s.events}) {
    numbers->resize(visit.count(numbers->size()));
    for (Real& r : *numbers) visit(r);
  }
  for (CutTrigger& t : s.triggers) visit(t.above), visit(t.waiting);
  const auto visit_memory = [&](EffectMemory& memory) {
    for_each_memory(memory, [&](auto& pairs) {
      pairs.resize(visit.count(pairs.size()));
      for (auto& pair : pairs) pair.visit(visit);
    });
  };
  visit_memory(s.memory);
  for (Cluster& c : s.clusters) {
    std::vector<Vec3> local = *c.local;
    std::vector<int> distance = *c.distance, released(c.released.begin(), c.released.end());
    EffectMemory asleep = *c.asleep;
    for (Vec3& y : local) visit(y);
    for (int& d : distance) visit(d);
    released.resize(visit.count(released.size()));
    for (int& v : released) visit(v);
    visit(c.centre), visit(c.mass.mass), visit(c.mass.second);
    std::shared_ptr<const Rest> rest;
    if (visit.count(c.rest ? 1 : 0) != 0) {
      Rest copy = c.rest ? *c.rest : Rest{};
      copy.vertices.resize(visit.count(copy.vertices.size()));
      copy.visit(visit);
      rest = std::make_shared<const Rest>(std::move(copy));
    }
    visit_memory(asleep);
    c = {std::make_shared<const std::vector<Vec3>>(local),
         std::make_shared<const std::vector<int>>(distance),
         {released.begin(), released.end()},
         c.centre,
         c.mass,
         rest,
         std::make_shared<const EffectMemory>(asleep)};
  }
  const auto visit_bodies = [&](std::vector<int>& bodies) {  // and -1
    for (int& b : bodies) ++b, visit(b), --b;
  };
  if (visit.count(s.sleepers ? 1 : 0) != 0) {
    Sleepers copy = s.sleepers ? *s.sleepers : Sleepers{};
    copy.body.resize(s.x.size()), copy.local.resize(s.x.size());
    visit_bodies(copy.body);
    for (Vec3& y : copy.local) visit(y);
    visit_memory(copy.asleep);
    s.sleepers = std::make_shared<const Sleepers>(std::move(copy));
  }
  if (visit.count(s.glance ? 1 : 0) != 0) {
    Glance copy = s.glance ? *s.glance : Glance{};
    copy.x.resize(s.x.size()), copy.body.resize(s.bodies.size()), copy.frame.resize(s.x.size());
    for (Vec3& p : copy.x) visit(p);
    for (Pose& pose : copy.body) visit(pose.rotation), visit(pose.position);
    visit_bodies(copy.frame);
    s.glance = std::make_shared<const Glance>(std::move(copy));
  }
}

/// What cuts have left of the strips, of which the sizes of all else follow.
template <class Visit>
void visit_remnants(Remnants& remnants, const Visit& visit) {
  for (std::shared_ptr<const StripMesh>& remnant : remnants) {
    if (visit.count(remnant ? 1 : 0) == 0) continue;
    StripMesh mesh = remnant ? *remnant : StripMesh{};
    mesh.rest.resize(visit.count(mesh.rest.size()));
    for (Vec2& p : mesh.rest) visit(p);
    mesh.triangles.resize(visit.count(mesh.triangles.size()));
    for (Index3& t : mesh.triangles)
      for (int& v : t) visit(v);
    visit(mesh.rows), visit(mesh.columns);
    remnant = std::make_shared<const StripMesh>(std::move(mesh));
  }
}

/// A state of the sizes that a world asks for.
State of_size(const World& world) {
  State state;
  const auto n = static_cast<std::size_t>(world.assembly.strip_vertices);
  state.x.resize(n, Vec3::Zero()), state.v.resize(n, Vec3::Zero());
  state.bodies.resize(world.assembly.bodies.size());
  for (const Assembly::GripPart& grip : world.assembly.grips) state.grip_base.resize(state.grip_base.size() + grip.vertices.size());
  state.grip_closed.resize(world.assembly.grips.size());
  state.triggers.resize(world.setup.scene.blades.size());
  for (const Strip& strip : world.setup.scene.strips) state.remnants.push_back(strip.remnant);
  for (const BodyPart& body : world.assembly.bodies) {
    if (body.cluster_of < 0) continue;
    const auto vertices = static_cast<std::size_t>(world.assembly.strips[static_cast<std::size_t>(body.cluster_of)].vertices);
    Cluster cluster;
    cluster.local = std::make_shared<const std::vector<Vec3>>(vertices, Vec3::Zero());
    cluster.distance = std::make_shared<const std::vector<int>>(vertices, 0);
    state.clusters.push_back(cluster);
  }
  return state;
}

struct Write {
  Flat& flat;
  void operator()(Real& v) const { flat.reals.push_back(v); }
  void operator()(int& v) const { flat.integers.push_back(v); }
  std::size_t count(std::size_t n) const {
    flat.integers.push_back(static_cast<std::int64_t>(n));
    return n;
  }
  template <class M>
  void operator()(M& m) const {
    flat.reals.insert(flat.reals.end(), m.data(), m.data() + m.size());
  }
};
struct Read {
  const Flat& flat;
  mutable std::size_t real = 0, integer = 0;
  void operator()(Real& v) const { v = flat.reals.at(real++); }
  void operator()(int& v) const {
    const std::int64_t value = flat.integers.at(integer++);
    if (value < 0 || value > std::numeric_limits<int>::max()) throw std::out_of_range("integer");
    v = static_cast<int>(value);
  }
  std::size_t count(std::size_t) const {  // of things that hold a number each
    const std::int64_t n = flat.integers.at(integer++);
    if (n < 0 || static_cast<std::size_t>(n) > flat.integers.size() + flat.reals.size()) throw std::out_of_range("count");
    return static_cast<std::size_t>(n);
  }
  template <class M>
  void operator()(M& m) const {
    for (Eigen::Index i = 0; i < m.size(); ++i) m.data()[i] = flat.reals.at(real++);
  }
};

/// Not of a strip: an edge or a corner that is none.
bool sound(const StripMesh& mesh) {
  const auto n = static_cast<int>(mesh.rest.size());
  return std::ranges::all_of(mesh.rest, [](const Vec2& p) { return p.allFinite(); }) &&
         std::ranges::all_of(mesh.triangles, [&](const Index3& t) { return t.minCoeff() >= 0 && t.maxCoeff() < n; });
}

bool exists(const World& world, const VertexTriangle& pair) {
  return pair.vertex < std::ssize(world.surface.vertices) && pair.triangle < std::ssize(world.surface.triangles);
}
bool exists(const World& world, const SampleTriangle& pair) {
  const int n = params<CohesiveZone>(world.setup.effects).samples, triangles = static_cast<int>(world.surface.triangles.size());
  return pair.sample / (n * n) < triangles && pair.triangle < triangles;
}
/// What is remembered must be of effects that are on, of things that exist, and of interfaces that adhere by the same law.
/// @throws InputError
template <class T>
void check_memory(const World& world, const MemoryOf<T>& memory) {
  if constexpr (Remembers<T>) {
    const std::string pairs = "it remembers pairs of '" + std::string(T::name) + "'";
    if (!memory.pairs.empty() && !world.is_on(T::name)) throw InputError(pairs + ", which is off");
    for (const typename T::Memory& m : memory.pairs) {
      if (!exists(world, m)) throw InputError(pairs + " that there are not");
      if (const AdhesionLaw now = adhesion_of(world, m).law; now != T::of_law)
        throw InputError(pairs + ", at an interface whose law is " + to_text(now));
    }
  }
}

/// @throws InputError for what a step could not start from
void check_state(const World& world, const State& state) {
  const auto check = [&](const auto&... memory) { (check_memory(world, memory), ...); };
  std::apply(check, state.memory);
  std::vector<VertexTriangle> bonded = pairs_out_of_contact(state.memory);
  for (const Cluster& c : state.clusters) {
    std::apply(check, *c.asleep);
    const std::vector<VertexTriangle> asleep = pairs_out_of_contact(*c.asleep);
    bonded.insert(bonded.end(), asleep.begin(), asleep.end());
    if (!c.rest) continue;
    if (!world.is_on(Seat::name)) throw InputError("a cluster rests on its hub, and 'seat' is off");
    if (std::ranges::any_of(c.rest->vertices, [&](int v) { return v >= std::ssize(*c.local); }))
      throw InputError("a cluster rests by vertices that there are not");
  }
  const auto check_bodies = [&](const std::vector<int>& bodies) {
    if (std::ranges::any_of(bodies, [&](int b) { return b >= world.first_cluster(); }))
      throw InputError("tape sleeps on bodies that there are not");
  };
  if (state.sleepers) {
    check_bodies(state.sleepers->body);
    std::apply(check, state.sleepers->asleep);
    const std::vector<VertexTriangle> asleep = pairs_out_of_contact(state.sleepers->asleep);
    bonded.insert(bonded.end(), asleep.begin(), asleep.end());
  }
  if (state.glance) check_bodies(state.glance->frame);
  std::ranges::sort(bonded, {}, &VertexTriangle::key);
  check_start(vertex_positions(world, state), world.surface, world.setup.scene.dhat(), bonded);
}

void write_array(hid_t file, const char* name, hid_t type, const void* data, std::size_t n) {
  const hsize_t size = n;
  const Hdf5Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
  const Hdf5Handle set(H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
  if (set < 0 || H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0) throw InputError(std::string("cannot write '") + name + "'");
}

template <class T>
std::vector<T> read_array(hid_t file, const char* name, hid_t type) {
  const Hdf5Handle set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
  if (set < 0) throw InputError(std::string("'") + name + "' is missing");
  const Hdf5Handle space(H5Dget_space(set), H5Sclose);
  std::vector<T> values(static_cast<std::size_t>(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space))));
  if (H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) throw InputError(std::string("cannot read '") + name + "'");
  return values;
}

void write_file(const std::string& name, const World& world, const State& state, const Flat& flat, const Flat& remnants,
                const std::string& settings) {
  const Hdf5Handle file(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
  if (file < 0) throw InputError("cannot create it");
  const std::string hash = state.hash(), world_id = world_hash(world);
  write_array(file, kReals, H5T_NATIVE_DOUBLE, flat.reals.data(), flat.reals.size());
  write_array(file, kIntegers, H5T_NATIVE_INT64, flat.integers.data(), flat.integers.size());
  write_array(file, kRemnantReals, H5T_NATIVE_DOUBLE, remnants.reals.data(), remnants.reals.size());
  write_array(file, kRemnantIntegers, H5T_NATIVE_INT64, remnants.integers.data(), remnants.integers.size());
  write_array(file, kHash, H5T_NATIVE_CHAR, hash.data(), hash.size());
  write_array(file, kWorld, H5T_NATIVE_CHAR, world_id.data(), world_id.size());
  write_array(file, kSettings, H5T_NATIVE_CHAR, settings.data(), settings.size());
  if (H5Fflush(file, H5F_SCOPE_GLOBAL) < 0) throw InputError("cannot write it out");
}

/// @throws InputError if there is no such file, or it is none of HDF5
Hdf5Handle open_snapshot(const std::string& file) {
  silence_hdf5();
  if (!std::filesystem::exists(file)) throw InputError(file + ": no such file");
  const hid_t h5 = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (h5 < 0) throw InputError(file + ": not a snapshot, or truncated");
  return {h5, H5Fclose};
}

std::string as_text(const std::vector<char>& c) { return {c.begin(), c.end()}; }
}  // namespace

std::string world_hash(const World& world) {
  State digest;
  for (const Index3& t : world.assembly.triangles) digest.x.push_back(t.cast<Real>());
  for (const Vec2& r : world.assembly.rest) digest.x.push_back({r.x(), r.y(), 0});
  digest.x.insert(digest.x.end(), world.assembly.local.begin(), world.assembly.local.end());
  for (const VertexOwner& o : world.assembly.owner) digest.x.push_back({static_cast<Real>(o.block), static_cast<Real>(o.body), 0});
  if (world.clusters() > 0) {  // they have their members' mass
    digest.x.push_back({static_cast<Real>(world.setup.scene.cluster.collar), 0, 0});
    for (int v = 0; v < world.assembly.strip_vertices; ++v) digest.x.push_back({world.assembly.mass[static_cast<std::size_t>(v)], 0, 0});
  }
  if (world.is_on(CohesiveZone::name)) digest.step = params<CohesiveZone>(world.setup.effects).samples;
  return digest.hash();
}

void save_snapshot(const std::string& file, const World& world, const State& state, const std::string& settings) {
  silence_hdf5();
  State copy = state;
  Flat flat, remnants;
  visit_state(copy, Write{flat});
  visit_remnants(copy.remnants, Write{remnants});
  const std::string temporary = file + ".tmp";
  try {
    write_file(temporary, world, state, flat, remnants, settings);
    std::filesystem::rename(temporary, file);
  } catch (const std::exception& e) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw InputError(file + ": cannot write the snapshot: " + e.what());
  }
}

std::string snapshot_settings(const std::string& file) {
  const Hdf5Handle h5 = open_snapshot(file);
  try {
    return as_text(read_array<char>(h5, kSettings, H5T_NATIVE_CHAR));
  } catch (const InputError& e) {
    throw InputError(file + ": not a snapshot: " + e.what());
  }
}

State load_snapshot(const std::string& file, const World& whole) {
  const auto refuse = [&](const std::string& why) { throw InputError(file + ": not a snapshot of this scene: " + why); };
  const Hdf5Handle h5 = open_snapshot(file);
  const auto read_flat = [&](const char* reals, const char* integers) {
    return Flat{read_array<Real>(h5, reals, H5T_NATIVE_DOUBLE), read_array<std::int64_t>(h5, integers, H5T_NATIVE_INT64)};
  };
  Remnants remnants(whole.assembly.strips.size());
  State state;
  try {
    visit_remnants(remnants, Read{read_flat(kRemnantReals, kRemnantIntegers)});
    for (const auto& remnant : remnants)
      if (remnant && !sound(*remnant)) refuse("its strips are no meshes");
    const World world = whole.with(remnants);
    if (as_text(read_array<char>(h5, kWorld, H5T_NATIVE_CHAR)) != world_hash(world))
      refuse("its strips or bodies differ, or the collar of its rolls");
    state = of_size(world);
    visit_state(state, Read{read_flat(kReals, kIntegers)});
    if (as_text(read_array<char>(h5, kHash, H5T_NATIVE_CHAR)) != state.hash()) refuse("its contents do not match their hash");
    if (std::ssize(state.events) != world.setup.scene.events) refuse("its script waits for other events");
    check_state(world, state);
  } catch (const std::out_of_range&) {
    refuse("its arrays do not fit");
  } catch (const InputError& e) {
    if (std::string_view(e.what()).starts_with(file)) throw;
    refuse(e.what());
  }
  return state;
}
}  // namespace tape
