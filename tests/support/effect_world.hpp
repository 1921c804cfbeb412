#pragma once
#include <algorithm>
#include <random>
#include <vector>

#include "tape/effects/effects.inl"
#include "tape/math/rotation.hpp"

namespace tape::test {
/// A little world with something for every effect to act on, in random but legal configurations: an irregular strip, a dynamic
/// and a driven body, grips, and contact pairs of all features within reach of each other.
class EffectWorld {
 public:
  explicit EffectWorld(unsigned seed);
  Scene scene;
  Assembly assembly;
  std::vector<ContactPair> pairs;
  std::vector<SamplePair> samples;
  std::vector<Seat::Element> seats;
  std::vector<Vec3> x, x_start, x_tilde;
  std::vector<Pose> body, body_target;
  std::vector<BodyMass> body_mass;
  std::vector<Vec3> grip_target;
  std::vector<Real> grip_stiffness, mu;
  std::vector<Adhesion> adhesion;
  std::vector<int> no_fan;  ///< all faces adhere to all
  Real dt = 0.01;

  StateView view() const;
  /// The same configuration as seen by what starts its step here.
  StateView start_view() const;
  Real random(Real low, Real high) { return std::uniform_real_distribution<Real>(low, high)(generator_); }
  Vec3 random_vector(Real size) { return {random(-size, size), random(-size, size), random(-size, size)}; }
  /// What an effect that remembers may remember.
  template <class T>
  const std::vector<typename T::Pair>& pairs_of() const {
    if constexpr (Samples<T>) {
      return samples;
    } else {
      return pairs;
    }
  }
  /// Moves everything as one rigid thing.
  void move(const Pose& by);

 private:
  std::vector<int> add_vertices(const std::vector<Vec3>& positions);
  void add_strip();
  void add_bodies();
  void add_grips();
  void add_axles();
  void add_pairs();
  void add_samples();
  void add_seat();
  void disturb();
  std::mt19937_64 generator_;
};

/// An effect with elements that live in this object.
template <class T>
struct Built {
  std::vector<typename T::Element> elements;
  T term;
  explicit Built(const EffectWorld& world, const typename T::Params& params = {})
      : term(T::build(world.scene, world.assembly, params, elements)) {
    if constexpr (requires { T::contact_pairs; }) elements.assign(world.pairs.begin(), world.pairs.end());
    if constexpr (requires(typename T::Element & e) { term.lag(world.pairs[0], world.view(), e); }) {
      const StateView start = world.start_view();
      typename T::Element e;
      for (const ContactPair& pair : world.pairs)
        if (term.lag(pair, start, e)) elements.push_back(e);
    }
    if constexpr (Remembers<T>) {
      const StateView start = world.start_view();
      typename T::Memory m;
      for (const auto& pair : world.pairs_of<T>())
        if (term.begin(pair, start, m)) elements.push_back(term.recall(m, pair, start));
    }
    if constexpr (std::is_same_v<T, Seat>) elements = world.seats;
    term.elements = {elements.data(), static_cast<int>(elements.size())};
  }
  Built(const Built&) = delete;
  Built& operator=(const Built&) = delete;
  int count() const { return static_cast<int>(elements.size()); }
};

template <class T>
constexpr bool acts_on_blocks = requires {
  T::on_blocks;
};

/// Element i as a function of what its stencil names, each id once: 3 numbers per vertex (moves in m) or per block (m, rad).
template <class T>
class Element {
 public:
  Element(const EffectWorld& world, const T& term, int i) : world_(world), term_(term), i_(i) {
    const auto stencil = term.stencil(i);
    for (int id : stencil.id)
      if (std::find(ids_.begin(), ids_.end(), id) == ids_.end()) ids_.push_back(id);
    for (int id : stencil.id) place_.push_back(static_cast<int>(std::find(ids_.begin(), ids_.end(), id) - ids_.begin()));
  }
  Eigen::VectorXd rest() const { return Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(ids_.size())); }
  const std::vector<int>& ids() const { return ids_; }
  Real energy(const Eigen::VectorXd& q) const { return term_.energy(moved(q).view(), i_); }
  Eigen::VectorXd gradient(const Eigen::VectorXd& q) const {
    const auto g = term_.gradient(moved(q).view(), i_);
    Eigen::VectorXd sum = rest();
    for (std::size_t k = 0; k < place_.size(); ++k)
      sum.segment<3>(3 * place_[k]) += g.template segment<3>(3 * static_cast<Eigen::Index>(k));
    return sum;
  }
  Eigen::MatrixXd hessian(HessianMode mode) const {
    const auto h = term_.hessian(world_.view(), i_, mode);
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(rest().size(), rest().size());
    for (std::size_t k = 0; k < place_.size(); ++k)
      for (std::size_t l = 0; l < place_.size(); ++l)
        sum.block<3, 3>(3 * place_[k], 3 * place_[l]) +=
            h.template block<3, 3>(3 * static_cast<Eigen::Index>(k), 3 * static_cast<Eigen::Index>(l));
    return sum;
  }

 private:
  EffectWorld moved(const Eigen::VectorXd& q) const {
    EffectWorld w = world_;
    for (std::size_t k = 0; k < ids_.size(); ++k) {
      const Vec3 dq = q.segment<3>(3 * static_cast<Eigen::Index>(k));
      if constexpr (acts_on_blocks<T>) {
        for (std::size_t b = 0; b < w.body.size(); ++b) {
          if (w.assembly.bodies[b].block == ids_[k]) w.body[b].position += dq;
          if (w.assembly.bodies[b].block + 1 == ids_[k]) w.body[b].rotation = rotation_exp(dq) * w.body[b].rotation;
        }
      } else {
        w.x[static_cast<std::size_t>(ids_[k])] += dq;
      }
    }
    return w;
  }
  const EffectWorld& world_;
  const T& term_;
  int i_;
  std::vector<int> ids_;
  std::vector<int> place_;  // of each stencil slot in ids_
};
}  // namespace tape::test
