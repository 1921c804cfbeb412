#pragma once
#include <array>
#include <string>
#include <vector>

#include "cosim/episode/calibration.hpp"
#include "robot/model/robot_model.hpp"

namespace cosim {
/// What the numbers of a recorded joint count. `one`: a share of a range, as hands report 0..1.
enum class Unit { rad, deg, m, mm, one };
constexpr auto enum_names(Unit) { return std::array<std::string_view, 5>{"rad", "deg", "m", "mm", "1"}; }
/// [rad or m per unit]; 1 for a share.
Real si_per(Unit unit);

struct RecordedJoint {
  std::string name;
  Unit unit = Unit::rad;
};

/// What one device recorded on the episode's clock: an arm, a hand, or all together.
struct MotionStream {
  std::string name;
  std::vector<RecordedJoint> joints;        ///< [nj]
  std::vector<Real> times;                  ///< [nt] s since the start of the recording, strictly increasing
  std::vector<robot::VecX> measured = {};   ///< [nt][nj] in the joints' units; empty: not recorded
  std::vector<robot::VecX> commanded = {};  ///< [nt][nj] likewise
};

struct EpisodeCamera {
  std::string name;
  Calibration calibration;
  std::string mount = "world";     ///< frame B of the poses: the scene's world, or the link "robot:link" that carries the camera
  std::vector<Real> times = {};    ///< [np] s, strictly increasing; empty: the one pose holds at all times
  std::vector<Pose> poses = {{}};  ///< [np] X_BC
};

/// Which point of the hub a landmark is: the centre of the ellipse that its inner rim makes or, seen from the side, its middle.
enum class LandmarkKind { rim, side_box };
constexpr auto enum_names(LandmarkKind) { return std::array<std::string_view, 2>{"rim", "side_box"}; }

struct Landmark {
  Real time = 0;     ///< [s] on the episode's clock
  Vec2 pixel{0, 0};  ///< [px]
  LandmarkKind kind = LandmarkKind::rim;
  bool visible = true;     ///< off: the pixel means nothing
  bool estimated = false;  ///< drawn from visible parts of a partly hidden contour
};

/// The landmarks of one body in the pictures of one camera.
struct LandmarkTrack {
  std::string camera;
  std::string body = "hub";              ///< of the scene
  int width = 848, height = 480;         ///< [px] of the pictures in which they were marked
  bool undistorted = false;              ///< marked in undistorted pictures, not in those as the lens makes them
  std::vector<Landmark> landmarks = {};  ///< by time
};

/// One recording of a robot at work. README.md says what each part means.
struct Episode {
  std::string name;
  std::string origin = {};  ///< who recorded it, or the file that it was imported from
  std::vector<MotionStream> streams = {};
  std::vector<EpisodeCamera> cameras = {};
  std::vector<LandmarkTrack> landmarks = {};

  /// Made by a simulation that plays the real world: its origin begins with this word.
  bool synthetic() const { return origin.starts_with("synthetic"); }

  struct Span {
    Real start, end;  ///< [s]
  };
  /// In which every stream is recorded; start > end if there is no such time. Assumes that the episode is sound.
  Span common() const;
  /// @throws InputError naming `where` if there is no such camera, with the names that there are
  const EpisodeCamera& camera(const std::string& name, const std::string& where) const;
};

/// @param where  what messages start with: the file
/// @throws InputError naming stream, row, joint, camera or landmark, the value and what is allowed: sizes that differ, names missing or
///         twice, numbers that are not finite, time that does not increase, values beyond all reason for their unit, rotations that are
///         none, landmarks of no camera, outside of their picture or marked in pictures of another size than the camera is calibrated for
void require_sound(const Episode& episode, const std::string& where);

/// What is strange but may be: gaps in time, degrees that look like radians, landmarks before or after the motion. A sentence each.
std::vector<std::string> remarks(const Episode& episode);
}  // namespace cosim
