#pragma once
#include <concepts>
#include <string>
#include <string_view>
#include <vector>

#include "tape/bodies/assembly.hpp"
#include "tape/bodies/state_view.hpp"
#include "tape/contact/pair.hpp"
#include "tape/core/settings.hpp"
#include "tape/model/scene.hpp"

namespace tape {
/// One term of the incremental potential. The type itself is a plain view that kernels take by value: a few constants and
/// `elements`, a span that the step sets to memory of its side. Energies are in joules, before the factor dt^2 that assembly
/// applies to all of them.
///
/// Headers declare what kernels call (`TAPE_HD inline`); the definitions, which instantiate much of Eigen, stand in <effect>.inl and are
/// included only where formulas are compiled (effects.inl). Declarations are all that the concepts below need.
///
/// Optional, found by `if constexpr (requires ...)`:
///   static constexpr bool on_blocks = true     the stencil names blocks of unknowns, not vertices: no relocation
///   bool lag(pair, s, Element& out)            elements are made at the start of each step, from the contact pairs for which this
///                                              returns true (s.x is s.x_start then)
///   static constexpr bool sleeps = true        an element whose vertices one body carries is left out, as its energy is constant; of
///                                              elements of single vertices those without mass, which a cluster has in their place
///   static constexpr bool incremental = true   its energy belongs to the step and is not stored: inertia, friction
///   static constexpr bool contact_pairs = true elements are the candidates of the contact search
///   using Pair                                 ContactPair, or SamplePair: then `samples` to a side and count() in all
///   struct Memory : Pair::Name                 what it remembers of a pair from step to step, with visit(f) over all its members (Real or
///                                              int):
///     Element recall(memory, pair, s)          the element of a remembered pair, at the start of each step
///     bool renew(s, i, Memory&)                what element i remembers at the end of the step; false: the pair is forgotten
///     bool begin(pair, s, Memory& out)         whether a candidate that was not remembered is from now on; a sample sticks to the nearest
///     AdhesiveForce force(s, i)                what element i carries, for the report
///     Real load(s, i), void let_go(s, i, Memory&)   optional: [1] what element i bears over what it can hold, and how it is remembered
///                                              from where it can no more
///     Real accuracy_to_judge(s, i)             optional: [m] to which positions must be solved before let_go or renew may judge element i
///     Real slack(s, i)                         [m] by which the sides of the pair may move against each other before what it can hold
///                                              changes; 0: it does so in time as well
///     Real Memory::engagement(adhesion)        [1] how much of a new pair's adhesion it has, for pictures
///     Memory::replaces_contact()               optional: while true the pair leaves contact and friction; CCD only keeps it from crossing
///   bool squares(s, i, add)                    the projected Hessian as sum of c g g^T: calls add(c, g) for each; false, and no call,
///   where it
///                                              is of another form
///   bool active(s, i)                          false: element i contributes nothing here, gradient and Hessian skip it
template <class T>
concept Effect = requires(const Scene& scene, const Assembly& assembly, typename T::Params& p, std::vector<typename T::Element>& elements,
                          const T& term, const StateView& s, int i, HessianMode mode) {
  requires Settings<typename T::Params>;
  { T::name } -> std::convertible_to<std::string_view>;           // key in the scene file, in timings and in every report
  { T::needed(scene, p) } -> std::same_as<std::string>;           // what asks for it; empty: not built, launched or timed
  { T::build(scene, assembly, p, elements) } -> std::same_as<T>;  // on the host, once per run
  term.elements;                                                  // Span<const Element>
  term.stencil(i);                                                // Stencil<K>
  { term.energy(s, i) } -> std::same_as<Real>;                    // [J]
  term.gradient(s, i);                                            // [N]   VecN<3K>
  term.hessian(s, i, mode);                                       // [N/m] MatN<3K, 3K>
};

/// What one adhering pair carries.
struct AdhesiveForce {
  int interface;    ///< of ContactPair
  int vertex[3];    ///< that carry the place of the strip
  Real weight[3];   ///< [1] by which they carry it; they sum to 1
  bool live;        ///< it still adheres
  Real normal;      ///< [N] that holds the pair together; negative: pushes it apart
  Real tangential;  ///< [N] against sliding
};

template <class T>
concept Remembers = requires(const T& term, typename T::Memory& m, const typename T::Pair& pair, const StateView& s, int i) {
  { term.recall(m, pair, s) } -> std::same_as<typename T::Element>;
  { term.renew(s, i, m) } -> std::same_as<bool>;
  { term.begin(pair, s, m) } -> std::same_as<bool>;
  { term.force(s, i) } -> std::same_as<AdhesiveForce>;
  { term.slack(s, i) } -> std::same_as<Real>;
  { m.engagement(s.adhesion[0]) } -> std::same_as<Real>;
  requires std::derived_from<typename T::Memory, typename T::Pair::Name>;
};
/// What sticks are samples of the strips' area, not vertices.
template <class T>
concept Samples = Remembers<T> && std::same_as<typename T::Pair, SamplePair>;

/// Params of an effect that has nothing to set.
struct NoParams {
  template <class F>
  void fields(F&&) {}
};

/// Number of ids in the stencil of an effect.
template <class T>
inline constexpr int stencil_size = decltype(std::declval<const T&>().stencil(0))::size;
}  // namespace tape
