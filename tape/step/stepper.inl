#pragma once
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <utility>

#include "tape/bodies/configuration.hpp"
#include "tape/bodies/free_flight.hpp"
#include "tape/contact/gap.hpp"
#include "tape/contact/search.hpp"
#include "tape/contact/surface_fans.hpp"
#include "tape/solver/articulations.inl"
#include "tape/solver/linear_solver.hpp"
#include "tape/solver/objective.inl"
#include "tape/solver/remember.inl"
#include "tape/step/cut.hpp"
#include "tape/step/finish.hpp"
#include "tape/step/reduce.hpp"
#include "tape/step/sleep.hpp"
#include "tape/step/stepper.hpp"

namespace tape::TAPE_SIDE {
namespace stepping {
struct Negate {
  Span<const Vec3> in;
  Span<Vec3> out;
  TAPE_HD void operator()(int i) const { out[i] = -in[i]; }
};
/// Largest component [m] of the move of a vertex.
struct Travel {
  Span<const Vec3> from, to;
  TAPE_HD Real operator()(int v) const { return (to[v] - from[v]).cwiseAbs().maxCoeff(); }
};
/// Bound [m] on the length of the way of a vertex.
struct Way {
  PathView paths;
  TAPE_HD Real operator()(int v) const {
    const VertexPath p = paths[v];
    return p.velocity.norm() + p.spin.norm() * p.arm.norm();
  }
};
struct Scale {
  Span<Vec3> out;
  Real factor;
  TAPE_HD void operator()(int i) const { out[i] *= factor; }
};
struct Copy {
  Span<const ContactPair> from;
  Span<ContactPair> to;
  TAPE_HD void operator()(int i) const { to[i] = from[i]; }
};
template <class T>
struct Strain {
  T term;
  StateView s;
  objective::Selection select;
  TAPE_HD Real operator()(int i) const { return term.strain(s, select[i]); }
};
/// What element i adds to the report of one interface.
template <class T>
struct Adheres {
  T term;
  StateView s;
  int interface, turned;   ///< in both orders of its materials
  Span<const Real> along;  ///< [strip vertices] m, rest coordinate along the strip
  TAPE_HD AdhesionReport operator()(int i) const {
    const AdhesiveForce f = term.force(s, i);
    AdhesionReport out;
    if (!f.live || (f.interface != interface && f.interface != turned)) return out;
    out.normal = f.normal, out.tangential = f.tangential, out.live = 1;
    if (f.vertex[0] < along.size) {
      Real place = 0;
      for (int k = 0; k < 3; ++k) place += f.weight[k] * along[f.vertex[k]];
      out.from = out.to = place;
    }
    return out;
  }
};
struct AddAdhesion {
  TAPE_HD AdhesionReport operator()(AdhesionReport a, const AdhesionReport& b) const {
    a.normal += b.normal, a.tangential += b.tangential, a.live += b.live;
    a.from = std::fmin(a.from, b.from), a.to = std::fmax(a.to, b.to);
    return a;
  }
};
struct Fill {
  Span<Vec3> out;
  TAPE_HD void operator()(int i) const { out[i].setZero(); }
};
}  // namespace stepping

/// One step of the solver on one side.
class SideStepper final : public Stepper {
 public:
  explicit SideStepper(const World& world) : world_(world), articulations_(world.assembly), linear_(world.setup.linear) {
    std::vector<Real> mu;
    std::vector<Adhesion> adhesion;
    for (int a = 0; a < world.surface.materials; ++a) {
      for (int b = 0; b < world.surface.materials; ++b) {
        mu.push_back(world.setup.scene.mu(a, b));
        adhesion.push_back(world.setup.scene.adhesion(a, b));
      }
    }
    mu_.upload(mu);
    adhesion_.upload(adhesion);
    take_world();
    const State state = State::start(world);
    begin(state, world.setup.scene.time.dt);
    take_up(state);
  }

  Real renew(const State& state) override {
    take_world();
    begin(state, world_.setup.scene.time.dt);
    prescribe(Drive::at(world_, state, state.time, 0));
    take_up(state);
    recall(state.memory);
    return stored_energy();
  }

  StepReport step(State& state, const Exchange& exchange) override {
    StepReport report;
    take(exchange);
    const Real dt = world_.setup.scene.time.dt;
    report.dt = dt;
    reset_times();
    {
      const Stopwatch watch(report.wall_ms);
      if (grip_wakes_tape(world_, state)) report.woken = wake_all(state);
      std::optional<State> next = advance(state, dt, world_.setup.newton.retries, report);
      if (is_to_wake(state, next)) {
        report.woken += wake_all(state);
        report.failure.clear();
        take(exchange);
        next = advance(state, dt, world_.setup.newton.retries, report);
      }
      report.ok = next.has_value();
      report.articulations = progress_.done;
      if (report.ok) {
        ++next->step;
        next->time = next->step * dt;
        finish_step(world_, carriage_, state, *next, dt, report);
        report.woken += move_fronts(state, *next) + settle_clusters(state, *next) + let_tape_sleep(state, *next);
        state = std::move(*next);
      }
    }
    report.asleep = sleeping(state);
    collect(report);
    return report;
  }

  std::vector<Real> contact_force() const override {
    if (!search_) return std::vector<Real>(static_cast<std::size_t>(now_.x.size()), 0);
    return vertex_contact_force(world_, pairs_on_host(search_->candidates()), now_.x.download());
  }

 private:
  /// Makes everything that depends on the meshes.
  void take_world() {
    const Scene& scene = world_.setup.scene;
    const Assembly& assembly = world_.assembly;
    std::vector<Real> along;
    for (int v = 0; v < (assembly.strips.empty() ? 0 : assembly.strips[0].vertices); ++v)
      along.push_back(assembly.rest[static_cast<std::size_t>(v)].x());
    along_.upload(along);
    const auto tape_end = assembly.mass.begin() + assembly.strip_vertices;
    moving_mass_ = std::accumulate(assembly.mass.begin(), tape_end == assembly.mass.begin() ? assembly.mass.end() : tape_end, Real{0});
    apart_ = world_.surface.apart;
    if (world_.is_on(Barrier::name))
      search_.emplace(world_.surface, scene.dhat(), scene.contact.guard * scene.dhat(), scene.contact.everywhere);
    blades_.emplace(world_);
    std::vector<bool> on;
    for (const PlanLine& line : world_.plan) on.push_back(line.on);
    objective_.emplace(scene, world_.setup.effects, assembly, on);
    objective_->for_each([&]<class T>(std::string_view, Term<T>&) {
      if (Remembers<T>) fans_.emplace(world_.surface);
    });
  }
  /// Makes everything that depends on what carries the vertices, as it is in a state.
  void take_up(const State& state) {
    carriage_ = carry(world_, state);
    fronts_ = fronts(state);
    std::vector<int> body_block, body_centre;
    for (const BodyPart& b : world_.assembly.bodies) body_block.push_back(b.block), body_centre.push_back(b.centre);
    const int q_block = world_.assembly.first_strip_block - articulations_.q_blocks();
    coordinates_.emplace(carriage_.owner, carriage_.local, body_block, body_centre, q_block);
    mass_.upload(carriage_.mass);
    body_mass_.upload(carriage_.body_mass);
    SystemLayout layout;
    for (std::size_t s = 0; s < carriage_.strips.size(); ++s)
      if (carriage_.strips[s].blocks > 0)
        layout.strips.push_back({carriage_.strips[s].block, carriage_.strips[s].blocks, world_.assembly.strips[s].columns});
    for (int block : body_block)
      if (block >= 0) layout.body_blocks.push_back(block);
    linear_.set_layout(articulations_.any() ? articulations_.set_layout(layout, carriage_.blocks) : std::move(layout));
    if (search_) search_->set_carriage(surface_carriage(world_, state, carriage_));
    for (Buffer<Vec3>* blocks : {&direction_, &right_, &points_}) blocks->resize(carriage_.blocks);
    objective_->set_seats(seats(world_, state));
    objective_->set_carriage(carriage_.blocks, view(now_));
    std::vector<const EffectMemory*> asleep;
    for (const Cluster& cluster : state.clusters) asleep.push_back(cluster.asleep.get());
    if (state.sleepers) asleep.push_back(&state.sleepers->asleep);
    objective_->set_asleep(asleep);
  }
  /// Which members a state's clusters have and where they rest, and what tape sleeps.
  struct Fronts {
    std::vector<std::pair<std::shared_ptr<const std::vector<int>>, std::shared_ptr<const Rest>>> clusters;
    std::shared_ptr<const Sleepers> sleepers;
  };
  static Fronts fronts(const State& state) {
    Fronts out{{}, state.sleepers};
    for (const Cluster& c : state.clusters) out.clusters.emplace_back(c.distance, c.rest);
    return out;
  }
  static bool same(const Fronts& a, const Fronts& b) {
    return a.sleepers == b.sleepers && std::ranges::equal(a.clusters, b.clusters, [](const auto& p, const auto& q) {
             return p.second == q.second && (p.first == q.first || *p.first == *q.first);
           });
  }

  /// Takes up what is exchanged in a step.
  void take(const Exchange& exchange) {
    TAPE_CHECK(exchange.articulations.size() == world_.assembly.articulations.size());
    exchange_ = exchange;
    progress_ = {};
    for (const ArticulationStep& a : exchange.articulations) {
      const Eigen::VectorXd zero = Eigen::VectorXd::Zero(a.predicted.size());
      progress_.lead.push_back(zero);
      progress_.done.push_back({zero, zero, std::vector<LinkReport>(a.jacobian.size())});
    }
    if (!search_ || exchange.articulations.empty()) return;
    std::vector<char> apart = world_.surface.apart;
    for (const Index2& pair : exchange.pinching) {
      const std::size_t n = world_.surface.objects.size(), first = world_.assembly.strips.size();
      const std::size_t a = first + static_cast<std::size_t>(pair[0]), b = first + static_cast<std::size_t>(pair[1]);
      apart[a * n + b] = apart[b * n + a] = 0;
    }
    if (apart == apart_) return;
    search_->set_apart(apart);
    apart_ = std::move(apart);
  }
  /// Coordinates at the end of a part of the step if nothing exerted a force from now on.
  std::vector<Eigen::VectorXd> course(Real dt) const {
    std::vector<Eigen::VectorXd> target;
    for (std::size_t a = 0; a < exchange_.articulations.size(); ++a)
      target.push_back(exchange_.articulations[a].predicted * (dt / world_.setup.scene.time.dt) + dt * progress_.lead[a]);
    return target;
  }
  /// Adds a part of the step that ended at now_ to what is done.
  void add_progress(Real dt) {
    if (exchange_.articulations.empty()) return;
    const Real share = dt / world_.setup.scene.time.dt;
    const std::vector<Eigen::VectorXd> q = articulations_.coordinates(now_.q.download());
    for (std::size_t a = 0; a < q.size(); ++a) {
      progress_.lead[a] = (q[a] - share * exchange_.articulations[a].predicted) / dt;
      progress_.done[a].q += q[a];
    }
    objective_->for_each_force(view(now_), world_.assembly.first_strip_block, [&]<class T>(std::type_identity<T>, const auto& force) {
      for (std::size_t a = 0; a < q.size(); ++a) {
        ArticulationReport& done = progress_.done[a];
        const std::vector<int>& bodies = world_.assembly.articulations[a].links;
        for (std::size_t l = 0; l < bodies.size(); ++l) {
          const auto block = static_cast<std::size_t>(world_.assembly.bodies[static_cast<std::size_t>(bodies[l])].block);
          VecN<6> wrench;
          wrench << force[block], force[block + 1];
          Wrench& sum = of_effect<T>(done.links[l]);
          sum.force += share * wrench.head<3>(), sum.torque += share * wrench.tail<3>();
          done.force += share * exchange_.articulations[a].jacobian[l].transpose() * wrench;
        }
      }
    });
  }
  template <class T>
  static Wrench& of_effect(LinkReport& link) {
    if constexpr (Remembers<T>) return link.adhesion;
    if constexpr (std::is_same_v<T, Barrier>) return link.normal;
    if constexpr (std::is_same_v<T, Friction>) return link.friction;
    return link.hold;
  }

  void prescribe(const Drive& drive) {
    body_target_.upload(drive.body_target);
    grip_target_.upload(drive.grip_target);
    grip_stiffness_.upload(drive.grip_stiffness);
  }
  /// Brings the state to this side and finds what is prescribed for the end of the step.
  void begin(const State& state, Real dt) {
    const std::vector<Vec3> x = vertex_positions(world_, state);
    std::vector<Vec3> x_tilde = x;
    for (std::size_t v = 0; v < state.x.size(); ++v) x_tilde[v] = state.x[v] + dt * state.v[v];
    std::vector<Pose> pose;
    for (const BodyState& b : state.bodies) pose.push_back(b.pose);
    dt_ = dt;
    extent_ = 0;
    for (const Vec3& p : x) extent_ = std::fmax(extent_, p.cwiseAbs().maxCoeff());
    start_.x.upload(x);
    start_.body.upload(pose);
    start_.q.upload(std::vector<Vec3>(static_cast<std::size_t>(articulations_.q_blocks()), Vec3::Zero()));
    if (!exchange_.articulations.empty()) articulations_.begin(exchange_.articulations, course(dt), dt);
    x_tilde_.upload(x_tilde);
    prescribe(Drive::at(world_, state, state.time + dt, dt));
    now_.copy_from(start_);
    trial_.copy_from(start_);
  }

  StateView view(const Configuration& at) const {
    return {.dt = dt_,
            .overshot = overshot_,
            .x = at.x.span(),
            .x_start = start_.x.span(),
            .x_tilde = x_tilde_.span(),
            .owner = coordinates_->owner(),
            .mass = mass_.span(),
            .body_mass = body_mass_.span(),
            .body = at.body.span(),
            .body_target = body_target_.span(),
            .grip_target = grip_target_.span(),
            .grip_stiffness = grip_stiffness_.span(),
            .mu = mu_.span(),
            .adhesion = adhesion_.span(),
            .fans = {}};
  }

  /// One step of dt; on failure two of dt/2, and so on `retries` times.  @return the state at its end; nothing if all fails
  std::optional<State> advance(const State& from, Real dt, int retries, StepReport& report) {
    std::optional<State> end = from;
    State& next = *end;
    const Progress before = progress_;
    close_grips(world_, next);
    begin(next, dt);
    if (!same(fronts(next), fronts_)) take_up(next);
    if (solve_step(next, report)) {
      read_back(next, dt);
      add_progress(dt);
      renew_memory(next, dt, report);
      return end;
    }
    if (retries == 0) return {};
    ++report.substeps;
    end = advance(from, dt / 2, retries - 1, report);
    if (end) end = advance(*end, dt / 2, retries - 1, report);
    if (end) {
      report.failure.clear();
    } else {
      progress_ = before;
    }
    return end;
  }

  /// Lets clusters lose members at the end of a step. @return [J] stored in what wakes
  Real move_fronts(const State& before, State& after) {
    const Stopwatch watch(front_ms_);
    return advance_fronts(world_, carriage_, before, after) ? take_up_change(after) : 0;
  }
  /// Wakes clusters that are off their rest, and lets those rest on their hubs that hardly move there, at once where they are now. @return
  /// [J] that this adds to what is stored
  Real settle_clusters(const State& before, State& after) {
    const Stopwatch watch(front_ms_);
    const auto change = [&](const auto& changes) {
      bool changed = false;
      for (std::size_t k = 0; k < after.clusters.size(); ++k) changed |= changes(k);
      return changed ? take_up_change(after) : 0;
    };
    const Real woken = change([&](std::size_t k) {
      if (!after.clusters[k].rest || off_its_rest(world_, carriage_, after, k) <= 1) return false;
      wake_up(k, after);
      return true;
    });
    return woken + change([&](std::size_t k) {
             std::optional<Rest> rest = after.clusters[k].rest ? std::nullopt : find_rest(before, after, k);
             if (rest) put_to_rest(world_, k, std::move(*rest), after);
             return rest.has_value();
           });
  }
  /// Lets tape sleep that lies still, and wakes what is disturbed. @return as settle_clusters
  Real let_tape_sleep(const State& before, State& after) {
    if (!search_ || !is_to_look_at_tape(world_, after)) return 0;
    const Stopwatch watch(front_ms_);
    std::vector<ContactPair> near = pairs_on_host(search_->candidates());
    const std::vector<ContactPair> bonded = pairs_on_host(search_->bonded());
    near.insert(near.end(), bonded.begin(), bonded.end());
    return settle_tape(world_, before, near, after) ? take_up_change(after) : 0;
  }
  /// Wakes all that sleeps at the start of a step. @return as settle_clusters
  Real wake_all(State& state) {
    const Stopwatch watch(front_ms_);
    begin(state, dt_);
    recall(state.memory);
    for (std::size_t k = 0; k < state.clusters.size(); ++k)
      if (state.clusters[k].rest) wake_up(k, state);
    wake_tape(world_, state);
    return take_up_change(state);
  }
  /// After clusters have changed in a state that is at now_. @return [J] by which that changes what is stored
  Real take_up_change(const State& state) {
    const Real searched = search_ms_, known = stored_energy() + std::exchange(regained_, 0);
    begin(state, dt_);
    prescribe(Drive::at(world_, state, state.time, 0));
    take_up(state);
    recall(state.memory);
    front_ms_ -= search_ms_ - searched;
    return stored_energy() - known;
  }
  /// Where cluster k rests from now on, if it does.
  std::optional<Rest> find_rest(const State& before, const State& after, std::size_t k) {
    constexpr Real kSlack = 0.5;  // of what is remembered, that its reach may use up
    const Real most = world_.setup.scene.cluster.seat * world_.setup.scene.dhat();
    if (!world_.is_on(Seat::name) || !stays_on_hub(world_, before, after, k, most)) return {};
    std::vector<ContactPair> pairs = pairs_on_host(search_->candidates());
    const std::vector<ContactPair> bonded = pairs_on_host(search_->bonded());
    pairs.insert(pairs.end(), bonded.begin(), bonded.end());
    std::optional<Rest> rest = place_of_rest(world_, after, k, pairs);
    if (!rest) return {};
    const Seat::Element seat = seat_of(world_, after, k, *rest);
    const StateView s = view(now_);
    rest->reach = std::min(rest->reach, kSlack * objective_->slack_between(s, seat.hub, seat.cluster));
    if (!(rest->reach > 0) || !stays_on_hub(world_, before, after, k, rest->reach)) return {};
    const Pose& hub = after.bodies[static_cast<std::size_t>(seat.hub)].pose;
    rest->form = objective_->between(s, seat.hub, seat.cluster, hub.position).seen_from(hub.rotation);
    return rest;
  }
  /// Whether a step must be taken with all awake: clusters are farther off their rest than its form holds, or it failed.
  bool is_to_wake(const State& start, const std::optional<State>& end) const {
    constexpr Real kFar = 2;  // reaches; not yet through a gap
    if (start.sleepers && !end) return true;
    for (std::size_t k = 0; k < start.clusters.size(); ++k)
      if (start.clusters[k].rest && (!end || !(off_its_rest(world_, carriage_, *end, k) <= kFar))) return true;
    return false;
  }
  /// Ends the rest of cluster k in a state that is at now_.
  void wake_up(std::size_t k, State& state) {
    RestingPairs resting = resting_pairs(world_, carriage_, state, k);
    const Buffer<Vec3> x(resting.x);
    StateView to = view(now_);
    to.dt = 0, to.x_start = x.span();
    StateView from = to;
    from.x = x.span();
    wake(world_, carriage_, k, std::move(resting.of_members), objective_->renewed(resting.with_hub, from, to, search_->surface()), state);
  }
  Real stored_energy() {
    Real sum = 0;
    objective_->for_each([&]<class T>(std::string_view, Term<T>& term) {
      if (!requires { T::incremental; }) sum += objective::energy_of(term, view(now_)).sum;
    });
    return sum;
  }

  void read_back(State& state, Real dt) const {
    const std::vector<Vec3> x = now_.x.download();
    for (std::size_t v = 0; v < state.x.size(); ++v) {
      state.v[v] = (x[v] - state.x[v]) / dt;
      state.x[v] = x[v];
    }
    const std::vector<Pose> pose = now_.body.download(), target = body_target_.download();
    for (std::size_t b = 0; b < state.bodies.size(); ++b)
      if (world_.assembly.bodies[b].motion != Motion::fixed) finish_body(carriage_.body_mass[b], pose[b], target[b], dt, state.bodies[b]);
    state.time += dt;
  }

  /// Makes the candidates hold along a direction from now_.
  void update_candidates(Span<const Vec3> direction) {
    if (!search_) return;
    const Stopwatch watch(search_ms_);
    const Real margin = world_.setup.scene.contact.margin * world_.setup.scene.dhat();
    if (search_->update(coordinates_->paths(now_, direction), margin)) ++searches_;
    objective_->set_candidates(search_->candidates());
  }

  /// Brings the memory to the end of a step at now_, and books what that does to the energy.
  void renew_memory(State& state, Real dt, StepReport& report) {
    if (!fans_) return;
    report.adhesion = adhesion();
    StateView s = view(now_);
    const Real adhesive = objective_->adhesive_energy(s);
    state.memory = remember(dt);
    s.x_start = s.x;
    objective_->recall(state.memory, s, search_->surface());
    const std::vector<VertexTriangle> replaced = pairs_out_of_contact(state.memory);
    regained_ = contact_energy(s, without(replaced_, replaced)) - contact_energy(s, without(replaced, replaced_));
    report.adhesion_work += objective_->adhesive_energy(s) - adhesive + regained_ + let_go_energy_;
  }
  Real contact_energy(const StateView& s, const std::vector<VertexTriangle>& pairs) {
    return objective_->contact_energy(s, pairs, search_->surface());
  }
  static std::vector<VertexTriangle> without(const std::vector<VertexTriangle>& pairs, const std::vector<VertexTriangle>& others) {
    std::vector<VertexTriangle> left;
    std::ranges::set_difference(pairs, others, std::back_inserter(left), {}, &VertexTriangle::key, &VertexTriangle::key);
    return left;
  }
  std::vector<AdhesionReport> adhesion() {
    std::vector<AdhesionReport> out;
    const StateView s = view(now_);
    for (const AdhesivePair& pair : world_.setup.scene.adhesives) {
      AdhesionReport sum;
      objective_->for_each([&]<class T>(std::string_view, Term<T>& term) {
        if constexpr (Remembers<T>) {
          const int n = world_.surface.materials;
          const stepping::Adheres<T> kernel{term.view, s, pair.a * n + pair.b, pair.b * n + pair.a, along_.span()};
          sum = stepping::AddAdhesion{}(sum, reduce(term.view.elements.size, AdhesionReport{}, kernel, stepping::AddAdhesion{}));
        }
      });
      out.push_back(sum);
    }
    return out;
  }
  /// What adheres at now_, `dt` [s] after the start of the step.
  EffectMemory remember(Real dt) {
    if (!fans_) return {};
    StateView s = view(now_);
    s.dt = dt;
    s.fans = fans_->view();
    return objective_->remember(s, search_->samples(coordinates_->paths(now_, direction_.span())));
  }
  /// Candidates and elements of a step that starts at now_ with this memory, before it has a direction: after a front has moved, the last
  /// one's blocks are other coordinates.
  void recall(const EffectMemory& memory) {
    search_without(pairs_out_of_contact(memory));
    if (fans_) objective_->recall(memory, view(now_), search_->surface());
  }
  /// Candidates at now_ where these pairs have left contact.
  void search_without(std::vector<VertexTriangle> replaced) {
    parallel_for(direction_.size(), stepping::Fill{direction_.span()});
    if (!search_) return;
    replaced_ = std::move(replaced);
    search_->set_bonded(replaced_);  // makes the search start anew: its past must not change the order of sums
    update_candidates(direction_.span());
  }
  /// Lets go of what cannot hold what it bears at now_, so that no step ends with it: else a roll could give one row of bonds a step.
  /// @return whether there was any
  bool let_go() {
    if (!fans_) return false;
    const std::optional<EffectMemory> left = objective_->let_go(view(now_), search_->surface());
    if (!left) return false;
    search_without(pairs_out_of_contact(*left));
    const Real before = std::exchange(energy_, energy(now_)).sum;
    let_go_energy_ += energy_.sum - before;
    return true;
  }

  /// From now_ == start_, the start of a step at `state`, to its end.
  bool solve_step(const State& state, StepReport& report) {
    recall(state.memory);
    if (state.time == 0) recall(remember(0));  // at the start of a run pairs in the contact band are as engaged as new ones
    objective_->begin_step(view(now_));
    {
      const Stopwatch watch(line_search_ms_);
      energy_ = energy(now_);
    }
    if (!std::isfinite(energy_.sum)) return fail(report, "not finite at the start: " + objective_->first_non_finite(view(now_)));
    if (carriage_.blocks == 0) return true;  // all there is rests on what does not move
    let_go_energy_ = 0;
    setting_out_ = articulations_.any();
    do {
      if (!newton(report)) return false;
    } while (let_go());
    return true;
  }

  /// Newton's method from now_ to the minimum.
  bool newton(StepReport& report) {
    constexpr Real kOpening = 0.58;  // share of the slope by which a third or fourth power falls: 7/12, 0.602
    const NewtonParams& params = world_.setup.newton;
    Real previous = 0, last_update = 0, left = 0;
    const auto converged_to = [&] {  // of the substeps that count, the worst
      report.last_update = std::fmax(report.last_update, last_update);
      report.stop_error_estimate = std::fmax(report.stop_error_estimate, left);
      return true;
    };
    overshot_ = false;
    for (int k = 0; k < params.max_newton; ++k) {
      ++report.newton;
      if (!find_direction(report)) return false;
      const Real slope = -reduce(direction_.size(), 0.0, Dot{right_.span(), direction_.span()}, Plus{});
      coordinates_->move(now_, direction_.span(), 1, trial_);
      const Real moved = reduce(now_.x.size(), 0.0, stepping::Travel{now_.x.span(), trial_.x.span()}, Larger{});
      if (!std::isfinite(moved) || !std::isfinite(slope))
        return fail(report, "the Newton direction is not finite" + in_brackets(objective_->first_non_finite_derivative()));
      if (moved <= kPositionRoundOff * extent_) return converged_to();  // no update is left that positions could hold
      const bool contracts = moved < previous;                          // else the ratio is no rate; as_foreseen() judges this update
      const Real rho = contracts ? std::fmin(moved / previous, 0.99) : 0;
      last_update = moved;
      left = contracts ? moved * rho / (1 - rho) : moved;
      // An update that friction's secant shortened says nothing of what is left.
      if (setting_out_) {
        set_out(slope, k, report);
        continue;
      }
      const bool converged = !overshot_ && stops(moved, slope, rho);
      const Real last = std::exchange(previous, overshot_ ? 0 : moved);
      bool at_round_off = false;
      const Real before = energy_.sum, round_off = kEnergyRoundOff * energy_.scale;
      const int halvings = report.halvings;
      if (!line_search(slope, report, at_round_off)) return false;
      overshot_ = report.halvings > halvings;
      const Real share = (before - energy_.sum) / -slope;
      const bool measurable = -slope > 1e3 * round_off;
      const bool foreseen = !measurable || as_foreseen(share, moved, last);
      if (measurable && foreseen && mode_ == HessianMode::exact) left = 3 * kAsForeseen * moved;
      if (at_round_off || (converged && foreseen && moved <= objective_->accuracy_to_judge(view(now_)))) return converged_to();
      if (!foreseen && !overshot_ && limit_ == 1 && share > kOpening && go_on()) previous = 0;
    }
    return fail(report, "Newton's method took " + std::to_string(params.max_newton) + " iterations (solver.max_newton)");
  }

  EnergySum energy(const Configuration& at) {
    const EnergySum e = objective_->energy(view(at));
    return articulations_.any() ? e + articulations_.energy(at.q.span()) : e;
  }
  LinearReport solve() {
    const BlockMatrix& matrix = objective_->matrix();
    if (!articulations_.any()) return linear_.solve(matrix, points_.span(), right_.span(), direction_.span());
    return articulations_.solve(linear_, matrix, points_.span(), now_.q.span(), !setting_out_, right_.span(), direction_.span());
  }

  /// One of the first updates of a step with links, as if their drives had no limits: where links stand at the start they lie so far behind
  /// what is foreseen that each drive seems to be at its limit. Ends with the first update that goes its whole way.
  void set_out(Real slope, int updates, StepReport& report) {
    constexpr int kMost = 10;
    bool at_round_off = false;
    const int halvings = report.halvings;
    const bool lower = line_search(slope, report, at_round_off);
    if (!lower) report.failure.clear();
    setting_out_ = lower && !at_round_off && (limit_ < 1 || report.halvings > halvings) && updates + 1 < kMost;
  }

  bool stops(Real moved, Real slope, Real rho) const {
    const NewtonParams& params = world_.setup.newton;
    if (params.stop == StopRule::velocity || moving_mass_ == 0) return moved < params.velocity_tol * dt_;
    const Real lost = mode_ == HessianMode::projected ? (1 - rho) * (1 - rho) : 1;
    return -slope / lost <= moving_mass_ * params.velocity_tol * params.velocity_tol;
  }

  /// Whether the objective was along the last update what Newton's parabola says: then the energy fell by the share 1/2 of the slope. On
  /// its way out of the barrier, which ends like a fourth power, an update is a third of the way to the edge, however light the push is
  /// by then: a small update of share 0.6 or more, and gravity still to come. With a curvature H and a third derivative T along an update d
  /// the share is 1/2 - T d/(6 H), and T d^2/(2 H) is left: up to 3 kAsForeseen d. A projected Hessian is too stiff and converges by a
  /// rate, which makes the share (1 + rate)/2: there the updates must shrink by that rate, and what is left of them must be small.
  bool as_foreseen(Real share, Real moved, Real previous) const {
    if (std::fabs(share - 0.5) <= kAsForeseen) return true;
    const Real rate = 2 * share - 1;
    return mode_ == HessianMode::projected && rate < 1 && moved <= (rate + 0.1) * previous &&
           moved * rate / (1 - rate) <= world_.setup.newton.velocity_tol * dt_;
  }

  /// direction_ = -H^-1 g, right_ = -g.
  bool find_direction(StepReport& report) {
    mode_ = setting_out_ ? HessianMode::projected : world_.setup.newton.hessian;
    for (;;) {
      {
        const Stopwatch watch(assembly_ms_);
        objective_->linearize(view(now_), mode_);
        parallel_for(right_.size(), stepping::Negate{objective_->gradient(), right_.span()});
      }
      const Stopwatch watch(linear_ms_);
      coordinates_->block_points(now_, points_.span());
      const LinearReport solved = solve();
      report.linear_solver = solved.solver;
      report.linear_iterations += solved.iterations;
      if (!solved.negative_curvature) {
        report.linear_failures += solved.converged ? 0 : 1;
        return true;
      }
      if (mode_ == HessianMode::projected)
        return fail(report, "the projected Hessian is not positive definite" + in_brackets(objective_->first_non_finite_derivative()));
      mode_ = HessianMode::projected;
      ++report.hessian_fallbacks;
    }
  }

  /// To what the search can look at: `max_move`, and less where that meets too many pairs.
  void shorten_direction() {
    const ContactParams& contact = world_.setup.scene.contact;
    const Real dhat = world_.setup.scene.dhat();
    const auto paths = [&] { return coordinates_->paths(now_, direction_.span()); };
    const auto scale = [&](Real factor) {
      parallel_for(direction_.size(), stepping::Scale{direction_.span(), factor});
      limit_ *= factor;
    };
    Real way = reduce(now_.x.size(), 0.0, stepping::Way{paths()}, Larger{});
    if (way > contact.max_move) scale(contact.max_move / std::exchange(way, contact.max_move));
    constexpr Real kFar = 30;  // [dhat] what moves less meets a few layers
    constexpr int kMost = 40;  // pairs for each vertex and edge
    const Stopwatch watch(search_ms_);
    for (; way > kFar * dhat && !search_->within(paths(), contact.margin * dhat, kMost); way /= 4) scale(0.25);
    if (limit_ < 1) ++shortened_;
  }

  /// Shortens direction_ so that nothing crosses on the way: by CCD for each connected component.
  void limit_direction() {
    limit_ = 1;
    if (!search_) return;
    shorten_direction();
    update_candidates(direction_.span());
    if (search_->candidates().size + search_->bonded().size == 0) return;
    const Stopwatch watch(ccd_ms_);
    const std::vector<Real> limits =
        search_->limit_steps(coordinates_->paths(now_, direction_.span()), {.eta = world_.setup.scene.contact.ccd_gap});
    limit_ *= *std::ranges::min_element(limits);
    search_->scale(direction_.span());
  }

  /// The minimum of a fourth power, as of the barrier where a contact opens, is three of Newton's updates away: makes the two that are
  /// left, or one more, if that is lower still.  @return whether it was
  bool go_on() {
    parallel_for(direction_.size(), stepping::Scale{direction_.span(), 2});
    limit_direction();
    const Stopwatch watch(line_search_ms_);
    for (Real step : {1.0, 0.5}) {
      coordinates_->move(now_, direction_.span(), step, trial_);
      const EnergySum after = energy(trial_);
      if (!(after.sum < energy_.sum)) continue;
      std::swap(now_, trial_);
      energy_ = after;
      return true;
    }
    return false;
  }

  /// Moves now_ along direction_, as far as nothing crosses; half of that, a quarter ... until the energy falls.
  bool line_search(Real slope, StepReport& report, bool& at_round_off) {
    limit_direction();
    const Stopwatch watch(line_search_ms_);
    const Real round_off = kEnergyRoundOff * energy_.scale;
    at_round_off = -slope <= round_off;
    Real step = 1;
    for (int h = 0; h <= world_.setup.newton.max_line_search; ++h, step /= 2) {
      coordinates_->move(now_, direction_.span(), step, trial_);
      const EnergySum after = energy(trial_);
      if (after.sum < energy_.sum || (-slope * step <= round_off && after.sum <= energy_.sum + round_off)) {
        std::swap(now_, trial_);
        energy_ = after;
        return true;
      }
      ++report.halvings;
    }
    return fail(report, "the line search found no lower energy" + in_brackets(objective_->first_non_finite(view(trial_))));
  }

  static std::string in_brackets(const std::string& not_finite) { return not_finite.empty() ? "" : " (not finite: " + not_finite + ")"; }
  static bool fail(StepReport& report, const std::string& why) {
    report.failure = why;
    return false;
  }

  void reset_times() {
    search_ms_ = assembly_ms_ = linear_ms_ = ccd_ms_ = line_search_ms_ = front_ms_ = 0;
    searches_ = shortened_ = 0;
    regained_ = 0;
    capped_before_ = search_ ? search_->report().capped : 0;
    objective_->for_each([](std::string_view, auto& term) { term.ms = 0; });
  }

  /// What only this side knows of the step that ended at now_.
  void collect(StepReport& report) {
    const StateView s = view(now_);
    report.searches = searches_;
    report.shortened = shortened_;
    report.ccd_capped = search_ ? static_cast<int>(search_->report().capped - capped_before_) : 0;
    objective_->for_each([&]<class T>(std::string_view name, Term<T>& term) {
      EffectReport line{.name = std::string(name), .ms = term.ms, .energy = 0, .elements = term.count};
      const bool stored = !requires { T::incremental; };
      if (stored) line.energy = objective::energy_of(term, s).sum;
      if constexpr (requires { T::contact_pairs; }) {
        const Span<const ContactPair> pairs = search_->candidates();
        line.energy += regained_;
        report.candidates = pairs.size;
        report.active_pairs = term.count;
        report.min_gap = std::fmin(smallest_gap(pairs, s.x).gap, smallest_gap(search_->bonded(), s.x).gap);
      }
      if constexpr (requires { term.view.strain(s, 0); })
        report.max_strain = reduce(term.count, 0.0, stepping::Strain<T>{term.view, s, {term.active.span()}}, Larger{});
      report.effects.push_back(line);
    });
    if (search_) report.stages = {{"broad_phase", search_ms_}, {"ccd", ccd_ms_}};
    if (search_ && blades_->any()) {
      StageReport cutting{"cutting", 0};
      {
        const Stopwatch watch(cutting.ms);
        report.blades = blades_->pressures(pairs_on_host(search_->candidates()), now_.x.download());
      }
      report.stages.push_back(cutting);
    }
    report.stages.insert(report.stages.end(),
                         {{"assembly", assembly_ms_}, {"linear_solver", linear_ms_}, {"line_search", line_search_ms_}});
    if (carries_tape()) report.stages.push_back({"front", front_ms_});
  }

  /// Whether tape may be carried by something.
  bool carries_tape() const { return world_.clusters() > 0 || world_.setup.scene.sleep.after > 0; }

  static std::vector<ContactPair> pairs_on_host(Span<const ContactPair> pairs) {
    Buffer<ContactPair> copy;
    copy.resize(pairs.size);
    parallel_for(pairs.size, stepping::Copy{pairs, copy.span()});
    return copy.download();
  }

  /// Of the articulations in the parts of a step that have gone well.
  struct Progress {
    std::vector<Eigen::VectorXd> lead;     // [articulations][m] rate by which they are ahead of what was predicted
    std::vector<ArticulationReport> done;  // [articulations]
  };

  const World& world_;
  Carriage carriage_;
  Fronts fronts_;  // that the carriage is of
  std::optional<Coordinates> coordinates_;
  std::optional<ContactSearch> search_;  // where things can touch
  std::optional<SurfaceFans> fans_;      // where something adheres
  std::optional<BladeWatch> blades_;
  std::vector<VertexTriangle> replaced_;  // pairs that are out of contact in this step
  Real let_go_energy_ = 0;                // [J] change of the energy by what was let go within the step
  Real regained_ = 0;                     // [J] energy of contact that the end of the step let back, beyond that of the candidates
  Articulations articulations_;
  Exchange exchange_;
  Progress progress_;
  std::vector<char> apart_;  // that the search knows
  LinearSolver linear_;
  std::optional<Objective> objective_;
  Configuration start_, now_, trial_;
  Buffer<Vec3> x_tilde_, grip_target_, direction_, right_, points_;
  Buffer<Pose> body_target_;
  Buffer<Real> grip_stiffness_, mu_, along_, mass_;
  Buffer<BodyMass> body_mass_;
  Buffer<Adhesion> adhesion_;
  static constexpr Real kPositionRoundOff = 1e-15, kEnergyRoundOff = 4e-15;
  static constexpr Real kAsForeseen = 0.05;     // by which the share of the slope that E falls by may be off
  HessianMode mode_ = HessianMode::exact;       // of the last direction
  EnergySum energy_;                            // at now_
  Real dt_ = 0, moving_mass_ = 0, extent_ = 0;  // moving_mass_: of the tape, if there is any; extent_: largest coordinate [m]
  bool overshot_ = false;
  Real limit_ = 1;            // share of the last direction that its limits let go, the least of all components
  bool setting_out_ = false;  // the first updates of a step with links
  Real search_ms_ = 0, assembly_ms_ = 0, linear_ms_ = 0, ccd_ms_ = 0, line_search_ms_ = 0, front_ms_ = 0;
  int searches_ = 0, shortened_ = 0;
  long long capped_before_ = 0;
};
}  // namespace tape::TAPE_SIDE
