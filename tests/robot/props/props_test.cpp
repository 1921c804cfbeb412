#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <gtest/gtest.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>

#include "robot/model/robot_model.hpp"
using namespace robot;

namespace {
const std::filesystem::path kProps = TAPE_SOURCE_DIR "/data/props";
constexpr const char* kNames[] = {"table", "stand", "carton", "dispenser", "presser", "knife"};

urdf::ModelInterfaceSharedPtr prop(const std::string& name) {
  std::ifstream file(kProps / (name + ".urdf"));
  std::stringstream text;
  text << file.rdbuf();
  return urdf::parseURDF(text.str());
}
Pose pose(const urdf::Pose& p) {
  return Eigen::Translation3d(p.position.x, p.position.y, p.position.z) *
         Eigen::Quaterniond(p.rotation.w, p.rotation.x, p.rotation.y, p.rotation.z);
}

TriangleMesh mesh_of(const std::string& file) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile((kProps / file).string(), aiProcess_JoinIdenticalVertices);
  TriangleMesh result;
  if (!scene || scene->mNumMeshes != 1) return result;
  const aiMesh& mesh = *scene->mMeshes[0];
  for (unsigned v = 0; v < mesh.mNumVertices; ++v)
    result.vertices.emplace_back(mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z);
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const unsigned* i = mesh.mFaces[f].mIndices;
    result.triangles.push_back({static_cast<int>(i[0]), static_cast<int>(i[1]), static_cast<int>(i[2])});
  }
  return result;
}

/// Volume and what a solid of density 1 has: centre, and inertia about it along the axes of its frame.
struct Solid {
  Real volume;
  Vec3 com;
  Mat3 inertia;
};
/// Sum over the tetrahedra of the origin with each triangle abc: volume det/6, second moments det/120 (s s^T + aa^T + bb^T + cc^T), s = a +
/// b + c.
Solid solid_of(const TriangleMesh& mesh) {
  Real volume = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 &a = mesh.vertices[i], &b = mesh.vertices[j], &c = mesh.vertices[k], s = a + b + c;
    const Real det = a.dot(b.cross(c));
    volume += det / 6;
    first += det / 24 * s;
    second += det / 120 * (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  const Vec3 com = first / volume;
  second -= volume * com * com.transpose();
  return {volume, com, second.trace() * Mat3::Identity() - second};
}
Solid solid_of(const urdf::Geometry& geometry) {
  if (const auto* box = dynamic_cast<const urdf::Box*>(&geometry)) {
    const Real x = box->dim.x, y = box->dim.y, z = box->dim.z, volume = x * y * z;
    return {volume, Vec3::Zero(), volume / 12 * Vec3(y * y + z * z, x * x + z * z, x * x + y * y).asDiagonal()};
  }
  if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&geometry)) {
    const Real r = cylinder->radius, l = cylinder->length, volume = std::numbers::pi * r * r * l, across = (3 * r * r + l * l) / 12;
    return {volume, Vec3::Zero(), volume * Vec3(across, across, r * r / 2).asDiagonal()};
  }
  return solid_of(mesh_of(dynamic_cast<const urdf::Mesh&>(geometry).filename));
}
/// All collision shapes of a link together, by the parallel axis theorem; they do not overlap.
Solid solid_of(const urdf::Link& link) {
  std::vector<Solid> parts;
  Solid all{0, Vec3::Zero(), Mat3::Zero()};
  for (const auto& shape : link.collision_array) {
    const Pose X = pose(shape->origin);
    Solid part = solid_of(*shape->geometry);
    part = {part.volume, X * part.com, X.linear() * part.inertia * X.linear().transpose()};
    all.volume += part.volume;
    all.com += part.volume * part.com;
    parts.push_back(part);
  }
  all.com /= all.volume;
  for (const Solid& part : parts) {
    const Vec3 d = part.com - all.com;
    all.inertia += part.inertia + part.volume * (d.squaredNorm() * Mat3::Identity() - d * d.transpose());
  }
  return all;
}
Mat3 inertia(const urdf::Inertial& i) {
  Mat3 m;
  m << i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz;
  return m;
}

/// Corners of a link's only box [m] in the root's frame, with its joint at q [rad].
std::vector<Vec3> corners(const urdf::ModelInterface& model, const std::string& link_name, Real q) {
  const auto link = model.getLink(link_name);
  const urdf::Joint& joint = *link->parent_joint;
  const Pose X = pose(joint.parent_to_joint_origin_transform) * Eigen::AngleAxisd(q, Vec3(joint.axis.x, joint.axis.y, joint.axis.z)) *
                 pose(link->collision->origin);
  const auto& dim = dynamic_cast<const urdf::Box&>(*link->collision->geometry).dim;
  std::vector<Vec3> result;
  for (int i = 0; i < 8; ++i)
    result.push_back(X * Vec3((i & 1 ? 0.5 : -0.5) * dim.x, (i & 2 ? 0.5 : -0.5) * dim.y, (i & 4 ? 0.5 : -0.5) * dim.z));
  return result;
}
/// Least and greatest of a coordinate.
std::pair<Real, Real> range(const std::vector<Vec3>& points, int axis) {
  std::pair<Real, Real> result{points[0][axis], points[0][axis]};
  for (const Vec3& p : points) result = {std::min(result.first, p[axis]), std::max(result.second, p[axis])};
  return result;
}
}  // namespace

TEST(Props, EachIsAUrdfWithPositiveMassesAndInertiasOfRealBodies) {
  for (const char* name : kNames) {
    const auto model = prop(name);
    ASSERT_TRUE(model) << name;
    EXPECT_EQ(model->getName(), name);
    for (const auto& [link_name, link] : model->links_) {
      if (!link->inertial) {  // a frame: no shapes, fixed
        EXPECT_TRUE(link->collision_array.empty() && link->parent_joint && link->parent_joint->type == urdf::Joint::FIXED) << link_name;
        continue;
      }
      EXPECT_GT(link->inertial->mass, 0) << link_name;
      const Vec3 moments = Eigen::SelfAdjointEigenSolver<Mat3>(inertia(*link->inertial)).eigenvalues();
      EXPECT_GT(moments[0], 0) << link_name;
      EXPECT_GE(moments[0] + moments[1], moments[2] * (1 - 1e-9)) << link_name;  // the triangle inequality
    }
  }
}

TEST(Props, MassIsSpreadEvenlyOverTheShapesOfALink) {
  for (const char* name : kNames) {
    const auto model = prop(name);
    for (const auto& [link_name, link] : model->links_) {
      if (!link->inertial) continue;
      const Solid solid = solid_of(*link);
      const Real density = link->inertial->mass / solid.volume;
      const Mat3 expected = density * solid.inertia;
      EXPECT_LT((pose(link->inertial->origin).translation() - solid.com).norm(), 1e-8) << name << " " << link_name;  // [m]
      EXPECT_LT((inertia(*link->inertial) - expected).norm(), 1e-6 * expected.norm()) << name << " " << link_name;
    }
  }
}

TEST(Props, BladesAreClosedAndTheirEdgeIsStraightOrHasTwentyTeeth) {
  for (const char* file : {"dispenser_blade.obj", "knife_blade.obj"}) {
    const TriangleMesh mesh = mesh_of(file);
    ASSERT_FALSE(mesh.triangles.empty()) << file;
    std::map<std::pair<int, int>, int> directed;
    for (const auto& t : mesh.triangles)
      for (int i = 0; i < 3; ++i) ++directed[{t[i], t[(i + 1) % 3]}];
    for (const auto& [edge, count] : directed) EXPECT_TRUE(count == 1 && directed.contains({edge.second, edge.first})) << file;
    EXPECT_GT(solid_of(mesh).volume, 0) << file;  // turned outward
  }
  const auto tips = [](const TriangleMesh& mesh, Real z) {
    return std::count_if(mesh.vertices.begin(), mesh.vertices.end(), [z](const Vec3& p) { return std::fabs(p.z() - z) < 1e-8; });
  };
  EXPECT_EQ(tips(mesh_of("dispenser_blade.obj"), 0.014), 20);
  EXPECT_EQ(tips(mesh_of("dispenser_blade.obj"), 0.0125), 21);  // between and beside them
  EXPECT_EQ(tips(mesh_of("knife_blade.obj"), 0.02), 2);
}

TEST(Props, TheClosedCartonHasTheGapsThatItsReadmeStates) {
  const auto carton = prop("carton");
  const Real closed = std::numbers::pi / 2, kTol = 1e-9;
  const auto back = corners(*carton, "flap_back", closed), front = corners(*carton, "flap_front", closed);
  const auto right = corners(*carton, "flap_right", closed), left = corners(*carton, "flap_left", closed);
  EXPECT_NEAR(range(back, 1).first - range(front, 1).second, 0.003, kTol);  // mid-gaps
  EXPECT_NEAR(range(right, 0).first - range(left, 0).second, 0.003, kTol);
  for (const auto& inner : {back, front}) EXPECT_NEAR(range(inner, 2).first - 0.2032, 0.0015, kTol);  // hinge gaps above the walls
  for (const auto& outer : {right, left}) EXPECT_NEAR(range(outer, 2).first - 0.2082, 0.0015, kTol);
  EXPECT_NEAR(range(right, 2).first - range(back, 2).second, 0.002, kTol);  // the outer pair above the inner
  EXPECT_NEAR(0.1524 - 0.003 - range(back, 0).second, 0.003, kTol);         // beside the outer walls
}

TEST(Props, FlapsOfTheCartonHangOutsideWithoutTouchingTheWall) {
  const auto carton = prop("carton");
  EXPECT_NEAR(range(corners(*carton, "flap_back", 0), 1).first, 0.1536, 1e-9);  // upright, 1.2 mm outside of the wall
  EXPECT_NEAR(range(corners(*carton, "flap_back", -std::numbers::pi), 1).first, 0.1536, 1e-9);
  EXPECT_LT(range(corners(*carton, "flap_back", -std::numbers::pi), 2).second, 0.2082);
  for (const char* name : {"hinge_back", "hinge_front", "hinge_left", "hinge_right"}) {
    EXPECT_EQ(carton->getJoint(name)->limits->lower, -3);
    EXPECT_DOUBLE_EQ(carton->getJoint(name)->limits->upper, std::numbers::pi / 2);
  }
}

TEST(Props, TheCartonHasTheBoardsMassAndItsOutsideIsTwelveByTwelveByEightInches) {
  const auto carton = prop("carton");
  for (const auto& [name, link] : carton->links_)
    EXPECT_NEAR(link->inertial->mass / solid_of(*link).volume * 0.003, 0.5, 1e-8);  // [kg/m^2]
  const auto& base = carton->getLink("base")->collision_array;
  EXPECT_NEAR(dynamic_cast<const urdf::Box&>(*base[0]->geometry).dim.x, 12 * 0.0254, 1e-9);
  EXPECT_NEAR(dynamic_cast<const urdf::Box&>(*base[0]->geometry).dim.y, 12 * 0.0254, 1e-9);
  EXPECT_NEAR(base[1]->origin.position.z + dynamic_cast<const urdf::Box&>(*base[1]->geometry).dim.z / 2, 8 * 0.0254, 1e-9);
}

TEST(Props, TheCreasesStiffnessHoldsAFlapAtSixtyDegreesOnEitherSide) {
  const auto carton = prop("carton");
  const auto flap = carton->getLink("flap_back");
  const Real kCrease = 0.01401;  // [N m/rad] of README.md
  const Real angle = std::numbers::pi / 3, weight = flap->inertial->mass * 9.81 * flap->inertial->origin.position.z;  // [N m]
  EXPECT_NEAR(kCrease * angle, weight * std::sin(angle), 1e-5);
  EXPECT_GT(kCrease, weight * std::cos(angle));  // and the balance is stable
}

TEST(Props, TheDispenserWeighs313Grams) {
  const auto dispenser = prop("dispenser");
  Real mass = 0;
  for (const auto& [name, link] : dispenser->links_) mass += link->inertial->mass;
  EXPECT_NEAR(mass, 0.313, 0.0005);
  EXPECT_EQ(dispenser->getJoint("wheel_axle")->type, urdf::Joint::CONTINUOUS);
  EXPECT_EQ(dispenser->getJoint("roller_axle")->type, urdf::Joint::CONTINUOUS);
  EXPECT_EQ(dispenser->getJoint("blade_hinge")->limits->upper, 0.1);
}
