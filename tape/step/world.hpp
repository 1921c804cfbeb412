#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tape/bodies/assembly.hpp"
#include "tape/contact/surface.hpp"
#include "tape/cutting/params.hpp"
#include "tape/effects/effects.hpp"
#include "tape/model/scene.hpp"
#include "tape/reduction/carriage.hpp"
#include "tape/reduction/strip_graph.hpp"
#include "tape/solver/linear_params.hpp"
#include "tape/solver/params.hpp"

namespace tape {
/// Everything a run is told: the scene, the settings of the effects and of the solver.
struct Setup {
  Scene scene;
  EffectParams effects;
  std::map<std::string, bool> forced;  ///< effects that the scene turns on or off whatever it needs
  NewtonParams newton;
  LinearParams linear;
  CuttingParams cutting = {};
  EffectMemory memory = {};  ///< what adheres at the start, apart from what else is in the contact band
};

/// One line of the effect plan.
struct PlanLine {
  std::string name;
  bool on = false;
  std::string why;
};

/// What cuts have left of the strips: [strips], none where a strip is whole.
using Remnants = std::vector<std::shared_ptr<const StripMesh>>;

/// Constant for a run, from cut to cut.
struct World {
  Setup setup;
  Assembly assembly;
  SurfaceMesh surface;
  std::vector<StripGraph> graphs;  ///< [strips]
  std::vector<PlanLine> plan;      ///< in the order of the list of effects

  /// Checks settings and initial state.  @throws InputError saying what is wrong and where
  static World build(Setup setup);
  /// This world with other remnants of its strips.
  World with(const Remnants& remnants) const;
  bool is_on(std::string_view effect) const;
  int first_cluster() const { return static_cast<int>(setup.scene.bodies.size()); }  ///< body that is the first cluster
  int clusters() const { return static_cast<int>(assembly.bodies.size()) - first_cluster(); }

 private:
  void lay_out();
};

struct BodyState {
  Pose pose;                             ///< X_WB
  Vec3 velocity = Vec3::Zero();          ///< [m/s] of the centre of mass
  Vec3 angular_momentum = Vec3::Zero();  ///< [kg m^2/s] about the centre of mass, in the world
};

/// All that the next step needs. Nothing outside it may change a bit of the future.
struct State {
  int step = 0;
  Real time = 0;                     ///< [s]
  std::vector<Vec3> x, v;            ///< [strip vertices] m, m/s
  std::vector<BodyState> bodies;     ///< [bodies] with the clusters at the end
  std::vector<Vec3> grip_base;       ///< [springs] m, where the target of each spring was when its grip closed
  std::vector<int> grip_closed;      ///< [grips] 1 once it has closed
  std::vector<CutTrigger> triggers;  ///< [Scene::blades]
  Remnants remnants;                 ///< [strips]
  std::vector<Real> events;          ///< [Scene::events] s, when each has happened; infinite if it has not
  EffectMemory memory;               ///< of pairs that adhere and are awake
  std::vector<Real> outside;         ///< what whoever simulates the articulations needs to go on: theirs to read
  std::vector<Cluster> clusters;     ///< of reduced rolls, in the order of the bodies that they are; members keep the x of the last step
  std::shared_ptr<const Sleepers> sleepers;  ///< null: no tape sleeps
  std::shared_ptr<const Glance> glance;      ///< the last look at how still tape lies; null: none yet

  static State start(const World& world);
  /// 64-bit FNV-1a of all bits above, as 16 hexadecimal digits.
  std::string hash() const;
};

/// World-space position [m] of a vertex.
Vec3 vertex_position(const World& world, const State& state, std::size_t v);
/// World-space positions [nv] m of all vertices.
std::vector<Vec3> vertex_positions(const World& world, const State& state);

/// What is prescribed for the end of a step: targets of grips and of driven bodies.
struct Drive {
  std::vector<Vec3> grip_target;     ///< [springs] m; unused where the grip ties to a body
  std::vector<Real> grip_stiffness;  ///< [springs] N/m, 0 while open
  std::vector<Pose> body_target;     ///< [bodies] X_WB; dynamic bodies: where their inertia takes them
  /// @param end  [s]  @param dt  [s] from the state to there
  static Drive at(const World& world, const State& state, Real end, Real dt);
};
/// Mass of a body; of a cluster, as it is now.
const BodyMass& body_mass(const World& world, const State& state, std::size_t body);
/// Closes the grips whose time has come: each spring's target starts where its vertex is now.
void close_grips(const World& world, State& state);

/// Of what a state must fit: triangles, shapes of strips at rest and of bodies, what carries each vertex, how triangles are cut into
/// samples; of reduced rolls the collar and the mass of the tape.
std::string world_hash(const World& world);
/// Writes and reads the state exactly (HDF5, by a temporary name), with what is needed to refuse a snapshot of another scene.
/// @param settings  text that goes with it
void save_snapshot(const std::string& file, const World& world, const State& state, const std::string& settings = "");
/// The text that a snapshot was saved with.  @throws InputError if the file is missing or no snapshot
std::string snapshot_settings(const std::string& file);
/// @throws InputError if the file is missing, truncated, or of another scene
State load_snapshot(const std::string& file, const World& world);
}  // namespace tape
