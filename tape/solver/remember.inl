#pragma once
#include <limits>

#include "tape/solver/objective.inl"

/// What effects remember: elements out of it when a step starts, and back when it has ended.
namespace tape::TAPE_SIDE {
namespace objective {
/// The pair of this name with its constants.
template <class T>
TAPE_HD typename T::Pair pair_of(const T& term, const detail::SurfaceView& surface, const typename T::Pair::Name& name) {
  if constexpr (Samples<T>) {
    return surface.sample_triangle(name.sample, name.triangle, term.samples);
  } else {
    return surface.vertex_triangle(name.vertex, name.triangle);
  }
}

struct NamedPairs {
  detail::SurfaceView surface;
  Span<const VertexTriangle> names;
  Span<ContactPair> pairs;
  TAPE_HD void operator()(int i) const { pairs[i] = surface.vertex_triangle(names[i].vertex, names[i].triangle); }
};

template <class T>
struct Recall {
  T term;
  StateView s;
  detail::SurfaceView surface;
  Span<const typename T::Memory> memory;
  Span<typename T::Element> elements;
  TAPE_HD void operator()(int i) const { elements[i] = term.recall(memory[i], pair_of(term, surface, memory[i]), s); }
};

/// Contact pairs that may be remembered: candidate k is one of them.
struct PairCandidates {
  Span<const ContactPair> pairs;
  int size;
  template <class T>
  TAPE_HD bool begin(int k, const T& term, const StateView& s, Span<const typename T::Memory> before, typename T::Memory& out) const {
    const ContactPair& pair = pairs[k];
    return pair.triangle >= 0 && !detail::holds(before, pair.name().key()) && term.begin(pair, s, out);
  }
};
/// Samples that may be remembered: candidate k is sample k with the nearest triangle that it sticks to, the first of equally near ones.
struct SampleCandidates {
  detail::SampleQuery query;
  Span<const char> asleep;  ///< empty: none is
  int size;
  template <class T>
  TAPE_HD bool begin(int k, const T& term, const StateView& s, Span<const typename T::Memory> before, typename T::Memory& out) const {
    if (asleep.size > 0 && asleep[k] != 0) return false;
    const int known = detail::first_from(before, pair_key(k, 0));
    if (known < before.size && before[known].sample == k) return false;
    Real nearest = std::numeric_limits<Real>::infinity();
    query.visit(k, term.samples, [&](const SamplePair& pair, Real d) {
      typename T::Memory found;
      const bool nearer = d < nearest || (d == nearest && pair.id.triangle < out.triangle);
      if (nearer && term.begin(pair, s, found)) out = found, nearest = d;
    });
    return nearest < std::numeric_limits<Real>::infinity();
  }
};

template <class T>
auto candidates_of(const Term<T>& term, Span<const ContactPair> pairs, const detail::SampleQuery& samples) {
  if constexpr (Samples<T>) {
    return SampleCandidates{samples, term.asleep.span(), term.view.count()};
  } else {
    return PairCandidates{pairs, pairs.size};
  }
}

/// None.
struct NoCandidates {
  int size = 0;
  template <class T>
  TAPE_HD bool begin(int, const T&, const StateView&, Span<const typename T::Memory>, typename T::Memory&) const {
    return false;
  }
};

/// Flags what is remembered after the step: pairs that were, then candidates that were not.
template <class T, class Candidates>
struct Judge {
  T term;
  StateView s;
  Span<const typename T::Memory> before;
  Candidates candidates;
  Span<typename T::Memory> after;  ///< [before + candidates]
  Span<int> flag;                  ///< [before + candidates + 1], the last stays 0
  TAPE_HD void operator()(int i) const {
    if (i < before.size) {
      after[i] = before[i];
      flag[i] = term.renew(s, i, after[i]) ? 1 : 0;
    } else if (i < after.size) {
      flag[i] = candidates.begin(i - before.size, term, s, before, after[i]) ? 1 : 0;
    } else {
      flag[i] = 0;
    }
  }
};
template <class Memory>
struct Remembered {
  Span<const Memory> after;
  Span<const int> offset;  ///< scanned flags
  Span<std::uint64_t> key;
  Span<int> from;
  TAPE_HD void operator()(int i) const {
    if (offset[i + 1] == offset[i]) return;
    key[offset[i]] = after[i].key();
    from[offset[i]] = i;
  }
};
template <class T>
struct Load {
  T term;
  StateView s;
  TAPE_HD Real operator()(int i) const { return term.load(s, i); }
};
template <class T>
struct LetGo {
  T term;
  StateView s;
  Real above;  ///< [1] load
  Span<typename T::Memory> memory;
  TAPE_HD void operator()(int i) const {
    if (term.load(s, i) > above) term.let_go(s, i, memory[i]);
  }
};
template <class T>
struct AccuracyToJudge {
  T term;
  StateView s;
  TAPE_HD Real operator()(int i) const { return term.accuracy_to_judge(s, i); }
};
template <class Memory>
struct Gather {
  Span<const Memory> after;
  Span<const int> from;
  Span<Memory> memory;
  TAPE_HD void operator()(int i) const { memory[i] = after[from[i]]; }
};
}  // namespace objective

inline void Objective::set_asleep(const std::vector<const EffectMemory*>& memories) {
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if constexpr (Samples<T>) {
      std::vector<char> asleep;
      for (const EffectMemory* memory : memories)
        for (const typename T::Memory& m : std::get<MemoryOf<T>>(*memory).pairs) {
          asleep.resize(static_cast<std::size_t>(term.view.count()), 0);
          asleep[static_cast<std::size_t>(m.sample)] = 1;
        }
      term.asleep.upload(asleep);
    }
  });
}

inline void Objective::recall(const EffectMemory& memory, const StateView& s, const detail::SurfaceView& surface) {
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if constexpr (Remembers<T>) {
      const Stopwatch watch(term.ms);
      term.memory.upload(std::get<MemoryOf<T>>(memory).pairs);
      term.elements.resize(term.memory.size());
      term.view.elements = term.elements.span();
      parallel_for(term.memory.size(), objective::Recall<T>{term.view, s, surface, term.memory.span(), term.elements.span()});
    }
  });
}

inline EffectMemory Objective::remember(const StateView& s, const detail::SampleQuery& samples) {
  EffectMemory memory;
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if constexpr (Remembers<T>) {
      using Memory = typename T::Memory;
      const Stopwatch watch(term.ms);
      const auto candidates = objective::candidates_of(term, candidates_, samples);
      const int all = term.memory.size() + candidates.size;
      Buffer<Memory> after;
      Buffer<std::uint64_t> key;
      Buffer<int> from;
      after.resize(all);
      scratch_.resize(all + 1);
      parallel_for(all + 1, objective::Judge<T, std::remove_cv_t<decltype(candidates)>>{term.view, s, term.memory.span(), candidates,
                                                                                        after.span(), scratch_.span()});
      const int kept = exclusive_scan(scratch_.span());
      key.resize(kept), from.resize(kept), term.memory.resize(kept);
      parallel_for(all, objective::Remembered<Memory>{after.span(), scratch_.span(), key.span(), from.span()});
      sort_by_key(key, from);
      parallel_for(kept, objective::Gather<Memory>{after.span(), from.span(), term.memory.span()});
      std::get<MemoryOf<T>>(memory).pairs = term.memory.download();
    }
  });
  return memory;
}

inline EffectMemory Objective::renewed(const EffectMemory& memory, const StateView& from, const StateView& to,
                                       const detail::SurfaceView& surface) {
  EffectMemory out;
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if constexpr (Remembers<T>) {
      const Buffer<typename T::Memory> before(std::get<MemoryOf<T>>(memory).pairs);
      const int n = before.size();
      Buffer<typename T::Memory> after;
      Buffer<typename T::Element> elements;
      after.resize(n), elements.resize(n), scratch_.resize(n + 1);
      parallel_for(n, objective::Recall<T>{term.view, from, surface, before.span(), elements.span()});
      T view = term.view;
      view.elements = elements.span();
      parallel_for(n + 1, objective::Judge<T, objective::NoCandidates>{view, to, before.span(), {}, after.span(), scratch_.span()});
      const std::vector<typename T::Memory> renewed = after.download();
      const std::vector<int> kept = scratch_.download();
      for (std::size_t i = 0; i < renewed.size(); ++i)
        if (kept[i] != 0) std::get<MemoryOf<T>>(out).pairs.push_back(renewed[i]);
    }
  });
  return out;
}

inline std::optional<EffectMemory> Objective::let_go(const StateView& s, const detail::SurfaceView& surface) {
  constexpr Real kShare = 0.5;
  std::optional<EffectMemory> left;
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if constexpr (requires { term.view.load(s, 0); }) {
      const Stopwatch watch(term.ms);
      const Real most = reduce(term.memory.size(), 0.0, objective::Load<T>{term.view, s}, Larger{});
      if (!(most > 1)) return;
      parallel_for(term.memory.size(), objective::LetGo<T>{term.view, s, std::fmax(1, kShare * most), term.memory.span()});
      parallel_for(term.memory.size(), objective::Recall<T>{term.view, s, surface, term.memory.span(), term.elements.span()});
      if (!left) left.emplace();
      std::get<MemoryOf<T>>(*left).pairs = term.memory.download();
    }
  });
  return left;
}

inline Real Objective::accuracy_to_judge(const StateView& s) {
  Real smallest = std::numeric_limits<Real>::infinity();
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if constexpr (requires { term.view.accuracy_to_judge(s, 0); }) {
      const objective::AccuracyToJudge<T> kernel{term.view, s};
      smallest = reduce(term.view.elements.size, smallest, kernel, Smaller{});
    }
  });
  return smallest;
}

inline Real Objective::adhesive_energy(const StateView& s) {
  Real sum = 0;
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if constexpr (Remembers<T>) sum += objective::energy_of(term, s).sum;
  });
  return sum;
}

inline Real Objective::contact_energy(const StateView& s, const std::vector<VertexTriangle>& pairs, const detail::SurfaceView& surface) {
  Real sum = 0;
  const Buffer<VertexTriangle> names(pairs);
  Buffer<ContactPair> contact;
  contact.resize(names.size());
  parallel_for(names.size(), objective::NamedPairs{surface, names.span(), contact.span()});
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if constexpr (requires { T::contact_pairs; }) {
      T view = term.view;
      view.elements = contact.span();
      sum += reduce(contact.size(), EnergySum{}, objective::ElementEnergy<T>{view, s, {}}, Plus{}).sum;
    }
  });
  return sum;
}
}  // namespace tape::TAPE_SIDE
