#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "robot/kinematics/forward_kinematics.hpp"
#include "robot/model/inertia.hpp"
#include "robot/urdf/describe.hpp"
#include "robot/urdf/mesh_file.hpp"
#include "tests/robot/support/own_robots.hpp"
using namespace robot;
using test::own_prop;

namespace {
constexpr const char* kNames[] = {"table", "stand", "carton", "dispenser", "presser", "swivel", "knife", "spindle", "bar"};

/// A shape filled with 1 kg/m^3, in the link's frame. Closed forms for boxes and cylinders, whose meshes are inscribed.
Inertial solid_of(const Shape& shape) {
  const Vec3& s = shape.size;
  if (shape.kind == Shape::Kind::mesh) return moved(shape.X_LS, solid(shape.mesh, 1));
  if (shape.kind == Shape::Kind::box) {
    const Real mass = s.prod();
    const Vec3 s2 = s.cwiseAbs2();
    return moved(shape.X_LS, {mass, Vec3::Zero(), mass / 12 * Vec3(s2.sum() - s2.x(), s2.sum() - s2.y(), s2.sum() - s2.z()).asDiagonal()});
  }
  const Real r = s.x(), l = s.z(), mass = std::numbers::pi * r * r * l, across = (3 * r * r + l * l) / 12;
  return moved(shape.X_LS, {mass, Vec3::Zero(), mass * Vec3(across, across, r * r / 2).asDiagonal()});
}
/// All collision shapes of a link together; they do not overlap.
Inertial solid_of(const Link& link) {
  Inertial all;
  for (const Shape& shape : link.collision) all = combined(all, solid_of(shape));
  return all;
}
const Link& link_of(const RobotModel& model, const std::string& name) {
  return model.links[static_cast<std::size_t>(model.find_frame(name)->link)];
}
const Joint& joint_of(const RobotModel& model, const std::string& name) {
  return model.joints[static_cast<std::size_t>(model.find_joint(name))];
}

/// Corners of a link's only box [m] in the base's frame, with all joints at q [rad].
std::vector<Vec3> corners(const RobotModel& model, const std::string& link, Real q) {
  const Pose X = link_poses(
      model, VecX::Constant(static_cast<Eigen::Index>(model.joints.size()), q))[static_cast<std::size_t>(model.find_frame(link)->link)];
  std::vector<Vec3> result;
  for (const Vec3& p : link_of(model, link).collision[0].mesh.vertices) result.push_back(X * link_of(model, link).collision[0].X_LS * p);
  return result;
}
/// Least and greatest of a coordinate.
std::pair<Real, Real> range(const std::vector<Vec3>& points, int axis) {
  std::pair<Real, Real> result{points[0][axis], points[0][axis]};
  for (const Vec3& p : points) result = {std::min(result.first, p[axis]), std::max(result.second, p[axis])};
  return result;
}
TriangleMesh blade(const std::string& file) { return read_mesh(std::filesystem::path(TAPE_SOURCE_DIR "/data/props") / file); }
}  // namespace

TEST(Props, EachIsAUrdfWithoutAssumptionsAndWithInertiasOfRealBodies) {
  for (const char* name : kNames) {
    const RobotModel model = own_prop(name);
    EXPECT_EQ(model.name, name);
    EXPECT_TRUE(model.notes.empty()) << name;
    for (const Link& link : model.links) {
      EXPECT_GT(link.inertial.mass, 0) << link.name;
      const Vec3 moments = principal_moments(link.inertial.inertia);
      EXPECT_GT(moments[0], 0) << link.name;
      EXPECT_GE(moments[0] + moments[1], moments[2] * (1 - 1e-9)) << link.name;  // the triangle inequality
    }
  }
}

TEST(Props, MassIsSpreadEvenlyOverTheShapesOfALink) {
  for (const char* name : kNames)
    for (const Link& link : own_prop(name).links) {
      const Inertial filled = solid_of(link);
      const Mat3 expected = link.inertial.mass / filled.mass * filled.inertia;
      EXPECT_LT((link.inertial.com - filled.com).norm(), 1e-7) << name << " " << link.name;  // [m]
      EXPECT_LT((link.inertial.inertia - expected).norm(), 1e-6 * expected.norm()) << name << " " << link.name;
    }
}

TEST(Props, BladesAreClosedAndTheirEdgeIsStraightOrHasTwentyTeeth) {
  for (const char* file : {"dispenser_blade.obj", "knife_blade.obj"}) {
    const TriangleMesh mesh = blade(file);
    ASSERT_FALSE(mesh.triangles.empty()) << file;
    std::map<std::pair<int, int>, int> directed;
    for (const auto& t : mesh.triangles)
      for (int i = 0; i < 3; ++i) ++directed[{t[i], t[(i + 1) % 3]}];
    for (const auto& [edge, count] : directed) EXPECT_TRUE(count == 1 && directed.contains({edge.second, edge.first})) << file;
    EXPECT_GT(solid(mesh, 1).mass, 0) << file;  // turned outward
  }
  const auto tips = [](const TriangleMesh& mesh, Real z) {
    return std::count_if(mesh.vertices.begin(), mesh.vertices.end(), [z](const Vec3& p) { return std::fabs(p.z() - z) < 1e-8; });
  };
  EXPECT_EQ(tips(blade("dispenser_blade.obj"), 0.014), 20);
  EXPECT_EQ(tips(blade("dispenser_blade.obj"), 0.0125), 21);  // between and beside them
  EXPECT_EQ(tips(blade("knife_blade.obj"), 0.02), 2);
}

TEST(Props, TheClosedCartonHasTheGapsThatItsReadmeStates) {
  const RobotModel carton = own_prop("carton");
  const Real closed = std::numbers::pi / 2, kTol = 1e-9;
  const auto back = corners(carton, "flap_back", closed), front = corners(carton, "flap_front", closed);
  const auto right = corners(carton, "flap_right", closed), left = corners(carton, "flap_left", closed);
  EXPECT_NEAR(range(back, 1).first - range(front, 1).second, 0.003, kTol);  // mid-gaps
  EXPECT_NEAR(range(right, 0).first - range(left, 0).second, 0.003, kTol);
  for (const auto& inner : {back, front}) EXPECT_NEAR(range(inner, 2).first - 0.2032, 0.0015, kTol);  // hinge gaps above the walls
  for (const auto& outer : {right, left}) EXPECT_NEAR(range(outer, 2).first - 0.2082, 0.0015, kTol);
  EXPECT_NEAR(range(right, 2).first - range(back, 2).second, 0.002, kTol);  // the outer pair above the inner
  EXPECT_NEAR(0.1524 - 0.003 - range(back, 0).second, 0.003, kTol);         // beside the outer walls
}

TEST(Props, FlapsOfTheCartonHangOutsideWithoutTouchingTheWall) {
  const RobotModel carton = own_prop("carton");
  EXPECT_NEAR(range(corners(carton, "flap_back", 0), 1).first, 0.1536, 1e-9);  // upright, 1.2 mm outside of the wall
  EXPECT_NEAR(range(corners(carton, "flap_back", -std::numbers::pi), 1).first, 0.1536, 1e-9);
  EXPECT_LT(range(corners(carton, "flap_back", -std::numbers::pi), 2).second, 0.2082);
  for (const char* name : {"hinge_back", "hinge_front", "hinge_left", "hinge_right"}) {
    EXPECT_EQ(joint_of(carton, name).lower, -3);
    EXPECT_DOUBLE_EQ(joint_of(carton, name).upper, std::numbers::pi / 2);
  }
}

TEST(Props, TheCartonHasTheBoardsMassAndItsOutsideIsTwelveByTwelveByEightInches) {
  const RobotModel carton = own_prop("carton");
  for (const Link& link : carton.links) EXPECT_NEAR(link.inertial.mass / solid_of(link).mass * 0.003, 0.5, 1e-7);  // [kg/m^2]
  const std::vector<Shape>& base = link_of(carton, "base").collision;
  EXPECT_NEAR(base[0].size.x(), 12 * 0.0254, 1e-9);
  EXPECT_NEAR(base[0].size.y(), 12 * 0.0254, 1e-9);
  EXPECT_NEAR(base[1].X_LS.translation().z() + base[1].size.z() / 2, 8 * 0.0254, 1e-9);
}

TEST(Props, TheCreasesStiffnessHoldsAFlapAtSixtyDegreesOnEitherSide) {
  const RobotModel carton = own_prop("carton");
  const Inertial& flap = link_of(carton, "flap_back").inertial;
  const Real kCrease = 0.01401;                                                       // [N m/rad] of README.md
  const Real angle = std::numbers::pi / 3, weight = flap.mass * 9.81 * flap.com.z();  // [N m]
  EXPECT_NEAR(kCrease * angle, weight * std::sin(angle), 1e-5);
  EXPECT_GT(kCrease, weight * std::cos(angle));  // and the balance is stable
}

TEST(Props, TheDispenserWeighs313Grams) {
  const RobotModel dispenser = own_prop("dispenser");
  EXPECT_NEAR(total_mass(dispenser), 0.313, 0.0005);
  EXPECT_EQ(joint_of(dispenser, "wheel_axle").type, JointType::continuous);
  EXPECT_EQ(joint_of(dispenser, "roller_axle").type, JointType::continuous);
  EXPECT_EQ(joint_of(dispenser, "blade_hinge").upper, 0.1);
}
