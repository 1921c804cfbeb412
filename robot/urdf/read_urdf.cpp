#include "robot/urdf/read_urdf.hpp"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <map>
#include <set>

#include "robot/kinematics/joint_map.hpp"
#include "robot/model/convex_hull.hpp"
#include "robot/model/inertia.hpp"
#include "robot/model/primitives.hpp"
#include "robot/urdf/mesh_file.hpp"
#include "robot/urdf/mesh_uri.hpp"
#include "robot/urdf/srdf.hpp"
#include "robot/urdf/urdf_document.hpp"

namespace robot {
namespace {
constexpr Real kDensity = 1000;            // [kg/m^3] of links that have shapes but no inertia
constexpr Real kTriangleTolerance = 1e-3;  // of the largest principal moment: what rounding in files is allowed to violate

Vec3 vector(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

Pose pose(const urdf::Pose& p) {
  Pose X = Pose::Identity();
  X.translation() = vector(p.position);
  X.linear() = Eigen::Quaterniond(p.rotation.w, p.rotation.x, p.rotation.y, p.rotation.z).toRotationMatrix();
  return X;
}

/// Keeps what urdfdom has to say, instead of printing it.
class Listener : public console_bridge::OutputHandler {
 public:
  Listener() { console_bridge::useOutputHandler(this); }
  ~Listener() override { console_bridge::restorePreviousOutputHandler(); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) errors += "; " + text;
  }
  std::string errors;
};

urdf::ModelInterfaceSharedPtr parse(const std::string& text, const std::string& file) {
  Listener listener;
  try {
    if (auto model = urdf::parseURDF(text); model && listener.errors.empty()) return model;
  } catch (const std::exception& e) {
    listener.errors += std::string("; ") + e.what();
  }
  throw InputError(file + ": no valid URDF" + listener.errors);
}

class Builder {
 public:
  Builder(const std::filesystem::path& file, const UrdfOptions& options)
      : file_(file), options_(options), document_(read_document(file)), urdf_(parse(document_.text, file.string())) {
    for (const std::string& name : document_.joints) {
      const auto joint = urdf_->getJoint(name);
      joints_below_[joint->parent_link_name].push_back(joint);
    }
  }

  RobotModel build() {
    model_.name = urdf_->getName();
    model_.notes = document_.notes;
    model_.links.push_back({.name = urdf_->getRoot()->name});
    add_link(*urdf_->getRoot(), 0, Pose::Identity());
    for (std::size_t l = 0; l < model_.links.size(); ++l) complete_inertia(l);
    for (std::size_t j = 0; j < model_.joints.size(); ++j) model_.joints[j].mimic = find_leader(model_.joints[j].name);
    add_overlaps();
    add_list("taken as unlimited, because they are missing or 0", document_.unlimited);
    add_narrowed();
    return std::move(model_);
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const { throw InputError(file_.string() + ": " + reason); }

  /// A joint that others follow may stand only where these are within their limits too.
  void add_narrowed() {
    const JointMap map = joint_map(model_);
    for (std::size_t u = 0; u < map.independent.size(); ++u) {
      const Joint& joint = model_.joints[static_cast<std::size_t>(map.independent[u])];
      const Real lower = map.lower[static_cast<Eigen::Index>(u)], upper = map.upper[static_cast<Eigen::Index>(u)];
      if (lower > joint.lower || upper < joint.upper)
        model_.notes.push_back(fmt::format("joint {} has only {:g} to {:g} of its {:g} to {:g}, by the limits of joints that follow it{}",
                                           joint.name, lower, upper, joint.lower, joint.upper, lower == upper ? ": it cannot move" : ""));
    }
  }

  void add_list(const std::string& what, const std::vector<std::string>& items) {
    if (!items.empty()) model_.notes.push_back(fmt::format("{}: {}", what, fmt::join(items, ", ")));
  }

  /// A link of the file becomes part of link `index` of the model, and what hangs on it follows.
  void add_link(const urdf::Link& link, int index, const Pose& X_LU) {
    Link& body = model_.links[static_cast<std::size_t>(index)];
    if (link.inertial) {
      body.inertial = combined(body.inertial, moved(X_LU, checked(*link.inertial, link.name, link.name != body.name)));
    } else if (!link.visual_array.empty() || !link.collision_array.empty()) {
      without_inertia_[index].push_back(link.name);
    }
    for (const auto& visual : link.visual_array) {
      body.visual.push_back(shape(*visual->geometry, X_LU * pose(visual->origin), link.name));
      if (const auto& m = visual->material) body.visual.back().color = {m->color.r, m->color.g, m->color.b};
    }
    for (const auto& collision : link.collision_array)
      body.collision.push_back(shape(*collision->geometry, X_LU * pose(collision->origin), link.name));
    for (const auto& joint : joints_below_[link.name]) {
      const Pose X_LJ = X_LU * pose(joint->parent_to_joint_origin_transform);
      const urdf::Link& child = *urdf_->getLink(joint->child_link_name);
      if (joint->type == urdf::Joint::FIXED) {
        model_.frames.push_back({child.name, index, X_LJ});
        add_link(child, index, X_LJ);
      } else {
        model_.joints.push_back(moving_joint(*joint, index, X_LJ));
        model_.links.push_back({.name = child.name});
        add_link(child, static_cast<int>(model_.links.size()) - 1, Pose::Identity());
      }
    }
  }

  static Joint moving_joint(const urdf::Joint& from, int parent, const Pose& X_PJ) {
    Joint joint{.name = from.name, .parent = parent, .X_PJ = X_PJ, .axis = vector(from.axis).normalized()};
    joint.type = from.type == urdf::Joint::PRISMATIC    ? JointType::prismatic
                 : from.type == urdf::Joint::CONTINUOUS ? JointType::continuous
                                                        : JointType::revolute;
    if (from.limits && joint.type != JointType::continuous) {
      joint.lower = from.limits->lower;
      joint.upper = from.limits->upper;
    }
    if (from.limits && from.limits->effort > 0) joint.effort = from.limits->effort;
    if (from.limits && from.limits->velocity > 0) joint.velocity = from.limits->velocity;
    if (from.dynamics) {
      joint.damping = from.dynamics->damping;
      joint.friction = from.dynamics->friction;
    }
    return joint;
  }

  Shape shape(const urdf::Geometry& geometry, const Pose& X_LS, const std::string& link) {
    if (const auto* box = dynamic_cast<const urdf::Box*>(&geometry)) return box_shape(vector(box->dim), X_LS);
    if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&geometry))
      return cylinder_shape(cylinder->radius, cylinder->length, X_LS);
    if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(&geometry)) return sphere_shape(sphere->radius, X_LS);
    const auto& mesh = dynamic_cast<const urdf::Mesh&>(geometry);
    const std::filesystem::path found = find_mesh(mesh.filename, file_, options_.package_root, "link '" + link + "'");
    const Vec3 scale = vector(mesh.scale);
    const auto key = std::pair(found, std::array{scale.x(), scale.y(), scale.z()});  // visual and collision often share a file
    if (!meshes_.contains(key)) meshes_[key] = read_mesh(found, scale, options_.honour_up_axis);
    return {.kind = Shape::Kind::mesh, .X_LS = X_LS, .mesh = meshes_[key], .file = found.string()};
  }

  /// In the frame of its link.
  /// @param merged  into another: it may be a mass in a point
  Inertial checked(const urdf::Inertial& from, const std::string& link, bool merged) {
    Mat3 inertia;
    inertia << from.ixx, from.ixy, from.ixz, from.ixy, from.iyy, from.iyz, from.ixz, from.iyz, from.izz;
    if (merged && inertia.isZero(0)) return moved(pose(from.origin), {from.mass, Vec3::Zero(), inertia});
    const Vec3 m = principal_moments(inertia);
    const std::string said = fmt::format("link '{}', inertia: principal moments = {}, {}, {} kg m^2", link, m[0], m[1], m[2]);
    if (m[0] <= 0) fail(said + ": allowed is > 0 each");
    const Real excess = m[2] - m[0] - m[1];  // zero for a flat body, less for any other
    if (excess > kTriangleTolerance * m[2]) fail(said + ": allowed is none above the sum of the two others, as of any body");
    if (excess > 0) model_.notes.push_back(said + ": the largest is above the sum of the others by rounding");
    return moved(pose(from.origin), {from.mass, Vec3::Zero(), inertia});
  }

  /// A moving link of which no part has an inertia gets that of its shapes.
  void complete_inertia(std::size_t l) {
    Link& link = model_.links[l];
    const auto& bare = without_inertia_[static_cast<int>(l)];
    if (link.inertial.mass > 0 || l == 0) {
      if (link.inertial.mass > 0) add_list(fmt::format("no inertia is given for these parts of link {}; they add none", link.name), bare);
      return;
    }
    std::vector<Vec3> points;
    for (const Shape& s : link.collision.empty() ? link.visual : link.collision)
      for (const Vec3& v : s.mesh.vertices) points.push_back(s.X_LS * v);
    if (points.empty()) fail(fmt::format("link '{}' moves, but has neither an inertia nor a shape to take one from", link.name));
    try {
      link.inertial = solid(convex_hull(points), kDensity);
    } catch (const InputError& e) {
      fail(fmt::format("link '{}' has no inertia, and none follows from its shapes: {}", link.name, e.what()));
    }
    model_.notes.push_back(
        fmt::format("link {} has no inertia; taken is a solid of {} kg/m^3 in the convex hull of its {} shapes: {:.4g} kg", link.name,
                    kDensity, link.collision.empty() ? "visual" : "collision", link.inertial.mass));
  }

  /// Through chains of mimics: q = m1 (m2 q2 + o2) + o1.
  std::optional<Mimic> find_leader(const std::string& follower) const {
    auto mimic = urdf_->getJoint(follower)->mimic;
    if (!mimic) return {};
    Mimic total;
    std::set<std::string> passed{follower};
    std::string leader = follower;
    for (; mimic; mimic = urdf_->getJoint(leader)->mimic) {
      total.offset += total.multiplier * mimic->offset;
      total.multiplier *= mimic->multiplier;
      leader = mimic->joint_name;
      total.joint = model_.find_joint(leader);
      if (total.joint < 0)
        fail(fmt::format("joint '{}', mimic: joint = \"{}\": allowed is the name of a joint that moves", follower, leader));
      if (!passed.insert(leader).second) fail(fmt::format("joint '{}', mimic: it follows itself, through joint '{}'", follower, leader));
    }
    return total;
  }

  void add_overlaps() {
    std::set<std::pair<int, int>> pairs;
    for (std::size_t j = 0; j < model_.joints.size(); ++j) pairs.emplace(model_.joints[j].parent, static_cast<int>(j) + 1);
    std::vector<std::string> unknown;
    for (const auto& [a, b] : disabled_pairs()) {
      const auto A = model_.find_frame(a), B = model_.find_frame(b);
      for (const auto& [name, found] : {std::pair(a, A), std::pair(b, B)})
        if (!found && std::find(unknown.begin(), unknown.end(), name) == unknown.end()) unknown.push_back(name);
      if (A && B && A->link != B->link) pairs.insert(std::minmax(A->link, B->link));
    }
    model_.may_overlap.assign(pairs.begin(), pairs.end());
    add_list("the SRDF file names links that the robot does not have", unknown);
  }

  std::vector<std::pair<std::string, std::string>> disabled_pairs() const {
    std::filesystem::path srdf = options_.srdf;
    if (srdf.empty() && !std::filesystem::exists(srdf = std::filesystem::path(file_).replace_extension(".srdf"))) return {};
    std::vector<std::string> links;
    for (const auto& [name, link] : urdf_->links_) links.push_back(name);
    return read_disabled_collisions(srdf, links);
  }

  std::filesystem::path file_;
  UrdfOptions options_;
  UrdfDocument document_;
  urdf::ModelInterfaceSharedPtr urdf_;
  std::map<std::string, std::vector<urdf::JointConstSharedPtr>> joints_below_;  // each link
  std::map<int, std::vector<std::string>> without_inertia_;                     // of each link of the model: parts that have shapes
  std::map<std::pair<std::filesystem::path, std::array<Real, 3>>, TriangleMesh> meshes_;
  RobotModel model_;
};
}  // namespace

RobotModel read_urdf(const std::filesystem::path& file, const UrdfOptions& options) { return Builder(file, options).build(); }
}  // namespace robot
