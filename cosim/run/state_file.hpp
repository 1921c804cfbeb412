#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "cosim/exchange/exchange.hpp"
#include "cosim/run/hdf5_file.hpp"
#include "cosim/scene/phase.hpp"
#include "tape/step/reduce.hpp"

namespace cosim {
using namespace tape;
/// A strip or a body in a recording.
struct RecordedObject {
  std::string name, material;
  int first_triangle = 0, triangles = 0;
  bool strip = false;
  Real stretch = 0, poisson = 0;  ///< of a strip's film: E h/(1 - nu^2) [N/m], nu
};
struct RecordedRobot {
  std::string name;
  std::vector<std::string> joints, links;
  std::vector<robot::Frame> frames = {};  ///< of merged links
  bool operator==(const RecordedRobot& other) const { return name == other.name && joints == other.joints && links == other.links; }
};
/// What a recording shows, constant over its frames from cut to cut.
struct RecordedMesh {
  std::string scene;
  std::vector<RecordedObject> objects;
  std::vector<Index3> triangles;
  std::vector<Vec2> rest;   ///< [nv] m; zero on bodies
  std::vector<int> body;    ///< [nv] body that carries the vertex, -1: a strip
  std::vector<Vec3> local;  ///< [nv] m, in frame B; zero on strips
  int strip_vertices = 0;   ///< the first ones
  std::string pictures;     ///< what the scene says of pictures (camera, video), as YAML text; may be empty
  std::vector<RecordedRobot> robots;
  std::string settings;             ///< of the run and the version of the program, as text; may be empty
  std::vector<std::string> grips;   ///< their names
  std::vector<std::string> phases;  ///< of the script, their names

  static RecordedMesh of(const World& world, const RobotScene& robots, const std::vector<Phase>& phases, std::string pictures,
                         std::string settings);
};
/// What is known of the step that a state is the end of, and not held by that.
struct StepRecord {
  std::vector<Real> contact_force = {};  ///< [nv] N; shorter: zero on the rest
  std::vector<Vec3> grip_force = {};     ///< [grips] N on what they hold; shorter: zero on the rest
  std::vector<RobotRecord> robots = {};
  int phase = -1;  ///< -1: none has begun
};
struct RecordedFrame {
  int mesh = 0;  ///< of the recording's meshes
  int step = 0;
  Real time = 0;                    ///< [s]
  std::vector<Vec3> x;              ///< [strip vertices] m
  std::vector<Pose> bodies;         ///< [bodies] X_WB
  std::vector<Real> contact_force;  ///< [nv] N, kept to 7 digits
  std::vector<Real> engagement;     ///< [strip vertices] what adhesion is left (vertex_engagement), kept to 7 digits
  std::vector<TapePart> part;       ///< [strip vertices]
  std::vector<RobotRecord> robots;
  std::vector<Vec3> grip_force;  ///< [grips] N on what they hold
  int phase = -1;                ///< of the recording's phases; -1: none has begun

  static RecordedFrame of(const World& world, const State& state, StepRecord step);
};
/// All vertices [nv] m of a frame.
std::vector<Vec3> vertex_positions(const RecordedMesh& mesh, const RecordedFrame& frame);

/// Writes state.h5. Arrays: triangles [nt,3], rest [nv,2] m, body [nv], local [nv,3] m, objects [n,3] (first triangle, triangles, 1 for
/// a strip), film [n,2] (E h/(1 - nu^2) [N/m] and nu of a strip); and per frame: step, time [s], x [strip vertices,3] m, pose [bodies,12]
/// (rotation row by row, position), contact_force [nv] N, engagement [strip vertices], part [strip vertices] (0 free, 1 collar, 2 cluster,
/// 3 asleep), mesh: after the k-th cut all arrays of vertices and triangles go on in meshK/; of each robot in robots/NAME/: position,
/// velocity, command, effort [joints], links [links,7] (position, quaternion w x y z), wrench [links,6]; grip_force [grips,3] N; phase: of
/// the script, which attribute `phases` names. Attribute `about` says all this, with units.
class StateWriter {
 public:
  StateWriter(const std::filesystem::path& name, const RecordedMesh& mesh);
  void add(const RecordedFrame& frame);
  /// A strip was cut: frames from now on are of this mesh.
  void start_mesh(const RecordedMesh& mesh);
  void commit() { file_.commit(); }

 private:
  void add_robot(const std::string& folder, const RobotRecord& robot);
  void write_mesh(const RecordedMesh& mesh);
  Hdf5Writer file_;
  int mesh_ = 0;
  std::vector<std::string> robots_;
};

class StateReader {
 public:
  /// @throws InputError if the file is missing or damaged
  explicit StateReader(const std::filesystem::path& name);
  /// @param k  how many cuts it has gone through
  const RecordedMesh& mesh(int k = 0) const { return meshes_[static_cast<std::size_t>(k)]; }
  int meshes() const { return static_cast<int>(meshes_.size()); }
  int frames() const { return frames_; }
  RecordedFrame frame(int i) const;

 private:
  void read_mesh();
  RobotRecord robot_at(const RecordedRobot& robot, int i) const;
  std::string name_;
  Hdf5Reader file_;
  std::vector<RecordedMesh> meshes_;
  std::vector<int> mesh_of_;  // [frames]
  int frames_ = 0;
};
}  // namespace cosim
