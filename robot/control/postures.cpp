#include "robot/control/postures.hpp"

#include <fmt/format.h>

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>

#include "robot/kinematics/joint_map.hpp"

namespace robot {
namespace {
/// A posture file while it is read.
class PostureReader {
 public:
  explicit PostureReader(const std::filesystem::path& file) { result_.file = file.string(); }

  HandPostures read() {
    const YAML::Node root = load();
    require_section(root, result_.file);
    for (const auto& entry : root) {
      const std::string key = entry.first.Scalar();
      if (key == "unit")
        result_.unit = unit_of(entry.second);
      else if (key != "postures")
        fail(entry.first, key, "is unknown (allowed: unit, postures)");
    }
    const YAML::Node postures = root["postures"];
    if (!postures) fail(root, "postures", "is missing");
    require_section(postures, "postures");
    for (const auto& entry : postures) read_posture(entry.first, entry.second);
    if (result_.postures.empty()) fail(postures, "postures", "is empty (allowed: at least one)");
    return std::move(result_);
  }

 private:
  YAML::Node load() const {
    try {
      return YAML::LoadFile(result_.file);
    } catch (const YAML::BadFile&) {
      throw InputError(result_.file + ": cannot be read");
    } catch (const YAML::Exception& e) {
      throw InputError(fmt::format("{}:{}: not valid YAML: {}", result_.file, e.mark.line + 1, e.msg));
    }
  }
  [[noreturn]] void fail(const YAML::Node& node, const std::string& key, const std::string& reason) const {
    throw InputError(fmt::format("{}:{}: {}: {}", result_.file, std::max(node.Mark().line, 0) + 1, key, reason));
  }
  void require_section(const YAML::Node& node, const std::string& key) const {
    if (!node.IsMap()) fail(node, key, "is no section of keys and values");
  }

  HandPostures::Unit unit_of(const YAML::Node& node) const {
    const std::string unit = node.IsScalar() ? node.Scalar() : "";
    if (unit != "fraction" && unit != "rad") fail(node, "unit", unit + " (allowed: fraction, rad)");
    return unit == "rad" ? HandPostures::Unit::rad : HandPostures::Unit::fraction;
  }

  void read_posture(const YAML::Node& name, const YAML::Node& values) {
    const std::string key = "postures." + name.Scalar();
    require_section(values, key);
    if (result_.postures.contains(name.Scalar())) fail(name, key, "is there twice");
    const bool first = result_.postures.empty();
    VecX posture = VecX::Constant(first ? values.size() : result_.joints.size(), std::nan(""));
    for (const auto& entry : values) {
      const std::string joint = entry.first.Scalar();
      auto at = std::find(result_.joints.begin(), result_.joints.end(), joint);
      if (first && at == result_.joints.end()) at = result_.joints.insert(at, joint);
      if (at == result_.joints.end()) fail(entry.first, key + "." + joint, "is no joint of the first posture");
      Real& value = posture[at - result_.joints.begin()];
      if (!std::isnan(value)) fail(entry.first, key + "." + joint, "is there twice");
      value = number(entry.second, key + "." + joint);
    }
    for (std::size_t j = 0; j < result_.joints.size(); ++j)
      if (std::isnan(posture[j])) fail(name, key, "joint " + result_.joints[j] + " is missing");
    result_.postures[name.Scalar()] = posture;
  }
  Real number(const YAML::Node& node, const std::string& key) const {
    Real value = std::nan("");
    if (!node.IsScalar() || !YAML::convert<Real>::decode(node, value) || !std::isfinite(value)) fail(node, key, "is no finite number");
    if (result_.unit == HandPostures::Unit::fraction && std::fabs(value) > 1) fail(node, key, node.Scalar() + " (allowed: -1 to 1)");
    return value;
  }

  HandPostures result_;
};

/// Angle [rad] for a value in the unit of the file.
Real angle_of(Real value, HandPostures::Unit unit, Real lower, Real upper) {
  if (unit == HandPostures::Unit::rad) return value;
  const Real zero = std::clamp(0., lower, upper);
  if (value == 0) return zero;  // also where there is no limit
  return value > 0 ? zero + value * (upper - zero) : zero - value * (lower - zero);
}
}  // namespace

std::vector<std::string> HandPostures::joints_of(const std::string& prefix) const {
  std::vector<std::string> names;
  for (const std::string& joint : joints) names.push_back(prefix + joint);
  return names;
}

VecX HandPostures::angles(const RobotModel& model, const std::string& prefix, const std::string& posture) const {
  const auto found = postures.find(posture);
  if (found == postures.end()) {
    std::string known;
    for (const auto& [name, values] : postures) known += (known.empty() ? "" : ", ") + name;
    throw InputError(fmt::format("{}: there is no posture {} (allowed: {})", file, posture, known));
  }
  const std::vector<std::string> names = joints_of(prefix);
  VecX q(joints.size());
  for (std::size_t j = 0; j < names.size(); ++j) {
    const int k = model.find_joint(names[j]);
    if (k < 0) throw InputError(fmt::format("{}: posture {}: robot {} has no joint {}", file, posture, model.name, names[j]));
    const auto [lower, upper] = joint_range(model, k);
    q[j] = angle_of(found->second[j], unit, lower, upper);
    if (!std::isfinite(q[j]) || q[j] < lower || q[j] > upper)
      throw InputError(fmt::format("{}: posture {}, joint {} = {:g} rad (allowed: {:g} to {:g} rad, finite)", file, posture, names[j], q[j],
                                   lower, upper));
  }
  return q;
}

JointTrajectory HandPostures::move(const RobotModel& model, const std::string& prefix, const VecX& q, const std::string& posture,
                                   Real duration) const {
  const std::vector<std::string> names = joints_of(prefix);
  const Real unlimited = std::numeric_limits<Real>::infinity();
  return trajectory_at(names, {q, angles(model, prefix, posture)}, {0, duration}, motion_limits(model, names, 1, unlimited));
}

HandPostures read_postures(const std::filesystem::path& file) { return PostureReader(file).read(); }
}  // namespace robot
