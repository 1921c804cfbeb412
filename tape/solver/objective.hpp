#pragma once
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "tape/bodies/relocation.hpp"
#include "tape/contact/kernels.inl"
#include "tape/core/side.hpp"
#include "tape/core/stopwatch.hpp"
#include "tape/effects/effects.hpp"
#include "tape/solver/block_matrix.hpp"
#include "tape/solver/energy_sum.hpp"
#include "tape/solver/vector_gather.hpp"

namespace tape {
template <class T>
inline constexpr bool is_contact = requires(const T& t, const ContactPair& p, const StateView& s, typename T::Element& e) {
  t.lag(p, s, e);
}
|| requires { T::contact_pairs; }
|| Remembers<T>;
template <class T>
inline constexpr bool sleeps = requires {
  T::sleeps;
};
template <class T>
inline constexpr bool on_blocks = requires {
  T::on_blocks;
};
}  // namespace tape

namespace tape::TAPE_SIDE {
/// Where the elements of one effect write: counts before, sizes after the scan.
struct SlotOffsets {
  Buffer<int> gradient, hessian;  // [count + 1]
};

/// Memory of an effect on this side.
template <class T>
struct TermMemory {};
template <Remembers T>
struct TermMemory<T> {
  Buffer<typename T::Memory> memory;
  Buffer<char> asleep;  // [samples] 1: what it sticks to is remembered elsewhere; empty: of none
};

/// One effect as the solver holds it.
template <class T>
struct Term : TermMemory<T> {
  bool on = false;
  T view;
  Buffer<typename T::Element> elements;
  Buffer<int> active;  // ids of the elements that contribute; contact effects only
  int count = 0;       // elements that contribute
  SlotOffsets offsets;
  int gradient_base = 0, hessian_base = 0, gradient_slots = 0;
  Real ms = 0;
};

/// Gradient and Hessian slots of a group of effects: `fixed` ones keep their pattern for a run, contact ones follow the pairs.
struct SlotGroupBuffers {
  Buffer<std::uint64_t> rows, keys;
  Buffer<Vec3> gradient;
  Buffer<Mat3> hessian;
  VectorGather gather;
};

/// The incremental potential: all effects that are on.
class Objective {
 public:
  /// @param on  by effect, in the order of the list
  Objective(const Scene& scene, const EffectParams& effects, const Assembly& assembly, const std::vector<bool>& on);
  /// Finds which elements are awake, with their blocks. Needed first, and when something else carries a vertex.
  void set_carriage(int blocks, const StateView& s);
  /// Pairs of the contact search, for effects that work on them.
  void set_candidates(Span<const ContactPair> candidates);
  /// Fixes what lags for a step, at s.x == s.x_start.
  void begin_step(const StateView& s);
  /// What sleeps, so that `remember` takes none of its samples for one that sticks to nothing.
  void set_asleep(const std::vector<const EffectMemory*>& memories);
  /// Makes the elements of what is remembered, at s.x == s.x_start.
  void recall(const EffectMemory& memory, const StateView& s, const detail::SurfaceView& surface);
  /// What is remembered of a step that ended at s.
  EffectMemory remember(const StateView& s, const detail::SampleQuery& samples);
  /// Of what cannot hold what it bears at s, lets go, within the step, what bears more than half as much as the one that bears most: the
  /// others may bear less then.  @return what effects remember that can let go; nothing if none did
  std::optional<EffectMemory> let_go(const StateView& s, const detail::SurfaceView& surface);
  /// [m] to which positions must be solved before `let_go` may judge s; infinite if nothing is near a threshold.
  Real accuracy_to_judge(const StateView& s);
  /// Pairs that are remembered, recalled where `from` is and renewed where `to` is; of both x_start is x of `from`.
  EffectMemory renewed(const EffectMemory& memory, const StateView& from, const StateView& to, const detail::SurfaceView& surface);
  /// Energy that is stored in the pairs between two bodies as one of them moves, by its displacement at a point [m] and its rotation, in
  /// the world's axes.
  PlaceForm between(const StateView& s, int standing, int moving, const Vec3& about);
  /// [m] least slack of what is remembered between two bodies.
  Real slack_between(const StateView& s, int standing, int moving);
  /// What holds clusters where they rest. To be followed by set_carriage().
  void set_seats(const std::vector<Seat::Element>& seats);
  /// Energy [J] of what adheres.
  Real adhesive_energy(const StateView& s);
  /// Energy [J] of contact of these pairs, whether they are candidates or not.
  Real contact_energy(const StateView& s, const std::vector<VertexTriangle>& pairs, const detail::SurfaceView& surface);
  EnergySum energy(const StateView& s);
  /// Gradient and matrix at s.
  void linearize(const StateView& s, HessianMode mode);
  Span<const Vec3> gradient() const { return gradient_.span(); }
  const BlockMatrix& matrix() const { return matrix_; }
  /// Calls f(std::type_identity<effect>, forces) with what each effect exerts at s on the first `blocks` of unknowns [N; N m for
  /// rotations]. Overwrites the derivatives that linearize() found.
  template <class F>
  void for_each_force(const StateView& s, int blocks, const F& f);
  /// "effect 'name', element i": the first whose energy is not finite; empty if all are.
  std::string first_non_finite(const StateView& s);
  /// The same of the gradients and Hessians that linearize() found.
  std::string first_non_finite_derivative();
  /// Calls f(name, term) for each effect that is on.
  template <class F>
  void for_each(const F& f) {
    std::apply([&](auto&... term) { (visit(f, term), ...); }, terms_);
  }

 private:
  template <class... T>
  static std::tuple<Term<T>...> terms_of(std::tuple<T...>*);
  using Terms = decltype(terms_of(static_cast<Effects*>(nullptr)));
  template <class F, class T>
  void visit(const F& f, Term<T>& term) {
    if (term.on) f(T::name, term);
  }
  void set_pattern(const StateView& s, bool contact);
  void fill(const StateView& s, HessianMode mode, bool contact, bool hessian);

  int blocks_ = 0;
  Terms terms_;
  SlotGroupBuffers fixed_, contact_;
  Buffer<Vec3> gradient_;
  BlockMatrix matrix_;
  Span<const ContactPair> candidates_;
  Buffer<int> scratch_;
};
}  // namespace tape::TAPE_SIDE
