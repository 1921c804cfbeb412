#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

/// The Bullet side: robots and props, their drives and their world. SI units; poses X_AB take what is given in B to A.
namespace robot {
using Real = double;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using VecX = Eigen::VectorXd;
using MatX = Eigen::MatrixXd;
using Pose = Eigen::Isometry3d;

/// Bad input by the user: a robot, mesh, trajectory or setting that cannot be used. Its text names file, element and reason.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct TriangleMesh {
  std::vector<Vec3> vertices;                 ///< [nv] m
  std::vector<std::array<int, 3>> triangles;  ///< [nt] counterclockwise from outside
};

/// Mass of a link.
struct Inertial {
  Real mass = 0;                ///< [kg]
  Vec3 com = Vec3::Zero();      ///< [m] in the link's frame
  Mat3 inertia = Mat3::Zero();  ///< [kg m^2] about com, along the axes of the link's frame; symmetric, may have off-diagonal terms
};

/// One piece of what a link looks like or collides with.
struct Shape {
  enum class Kind { box, cylinder, sphere, mesh };
  Kind kind = Kind::box;
  Pose X_LS = Pose::Identity();      ///< of the shape in the link's frame
  Vec3 size = Vec3::Zero();          ///< [m] box: full lengths; cylinder: radius, radius, length along z; sphere: radius in all
  TriangleMesh mesh = {};            ///< [m] in the shape's frame, of every kind; closed for boxes, cylinders and spheres
  std::string file = {};             ///< of a mesh
  Vec3 color = Vec3::Constant(0.7);  ///< [0, 1] red, green, blue
};

struct Link {
  std::string name;
  Inertial inertial = {};
  std::vector<Shape> visual = {}, collision = {};
};

enum class JointType { revolute, continuous, prismatic };

/// This joint moves as multiplier * q + offset of another, which mimics none.
struct Mimic {
  int joint = 0;
  Real multiplier = 1;
  Real offset = 0;  ///< [rad or m]
};

/// Joint k moves link k + 1 against its parent. Quantities are in rad, rad/s, N m, N m s/rad if it turns, and m, m/s, N, N s/m if it
/// slides.
struct Joint {
  std::string name;
  JointType type = JointType::revolute;
  int parent = 0;                ///< link, smaller than the child's index
  Pose X_PJ = Pose::Identity();  ///< of the child's frame in the parent link's at q = 0
  Vec3 axis = Vec3::UnitX();     ///< unit vector in the child's frame
  Real lower = -std::numeric_limits<Real>::infinity(), upper = std::numeric_limits<Real>::infinity();
  Real velocity = std::numeric_limits<Real>::infinity();  ///< limit of its speed
  Real effort = std::numeric_limits<Real>::infinity();    ///< limit of its drive
  Real damping = 0;
  Real friction = 0;  ///< Coulomb
  std::optional<Mimic> mimic = {};
};

/// A named frame that is no link of its own: what a fixed joint carried before it was merged.
struct Frame {
  std::string name;
  int link = 0;
  Pose X_LF = Pose::Identity();
};

/// A tree of links joined by one-degree-of-freedom joints; link 0 is the base. Immutable once read.
struct RobotModel {
  std::string name;
  std::vector<Link> links = {};                       ///< [nj + 1], parents first
  std::vector<Joint> joints = {};                     ///< [nj]
  std::vector<Frame> frames = {};                     ///< of merged links
  std::vector<std::pair<int, int>> may_overlap = {};  ///< pairs of links that never collide: neighbours, and those that an SRDF file names
  std::vector<std::string> notes = {};                ///< what was assumed where the file was silent, one sentence each

  /// -1 if there is none of that name.
  int find_joint(const std::string& name) const;
  /// Link and pose in it of the link or frame of that name; nothing if there is none.
  std::optional<Frame> find_frame(const std::string& name) const;
};
}  // namespace robot
