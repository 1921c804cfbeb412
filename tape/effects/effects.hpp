#pragma once
#include <tuple>
#include <type_traits>

#include "tape/effects/axle.hpp"
#include "tape/effects/axle_torque.hpp"
#include "tape/effects/barrier.hpp"
#include "tape/effects/bending.hpp"
#include "tape/effects/body_drive.hpp"
#include "tape/effects/body_inertia.hpp"
#include "tape/effects/bonds.hpp"
#include "tape/effects/cohesion.hpp"
#include "tape/effects/cohesive_zone.hpp"
#include "tape/effects/friction.hpp"
#include "tape/effects/gravity.hpp"
#include "tape/effects/inertia.hpp"
#include "tape/effects/membrane.hpp"
#include "tape/effects/seat.hpp"
#include "tape/effects/tether.hpp"

namespace tape {
/// The one list of effects. Reading and writing scenes, checks, assembly on both back ends, timing, reports and the tests that hold
/// for all of them follow from it.
using Effects = std::tuple<Inertia, BodyInertia, BodyDrive, Gravity, Membrane, Bending, Barrier, Friction, Cohesion, CohesiveZone, Bonds,
                           Tether, Axle, AxleTorque, Seat>;

/// The settings of one effect, told apart by the effect even where two have none.
template <class T>
struct ParamsOf {
  typename T::Params value;
};
template <class... T>
std::tuple<ParamsOf<T>...> params_of(std::tuple<T...>*);
using EffectParams = decltype(params_of(static_cast<Effects*>(nullptr)));

template <class T>
typename T::Params& params(EffectParams& all) {
  return std::get<ParamsOf<T>>(all).value;
}
template <class T>
const typename T::Params& params(const EffectParams& all) {
  return std::get<ParamsOf<T>>(all).value;
}

/// What one effect remembers from step to step, sorted by its keys; nothing if it has no Memory.
template <class T>
struct MemoryOf {};
template <class T>
requires Remembers<T>
struct MemoryOf<T> {
  std::vector<typename T::Memory> pairs;
};
template <class... T>
std::tuple<MemoryOf<T>...> memory_of(std::tuple<T...>*);
using EffectMemory = decltype(memory_of(static_cast<Effects*>(nullptr)));

/// Calls f(pairs) with the vector of what each effect remembers, in the order of the list.
template <class F>
void for_each_memory(EffectMemory& memory, const F& f) {
  const auto call = [&]<class T>(MemoryOf<T>& of_effect) {
    if constexpr (Remembers<T>) f(of_effect.pairs);
  };
  std::apply([&](auto&... of_effect) { (call(of_effect), ...); }, memory);
}

/// Vertex and triangle of all pairs that have left contact, sorted.
inline std::vector<VertexTriangle> pairs_out_of_contact(EffectMemory memory) {
  std::vector<VertexTriangle> pairs;
  for_each_memory(memory, [&](auto& remembered) {
    if constexpr (requires { remembered[0].replaces_contact(); })
      for (const auto& m : remembered)
        if (m.replaces_contact()) pairs.push_back({m.vertex, m.triangle});
  });
  return pairs;
}

/// Calls f(std::type_identity<T>) for each effect, in the order of the list.
template <class F>
void for_each_effect(const F& f) {
  [&]<class... T>(std::type_identity<std::tuple<T...>>) { (f(std::type_identity<T>{}), ...); }(std::type_identity<Effects>{});
}
}  // namespace tape
