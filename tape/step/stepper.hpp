#pragma once
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tape/bodies/articulation.hpp"
#include "tape/step/world.hpp"

namespace tape {
enum class Backend { automatic, cpu, cuda };
constexpr auto enum_names(Backend) { return std::array<std::string_view, 3>{"auto", "cpu", "cuda"}; }

/// Time and size of one effect in a step.
struct EffectReport {
  std::string name;
  Real ms = 0;
  Real energy = 0;   ///< [J] stored at the end of the step; inertia and friction: 0
  int elements = 0;  ///< that contributed at the end of the step
};
/// Time of a stage of the solver in a step.
struct StageReport {
  std::string name;
  Real ms = 0;
};

/// What an adhesive interface carries at the end of a step, of what is awake.
struct AdhesionReport {
  Real normal = 0;      ///< [N] sum over pairs of the forces that hold them together
  Real tangential = 0;  ///< [N] sum over pairs of the magnitudes of the forces against sliding
  int live = 0;         ///< pairs that adhere
  /// [m] the part of the first strip's length where it adheres: rest coordinates of the first and the last place of a live pair; from > to
  /// without any. In a peel one of them is the front.
  Real from = std::numeric_limits<Real>::infinity(), to = -std::numeric_limits<Real>::infinity();
};

/// Outcome of one step: numbers, not text.
struct StepReport {
  bool ok = true;
  std::string failure;  ///< what went wrong and where, if not ok
  Real dt = 0;          ///< [s] of the whole step
  int substeps = 1;     ///< more than 1: retried at a fraction of dt
  int newton = 0;       ///< iterations, all substeps
  int halvings = 0;     ///< of the line search
  int shortened = 0;    ///< updates that were made shorter before the search: their way was too long, or swept through too much
  int hessian_fallbacks = 0;
  int linear_iterations = 0;
  int linear_failures = 0;  ///< solves that ended at their iteration limit
  std::string linear_solver;
  Real last_update = 0;                                  ///< [m] largest move of a vertex in the last Newton update, before any limit
  Real stop_error_estimate = 0;                          ///< [m] what the stop may have left on the table
  Real min_gap = std::numeric_limits<Real>::infinity();  ///< [m] smallest d - xi among candidate pairs at the end (edges: those in the
                                                         ///< guard's reach); infinite without any
  int candidates = 0, active_pairs = 0, searches = 0;
  int ccd_capped = 0;                    ///< CCD queries that ended at their iteration limit (the step was shorter, still safe)
  Real kinetic = 0;                      ///< [J] at the end of the step
  Vec3 momentum = Vec3::Zero();          ///< [kg m/s] of all that moves, at the end
  Vec3 angular_momentum = Vec3::Zero();  ///< [kg m^2/s] about the world's origin
  Real max_strain = 0;                   ///< [1] largest principal membrane strain in magnitude
  std::vector<EffectReport> effects;
  std::vector<StageReport> stages;
  Real adhesion_work = 0;  ///< [J] change of the energy of what adheres by what was remembered of the step: growth of beta adds
  Real woken = 0;          ///< [J] stored in what has woken, less that in what has fallen asleep, at the end
  int asleep = 0;          ///< strip vertices that bodies carry because they lie still there, at the end
  std::vector<AdhesionReport> adhesion;           ///< [Scene::adhesives]
  std::vector<Vec3> grip_force;                   ///< [grips] N that the grip exerts on what it holds
  std::vector<Real> axle_torque;                  ///< [axles] N m that the axle exerts on the body, about its axis
  Real axle_work = 0;                             ///< [J] of these torques in the step: of drives, less what friction takes
  std::vector<Vec3> body_force;                   ///< [bodies] N of contact and grips on the body (driven and dynamic)
  std::vector<Pose> body_pose;                    ///< [bodies] X_WB at the end
  std::vector<ArticulationReport> articulations;  ///< [Scene::articulations]
  std::vector<BladePressure> blades;              ///< [Scene::blades] at the end
  std::optional<Real> exchange_residual;  ///< [1] momentum given to free robots that did not arrive, of what was; none: no such touched
  int unsettled_substeps = 0;             ///< of what simulates the articulations, those that it ended without having solved them
  Real link_mismatch = 0;  ///< [m] farthest that a point of a link stands from where what simulates the articulations has it, at the end
  Real wall_ms = 0;
};

/// Advances a state, on one back end.
class Stepper {
 public:
  virtual ~Stepper() = default;
  /// One step of setup.scene.time.dt. On failure (report.ok false) the state is the last good one.
  /// @param exchange  needed where the scene has articulations
  virtual StepReport step(State& state, const Exchange& exchange = {}) = 0;
  /// After a cut has changed the world and the state: takes both up. @return [J] that is stored now
  virtual Real renew(const State& state) = 0;
  /// Magnitude [N] of the sum of the barrier's forces on each vertex at the last state, for pictures.
  virtual std::vector<Real> contact_force() const = 0;
};

bool cuda_available();
/// Whether a stepper of this back end runs on CUDA: `automatic` does where a device answers, unless the scene asks for a linear solver that
/// only the CPU has.
bool runs_on_cuda(Backend backend, const World& world);
/// @throws InputError if the back end is not there
std::unique_ptr<Stepper> make_stepper(Backend backend, const World& world);
}  // namespace tape
