#pragma once
#include <filesystem>
#include <map>

#include "robot/control/trajectory.hpp"

namespace robot {
/// Named postures of a hand, for every hand whose joints have these names after a prefix of their own.
struct HandPostures {
  enum class Unit { fraction, rad };
  std::string file;                      ///< for messages
  std::vector<std::string> joints;       ///< [n] without prefix
  std::map<std::string, VecX> postures;  ///< [n] each
  Unit unit = Unit::fraction;            ///< fraction: 0 is q = 0 or the limit next to it, 1 the upper, -1 the lower limit

  std::vector<std::string> joints_of(const std::string& prefix) const;  ///< [n] names in the model

  /// Angles [n] rad of a posture.
  /// @throws InputError naming the posture if it is unknown; the joint if the model has none of that name, or it would leave its limits
  VecX angles(const RobotModel& model, const std::string& prefix, const std::string& posture) const;

  /// From angles q [n] rad to a posture, rest to rest in `duration` [s], > 0.
  JointTrajectory move(const RobotModel& model, const std::string& prefix, const VecX& q, const std::string& posture, Real duration) const;
};

/// Reads a YAML file:
///   unit: fraction
///   postures:
///     open: {finger1_joint1: 0, finger1_joint2: 0}
/// @throws InputError with file, line and key if it is not of this form, or a posture lacks a joint that another has
HandPostures read_postures(const std::filesystem::path& file);
}  // namespace robot
