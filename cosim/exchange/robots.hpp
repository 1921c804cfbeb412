#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "robot/control/trajectory.hpp"
#include "robot/kinematics/joint_map.hpp"
#include "robot/world/world.hpp"
#include "tape/core/settings.hpp"
#include "tape/model/moment.hpp"
#include "tape/model/scene.hpp"

namespace cosim {
/// How the two worlds go through a step together (README.md).
enum class Schedule { inertial, kinematic, iterated, posed };
constexpr auto enum_names(Schedule) { return std::array<std::string_view, 4>{"inertial", "kinematic", "iterated", "posed"}; }

struct ExchangeParams {
  Schedule schedule = Schedule::inertial;
  int iterations = 20;
  double tolerance = 1e-3;
  template <class F>
  void fields(F&& f) {
    using tape::Range;
    f("schedule", schedule, "", Range::any(),
      "inertial: tape and links are solved together; kinematic: links push and feel nothing; iterated: in turns; posed: kinematic, with "
      "joints where they are told to be, without drives");
    f("iterations", iterations, "1", Range::closed(1, 1000), "most turns of the iterated schedule");
    f("tolerance", tolerance, "1", Range::above(0, 1), "change of the forces between two turns at which the iterated schedule ends");
  }
};

/// A motion of a script. Where it starts from may hang on when it starts; how long it takes does not.
struct RobotMotion {
  std::function<robot::JointTrajectory(const robot::VecX& q)> plan;  ///< from what the joints [nj] are told then; its time counts from 0
  tape::Moment start = 0;
  double duration = 0;              ///< [s]
  int until = -1;                   ///< event at which it stops before its time; -1: none
  std::filesystem::path file = {};  ///< that its numbers come from, or empty
};

/// A robot or a prop of a scene.
struct RobotPart {
  std::string name;
  std::shared_ptr<const robot::RobotModel> model = {};
  robot::RobotParams params = {};
  robot::VecX start = {};                      ///< [nj] joint positions
  std::vector<RobotMotion> motions = {};       ///< in the order in which they start; of two that move a joint, the later one does
  robot::VecX target = {};                     ///< [nj] that the drives are told until a motion says otherwise, or empty: the start
  robot::Vec3 velocity = robot::Vec3::Zero();  ///< [m/s] of a free base at the start
  std::vector<double> push = {};               ///< [nj] N m or N that the drives exert beside what they hold, or empty
  int material = 0;                            ///< of all its links, index into tape::Scene::materials
  double xi = 0;                               ///< [m] half-thickness of their surfaces
};

struct RobotScene {
  ExchangeParams exchange;
  robot::WorldParams world;
  std::vector<RobotPart> robots;
};

/// What the drives of a robot are told, as far as is known when its motions start.
class RobotScript {
 public:
  /// @param events  [s] when each has happened (tape::Moment); motions after those that have not are left out
  RobotScript(const RobotPart& robot, const std::vector<double>& events);
  /// [nj] positions and velocities of the motions, the robot's target where none has begun; joints that follow others follow.
  std::vector<robot::JointCommand> commands_at(double time) const;
  /// [nj] positions of these.
  robot::VecX told_at(double time) const;

 private:
  struct Motion {
    robot::JointTrajectory way;
    double until;             // [s]
    std::vector<int> joints;  // of the model
  };
  const RobotPart* robot_;
  robot::JointMap followers_;
  std::vector<Motion> motions_;
};

/// "robot:link", the body that a link is on the tape side.
std::string body_name(const RobotPart& robot, int link);

/// Appends the links to a scene as bodies, and for each robot that moves an articulation of the same name.
void add_links(const RobotScene& robots, tape::Scene& scene);

/// Moves the bodies that are links to where the robots start.
void place_links(const RobotScene& robots, tape::Scene& scene);

/// Bullet's world of these robots, at its start. Links of one robot that stand inside each other there do not touch.
/// @throws tape::InputError where links of two of them stand deep inside each other
robot::World make_world(const RobotScene& robots);

/// What was assumed of the robots' files and of how they start, a sentence each.
std::vector<std::string> notes_on(const RobotScene& robots);
}  // namespace cosim
