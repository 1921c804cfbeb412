#pragma once
#include "tape/solver/objective.inl"

/// What effects remember: elements out of it when a step starts, and back when it has ended.
namespace tape::TAPE_SIDE {
namespace objective {
template <class T>
struct Recall {
  T term;
  StateView s;
  detail::SurfaceView surface;
  Span<const typename T::Memory> memory;
  Span<typename T::Element> elements;
  TAPE_HD void operator()(int i) const {
    elements[i] = term.recall(memory[i], surface.vertex_triangle(memory[i].vertex, memory[i].triangle), s);
  }
};

/// Flags what is remembered after the step: pairs that were, then candidates that were not.
template <class T>
struct Judge {
  T term;
  StateView s;
  Span<const typename T::Memory> before;
  Span<const ContactPair> candidates;
  Span<typename T::Memory> after;  ///< [before + candidates]
  Span<int> flag;                  ///< [before + candidates + 1], the last stays 0
  TAPE_HD void operator()(int i) const {
    if (i < before.size) {
      after[i] = before[i];
      flag[i] = term.renew(s, i, after[i]) ? 1 : 0;
    } else if (i < after.size) {
      const ContactPair& pair = candidates[i - before.size];
      flag[i] = pair.triangle >= 0 && detail::find_pair(before, pair.name().key()) < 0 && term.begin(pair, s, after[i]) ? 1 : 0;
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
struct AccuracyToJudge {
  T term;
  StateView s;
  TAPE_HD Real operator()(int i) const { return term.accuracy_to_judge(s, i); }
};
struct SmallerReal {
  TAPE_HD Real operator()(Real a, Real b) const { return a < b ? a : b; }
};
template <class Memory>
struct Gather {
  Span<const Memory> after;
  Span<const int> from;
  Span<Memory> memory;
  TAPE_HD void operator()(int i) const { memory[i] = after[from[i]]; }
};
}  // namespace objective

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

inline EffectMemory Objective::remember(const StateView& s) {
  EffectMemory memory;
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if constexpr (Remembers<T>) {
      using Memory = typename T::Memory;
      const Stopwatch watch(term.ms);
      const int all = term.memory.size() + candidates_.size;
      Buffer<Memory> after;
      Buffer<std::uint64_t> key;
      Buffer<int> from;
      after.resize(all);
      scratch_.resize(all + 1);
      parallel_for(all + 1, objective::Judge<T>{term.view, s, term.memory.span(), candidates_, after.span(), scratch_.span()});
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

inline Real Objective::accuracy_to_judge(const StateView& s) {
  Real smallest = std::numeric_limits<Real>::infinity();
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if constexpr (requires { term.view.accuracy_to_judge(s, 0); }) {
      const objective::AccuracyToJudge<T> kernel{term.view, s};
      smallest = reduce(term.view.elements.size, smallest, kernel, objective::SmallerReal{});
    }
  });
  return smallest;
}

inline Real Objective::adhesive_energy(const StateView& s) {
  Real sum = 0;
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if constexpr (Remembers<T>)
      sum += reduce(term.view.elements.size, EnergySum{}, objective::ElementEnergy<T>{term.view, s}, objective::AddEnergies{}).sum;
  });
  return sum;
}
}  // namespace tape::TAPE_SIDE
