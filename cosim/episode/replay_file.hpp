#pragma once
#include "cosim/episode/recording.hpp"
#include "cosim/run/read_run.hpp"

namespace cosim {
/// Which of the recorded positions the robots follow.
enum class Follow { measured, commanded };
constexpr auto enum_names(Follow) { return std::array<std::string_view, 2>{"measured", "commanded"}; }

struct ReplayParams {
  Real lead_in = 3;    ///< [s] after the start that no error is counted in
  Real max_gap = 0.1;  ///< [s] between two rows of the motion
  Real slack = 0.02;   ///< [rad or m] beyond a joint's limits
  Follow follow = Follow::measured;
  template <class F>
  void fields(F&& f) {
    f("lead_in", lead_in, "s", Range::closed(0, 1e6), "time after the start in which errors are not counted");
    f("max_gap", max_gap, "s", Range::above(0, 1e6), "longest interval between two recorded positions");
    f("slack", slack, "rad or m", Range::closed(0, 10), "how far recorded positions may lie beyond a joint's limits");
    f("follow", follow, "", Range::any(), "what the robots are told: the measured or the commanded positions");
  }
};

/// A recorded joint that moves one of the scene:  q = sign scale (recorded) + offset, recorded in rad, m or as a share.
struct DrivenJoint {
  std::string recorded, robot, joint;
  Unit unit = Unit::rad;  ///< recorded
  Real sign = 1;
  Real scale = 1;   ///< [1], of a share [rad or m]
  Real offset = 0;  ///< [rad or m]
  Follow follow = Follow::measured;
  std::string where = {};  ///< "file:line"
};

/// Photographs that the camera of a replay took, at equal intervals.
struct Photographs {
  std::vector<std::filesystem::path> files;  ///< in the order of their names, which is that of time
  Real rate = 30;                            ///< [1/s]
  Real first = 0;                            ///< [s] on the episode's clock, of the first
  template <class F>
  void fields(F&& f) {
    f("rate", rate, "1/s", Range::above(0, 1e4), "photographs per second");
    f("first", first, "s", Range::closed(-1e6, 1e6), "time of the first on the recording's clock");
  }
};

/// What EPISODE.yaml asks for (README.md): a scene, a recording, and how one moves in the other.
struct Replay {
  std::string name;
  std::filesystem::path scene;
  std::vector<std::string> overrides;  ///< of keys of the scene: "path.to.key=value"
  Episode episode;
  std::string camera;  ///< in whose pictures it is scored; its calibration may have been replaced; empty: not scored
  Photographs photographs;
  Real start = 0;  ///< [s] on the episode's clock, at which the simulation's time is 0
  ReplayParams params;
  std::vector<DrivenJoint> joints;
};

/// Reads EPISODE.yaml and the recording that it names.
/// @throws InputError "file:line: key = value: reason": a joint that the recording lacks, that drives nothing or is driven twice, another
///         unit than recorded, a camera that was not there or is calibrated for another resolution; and what read_episode refuses
Replay read_replay(const SceneFile& file);

/// Gives the robots of the scene the recorded motion, on the simulation's clock, and where it starts as their start. What a script would
/// do with a robot that the recording moves does not happen.
/// @throws InputError "file:line: ..." for a robot or joint that the scene lacks, one that follows another, a position beyond its limits;
///         for a gap
void add_motions(const Replay& replay, RobotScene& robots);

/// Makes a scene the replay: robots move and start as recorded, and it lasts as long as the recording.  @throws InputError as add_motions
void set_up(const Replay& replay, RunInput& input);
}  // namespace cosim
