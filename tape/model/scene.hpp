#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tape/core/settings.hpp"
#include "tape/model/adhesion.hpp"
#include "tape/model/cluster_params.hpp"
#include "tape/model/film.hpp"
#include "tape/model/mass_properties.hpp"
#include "tape/model/moment.hpp"
#include "tape/model/sleep_params.hpp"
#include "tape/model/triangle_mesh.hpp"
#include "tape/model/winding.hpp"

namespace tape {
struct StripMesh;

enum class MeshPattern { same, alternating, crossed, irregular };
constexpr auto enum_names(MeshPattern) { return std::array<std::string_view, 4>{"same", "alternating", "crossed", "irregular"}; }
/// `linked`: a link of an articulation.
enum class Motion { fixed, driven, dynamic, linked };
constexpr auto enum_names(Motion) { return std::array<std::string_view, 4>{"static", "driven", "dynamic", "linked"}; }

struct TimeParams {
  Real dt = 0.01;
  Real duration = 1;
  template <class F>
  void fields(F&& f) {
    f("dt", dt, "s", Range::above(0, 1), "time step");
    f("duration", duration, "s", Range::non_negative(), "simulated time");
  }
};

struct ContactParams {
  Real dhat = 0;
  Real kappa = 1e4;
  Real guard = 0.5;
  Real ccd_gap = 0.2;
  Real margin = 0.5;
  Real max_move = 0.05;
  bool everywhere = false;
  template <class F>
  void fields(F&& f) {
    f("dhat", dhat, "m", Range::non_negative(), "activation distance of the barrier; 0: that of the film");
    f("kappa", kappa, "Pa", Range::positive(), "barrier stiffness, unless `interfaces` names another one");
    f("guard", guard, "1", Range::above(0, 1), "reach of edge-edge pairs and of open rims, in units of dhat");
    f("ccd_gap", ccd_gap, "1", Range::above(0, 0.99), "fraction of a gap that one Newton step must leave");
    f("max_move", max_move, "m", Range::positive(), "longest way of a vertex in one Newton iteration: keeps the swept search small");
    f("margin", margin, "1", Range::non_negative(), "slack of the candidate search, in units of dhat: more finds more pairs less often");
    f("everywhere", everywhere, "", Range::any(),
      "also search where nothing can meet: the same result, to measure what leaving that out saves");
  }
};

/// Piece of a strip's centreline: a line if `turn` is 0, else an arc. The strip's normal turns with it.
struct PathPiece {
  Real length = 0;  ///< [m]
  Real turn = 0;    ///< [rad] positive: towards the strip's normal (the backing side)
};

struct StripParams {
  Real length = 0.1;
  int cells_across = 6;
  Real cell_length = 0;
  MeshPattern pattern = MeshPattern::same;
  Real grid_angle = 0;
  template <class F>
  void fields(F&& f) {
    f("length", length, "m", Range::above(0, 100), "length of the strip");
    f("cells_across", cells_across, "1", Range::closed(1, 1000), "cells over the width");
    f("cell_length", cell_length, "m", Range::non_negative(), "length of a cell along the strip; 0: square cells");
    f("pattern", pattern, "", Range::any(), "diagonals of the mesh");
    f("grid_angle", grid_angle, "deg", Range::closed(-90, 90), "angle of the mesh's rows to the strip; needs pattern same");
  }
};

/// A strip of tape. Flat at rest; at the start its centreline follows `path` from `pose`: x along, y across, z normal (backing).
struct Strip {
  std::string name = "tape";
  int film = 0;  ///< index into Scene::films
  StripParams mesh;
  Pose pose;                     ///< of the start of the strip, middle of its first edge
  std::vector<PathPiece> path;   ///< empty: straight. Shorter than the strip: goes on straight
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
  int material = 0;              ///< index into Scene::materials
  /// A wound strip follows this instead of `path`; `pose` is that of the roll, the axis y.
  std::optional<Winding> winding = {};
  std::vector<Vec3> settled = {};  ///< [vertices] m, in the frame of `pose`: where a roll came to rest; empty: as the winding says
  std::shared_ptr<const StripMesh> remnant = {};  ///< what cuts have left of its mesh; none: all of it
};

/// How the interfaces inside a roll adhere, by cohesion or bonds, and whether all of its tape is a shell (f: full) or its wound part one
/// rigid cluster (r: reduced): the four models of the paper.
enum class Model { coh_f, bond_f, coh_r, bond_r };
constexpr auto enum_names(Model) { return std::array<std::string_view, 4>{"coh-f", "bond-f", "coh-r", "bond-r"}; }
constexpr bool has_bonds(Model m) { return m == Model::bond_f || m == Model::bond_r; }
constexpr bool is_reduced(Model m) { return m == Model::coh_r || m == Model::bond_r; }

/// Prescribed pose at a time; motion.hpp says how a body moves between two of them.
struct Waypoint {
  Real time = 0;      ///< [s]
  Pose pose;          ///< of the mesh's frame
  bool ease = false;  ///< the move to this waypoint starts and ends at rest
};

/// A rigid thing. Its mesh is in its own frame, whose origin need not be the centre of mass.
struct Body {
  std::string name;
  TriangleMesh mesh;
  Motion motion = Motion::fixed;
  Pose pose;                             ///< at the start; of the mesh's frame
  Real density = 1000;                   ///< [kg/m^3] used where mass is 0
  Real mass = 0;                         ///< [kg] 0: from density
  Vec3 velocity = Vec3::Zero();          ///< [m/s] of the centre of mass
  Vec3 angular_velocity = Vec3::Zero();  ///< [rad/s] in the world
  std::vector<Waypoint> waypoints;       ///< of a driven body, times ascending; none: it keeps its velocities
  Real xi = 0;                           ///< [m] half-thickness in contact
  int material = 0;                      ///< index into Scene::materials
  /// Of the shape that the mesh stands for, in the mesh's frame; none: those of the mesh itself.
  std::optional<MassProperties> solid = {};
  bool outside = false;  ///< whoever simulates the articulations has it too: all links, and what they stand on
};

struct Material {
  std::string name;
  Real mu = 0.5;
  template <class F>
  void fields(F&& f) {
    f("mu", mu, "1", Range::non_negative(), "friction; a pair takes the geometric mean unless `interfaces` names it");
  }
};
/// What an interface has in place of what its materials or the scene say.
struct MaterialPair {
  int a = 0, b = 0;  ///< materials
  Real value = 0;
};
struct AdhesivePair {
  int a = 0, b = 0;   ///< materials
  Adhesion adhesion;  ///< a is the first
};

/// Where a soft grip holds: vertices of a strip, or points fixed to a body.
struct GripTarget {
  std::string object;         ///< strip or body
  std::vector<int> vertices;  ///< of the strip, from its own 0
  std::vector<Vec3> points;   ///< [m] of the body, in the frame of its mesh
};
/// A soft grip: springs from each point of `what` to a target that moves, or to the same place on another body.
struct Grip {
  std::string name;
  GripTarget what;
  std::string to;      ///< body that the grip ties to; empty: a target moved by the script
  Real stiffness = 0;  ///< [N/m] of the whole grip; 0: chosen from the masses and strips of the scene
  Moment start;
  Moment end = 1e300;  ///< released here
  struct Move {
    Moment start;
    Real duration;   ///< [s]
    Vec3 by;         ///< [m] evenly over the duration
    int until = -1;  ///< event at which it stops before its time; -1: none
  };
  std::vector<Move> motion;  ///< of the target; those at the same time add up
};

struct AxleParams {
  Real torque = 0;
  Real speed = 0;
  Real stiffness = 0;
  template <class F>
  void fields(F&& f) {
    f("torque", torque, "N m", Range::closed(0, 1e6), "most that the axle exerts about its axis: friction, or the limit of its drive");
    f("speed", speed, "rad/s", Range::closed(-1e4, 1e4), "that its drive turns the body with; 0: none");
    f("stiffness", stiffness, "N/m", Range::closed(0, 1e12), "of its hold on each end; 0: chosen from the masses and strips of the scene");
  }
};
/// A revolute joint: a body turns on another one, or on the world.
struct AxleJoint {
  std::string body;
  std::string to;             ///< body that it turns on; empty: the world
  Vec3 point = Vec3::Zero();  ///< [m] on the axis, in the frame of the body's mesh
  Vec3 axis = Vec3::UnitZ();  ///< in the frame of the body's mesh
  AxleParams params;
};

/// The sharp edge of a body: tape that it presses on is cut along it.
struct Blade {
  std::string body;
  std::vector<Vec3> edge;  ///< [corners] m, a line through vertices of the body's mesh, in the frame of that
};

/// Bodies that move together, as somebody else says before each step (bodies/articulation.hpp). What bodies that are `outside` meet of each
/// other is that one's matter, unless a step says otherwise.
struct Articulation {
  std::string name;
  std::vector<std::string> links;  ///< bodies
  int coordinates = 0;
};

/// Input of a simulation, plain and complete, in SI units. cosim/scene fills it from a file.
struct Scene {
  std::string name;
  TimeParams time;
  ContactParams contact;
  Vec3 gravity = Vec3(0, 0, -9.81);  ///< [m/s^2]
  int seed = 1;
  std::optional<Model> model = {};  ///< of the rolls, over what their interfaces say
  ClusterParams cluster;            ///< of reduced rolls
  SleepParams sleep;
  std::vector<Film> films;
  std::vector<Strip> strips;
  std::vector<Body> bodies;
  std::vector<Material> materials = {{"default", 0.5}};
  std::vector<MaterialPair> frictions;  ///< mu [1]
  std::vector<MaterialPair> barriers;   ///< kappa [Pa]
  std::vector<AdhesivePair> adhesives;
  std::vector<Grip> grips;
  std::vector<AxleJoint> axles;
  std::vector<Articulation> articulations;
  std::vector<Blade> blades;
  int events = 0;  ///< that moments of grips hang on; whoever watches the run says when they happen

  Real dhat() const;                               ///< [m] contact.dhat, or the smallest of the films' (1e-3 without strips)
  Real mu(int a, int b) const;                     ///< friction of two materials
  Real kappa(int a, int b) const;                  ///< [Pa] stiffness of the barrier between two materials
  Adhesion adhesion(int first, int second) const;  ///< of two materials
  bool uses(AdhesionLaw law) const;                ///< whether an interface does
  bool reduces(const Strip& strip) const;          ///< whether its wound part is a rigid cluster
};
}  // namespace tape
