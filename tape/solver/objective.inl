#pragma once
#include <limits>

#include "tape/core/functors.hpp"
#include "tape/effects/effects.inl"
#include "tape/solver/objective.hpp"

namespace tape::TAPE_SIDE {
namespace objective {
/// Elements that contribute: all of an effect, or the active ones.
struct Selection {
  Span<const int> ids;  // empty: all
  TAPE_HD int operator[](int i) const { return ids.size > 0 ? ids[i] : i; }
};

template <class T>
struct ElementEnergy {
  T term;
  StateView s;
  Selection select;
  TAPE_HD EnergySum operator()(int i) const {
    const Real e = term.energy(s, select[i]);
    return {e, std::fabs(e)};
  }
};

/// Of all elements that may contribute.
template <class T>
EnergySum energy_of(const Term<T>& term, const StateView& s) {
  const bool all = is_contact<T>;
  const Selection select{all ? Span<const int>{} : term.active.span()};
  return reduce(all ? term.view.elements.size : term.count, EnergySum{}, ElementEnergy<T>{term.view, s, select}, Plus{});
}

template <class T>
struct FirstNonFinite {
  T term;
  StateView s;
  int count;
  TAPE_HD int operator()(int i) const { return std::isfinite(term.energy(s, i)) ? count : i; }
};
/// Which elements of an effect that sleeps are awake.
template <class T>
struct FlagAwake {
  T term;
  StateView s;
  Span<int> flag;  // [count + 1], the last stays 0
  TAPE_HD void operator()(int i) const { flag[i] = i + 1 < flag.size && is_awake(i) ? 1 : 0; }

 private:
  TAPE_HD bool is_awake(int i) const {
    const auto stencil = term.stencil(i);
    if constexpr (stencil_size<T> == 1) {
      return s.mass[stencil.id[0]] != 0;
    } else {
      const int body = s.owner[stencil.id[0]].body;
      bool one = body >= 0;
      for (int v : stencil.id) one = one && s.owner[v].body == body;
      return !one;
    }
  }
};
/// Of the derivatives, where the elements of an effect have written them.
struct FirstNonFiniteSlot {
  Span<const int> gradient, hessian;  // [count + 1]
  Span<const Vec3> gradient_slots;
  Span<const Mat3> hessian_slots;
  int count;
  TAPE_HD int operator()(int i) const {
    for (int k = gradient[i]; k < gradient[i + 1]; ++k)
      if (!std::isfinite(gradient_slots[k].squaredNorm())) return i;
    for (int k = hessian[i]; k < hessian[i + 1]; ++k)
      if (!std::isfinite(hessian_slots[k].squaredNorm())) return i;
    return count;
  }
};
template <class T>
struct FlagActive {
  T term;
  StateView s;
  Span<int> flag;  // [count + 1], the last stays 0
  TAPE_HD void operator()(int i) const { flag[i] = i + 1 < flag.size && term.active(s, i) ? 1 : 0; }
};
struct Compact {
  Span<const int> offset;  // [count + 1] scanned flags
  Span<int> ids;
  TAPE_HD void operator()(int i) const {
    if (offset[i + 1] > offset[i]) ids[offset[i]] = i;
  }
};

template <class T>
struct FlagLagged {
  T term;
  StateView s;
  Span<const ContactPair> pairs;
  Span<int> flag;  // [pairs + 1]
  TAPE_HD void operator()(int i) const {
    typename T::Element e;
    flag[i] = i < pairs.size && term.lag(pairs[i], s, e) ? 1 : 0;
  }
};
template <class T>
struct MakeLagged {
  T term;
  StateView s;
  Span<const ContactPair> pairs;
  Span<const int> offset;  // [pairs + 1]
  Span<typename T::Element> elements;
  TAPE_HD void operator()(int i) const {
    if (offset[i + 1] > offset[i]) term.lag(pairs[i], s, elements[offset[i]]);
  }
};

/// Blocks of element i: relocated vertices, or the stencil itself where it names blocks.
template <class T>
TAPE_HD auto blocks_of(const T& term, const StateView& s, int i) {
  if constexpr (on_blocks<T>) {
    DirectBlocks<stencil_size<T>> r;
    const auto stencil = term.stencil(i);
    for (int a = 0; a < stencil_size<T>; ++a) r.block[a] = stencil.id[a];
    return r;
  } else {
    return relocate(term.stencil(i), s);
  }
}

template <class T>
struct CountBlocks {
  T term;
  StateView s;
  Selection select;
  int count;
  Span<int> gradient, hessian;  // [count + 1]
  TAPE_HD void operator()(int i) const {
    const int m = i < count ? blocks_of(term, s, select[i]).blocks : 0;
    gradient[i] = m;
    hessian[i] = m * (m + 1) / 2;
  }
};

template <class T>
struct EmitKeys {
  T term;
  StateView s;
  Selection select;
  Span<const int> gradient, hessian;
  int gradient_base, hessian_base;
  Span<std::uint64_t> rows, keys;
  TAPE_HD void operator()(int i) const {
    const auto r = blocks_of(term, s, select[i]);
    for (int a = 0; a < r.blocks; ++a) {
      rows[gradient_base + gradient[i] + a] = static_cast<std::uint64_t>(r.block[a]);
      for (int b = a; b < r.blocks; ++b) {
        const bool upper = r.block[a] <= r.block[b];
        keys[hessian_base + hessian[i] + pair_slot(a, b, r.blocks)] =
            block_key(upper ? r.block[a] : r.block[b], upper ? r.block[b] : r.block[a]);
      }
    }
  }
};

/// Adds c (J^T g) (J^T g)^T to the blocks of an element.
template <class Blocks>
struct AddSquare {
  const Blocks& r;
  Mat3* out;
  template <class G>
  TAPE_HD void operator()(Real c, const G& g) const {
    Vec3 j[2 * G::RowsAtCompileTime / 3];
    relocate_gradient(r, g, j);
    for (int a = 0; a < r.blocks; ++a)
      for (int b = a; b < r.blocks; ++b) out[pair_slot(a, b, r.blocks)] += c * j[a] * j[b].transpose();
  }
};

template <class T>
struct FillSlots {
  T term;
  StateView s;
  Selection select;
  HessianMode mode;
  bool with_hessian;
  Span<const int> gradient, hessian;
  int gradient_base, hessian_base;
  Span<Vec3> gradient_out;
  Span<Mat3> hessian_out;
  TAPE_HD void operator()(int i) const {
    const int e = select[i];
    const auto r = blocks_of(term, s, e);
    const VecN<3 * stencil_size<T>> g = term.gradient(s, e);
    Mat3* out = hessian_out.data + hessian_base + hessian[i];
    relocate_gradient(r, g, gradient_out.data + gradient_base + gradient[i]);
    if (!with_hessian) return;
    if (!fill_squares(r, e, out)) {
      const MatN<3 * stencil_size<T>, 3 * stencil_size<T>> H = term.hessian(s, e, mode);
      relocate_hessian(r, g, H, mode == HessianMode::exact, out);
    }
    for (int a = 0; a < r.blocks; ++a)  // the matrix stores its upper triangle
      for (int b = a + 1; b < r.blocks; ++b)
        if (Mat3& m = out[pair_slot(a, b, r.blocks)]; r.block[a] > r.block[b]) m = Mat3(m.transpose());
  }

 private:
  /// What is projected, or between rigid bodies only: there the rest of the Hessian is forces times curvature of the relative motion,
  /// next to nothing beside what keeps the bodies apart or together, and costs most of the assembly of a reduced roll.
  template <class Blocks>
  TAPE_HD bool fill_squares(const Blocks& r, int e, Mat3* out) const {
    const AddSquare<Blocks> add{r, out};
    if constexpr (requires { term.squares(s, e, add); }) {
      if (mode == HessianMode::projected || rigid(r)) {
        for (int p = 0; p < r.blocks * (r.blocks + 1) / 2; ++p) out[p] = Mat3::Zero();
        return term.squares(s, e, add);
      }
    }
    return false;
  }
};

/// Whether an element joins two bodies and nothing else: elements of one body alone there are none that are awake.
struct Joins {
  int standing, moving;
  template <int K>
  TAPE_HD bool operator()(const Stencil<K>& stencil, const StateView& s) const {
    for (int v : stencil.id)
      if (const int body = s.owner[v].body; body != standing && body != moving) return false;
    return true;
  }
};
/// Adds c (J^T g) (J^T g)^T, of a motion of one body, to a matrix.
template <class Motion>
struct AddMotionSquare {
  const Motion& of;
  MatN<6, 6>& out;
  template <class G>
  TAPE_HD void operator()(Real c, const G& g) const {
    const VecN<6> j = of(g);
    out += c * j * j.transpose();
  }
};
/// Element i by the motion of one of two bodies.
template <class T>
struct FormBetween {
  T term;
  StateView s;
  Joins joins;
  Vec3 about;
  Span<PlaceForm> forms;
  TAPE_HD void operator()(int i) const { forms[i] = form_of(i); }

 private:
  TAPE_HD PlaceForm form_of(int i) const {
    constexpr int K = stencil_size<T>;
    PlaceForm form;
    const Stencil<K> stencil = term.stencil(i);
    if (!joins(stencil, s)) return form;
    form.energy = term.energy(s, i);
    if constexpr (requires { term.active(s, i); })
      if (!term.active(s, i)) return form;
    const auto moves = [&](const VecN<3 * K>& g) {
      VecN<6> sum = VecN<6>::Zero();
      for (int k = 0; k < K; ++k) {
        if (s.owner[stencil.id[k]].body != joins.moving) continue;
        const Vec3 f = g.template segment<3>(3 * k), arm = s.x[stencil.id[k]] - about;
        sum.template head<3>() += f, sum.template tail<3>() += arm.cross(f);
      }
      return sum;
    };
    form.force = moves(term.gradient(s, i));
    const AddMotionSquare<decltype(moves)> add{moves, form.stiffness};
    if constexpr (requires { term.squares(s, i, add); })
      if (term.squares(s, i, add)) return form;
    const MatN<3 * K, 3 * K> h = term.hessian(s, i, HessianMode::projected);
    MatN<3 * K, 6> column;
    for (int c = 0; c < 3 * K; ++c) column.row(c) = moves(h.col(c)).transpose();
    for (int c = 0; c < 6; ++c) form.stiffness.col(c) += moves(column.col(c));
    return form;
  }
};
template <class T>
struct SlackBetween {
  T term;
  StateView s;
  Joins joins;
  TAPE_HD Real operator()(int i) const { return joins(term.stencil(i), s) ? term.slack(s, i) : std::numeric_limits<Real>::infinity(); }
};
}  // namespace objective

inline Objective::Objective(const Scene& scene, const EffectParams& effects, const Assembly& assembly, const std::vector<bool>& on) {
  std::size_t k = 0;
  const auto build = [&]<class T>(Term<T>& term) {
    term.on = on[k++];
    if (!term.on) return;
    std::vector<typename T::Element> elements;
    term.view = T::build(scene, assembly, params<T>(effects), elements);
    term.elements.upload(elements);
    term.view.elements = term.elements.span();
    term.count = term.elements.size();
  };
  std::apply([&](auto&... term) { (build(term), ...); }, terms_);
}

inline void Objective::set_carriage(int blocks, const StateView& s) {
  blocks_ = blocks;
  gradient_.resize(blocks_);
  set_pattern(s, false);
  matrix_.set_fixed_pattern(blocks_, fixed_.keys.span());
}

inline void Objective::set_candidates(Span<const ContactPair> candidates) {
  candidates_ = candidates;
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if constexpr (requires { T::contact_pairs; }) term.view.elements = candidates;
  });
}

inline void Objective::begin_step(const StateView& s) {
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if constexpr (requires(typename T::Element & e) { term.view.lag(candidates_[0], s, e); }) {
      term.view.elements = {};
      if (candidates_.size == 0) return;
      const Stopwatch watch(term.ms);
      scratch_.resize(candidates_.size + 1);
      parallel_for(candidates_.size + 1, objective::FlagLagged<T>{term.view, s, candidates_, scratch_.span()});
      term.elements.resize(exclusive_scan(scratch_.span()));
      term.view.elements = term.elements.span();
      parallel_for(candidates_.size, objective::MakeLagged<T>{term.view, s, candidates_, scratch_.span(), term.elements.span()});
    }
  });
}

inline void Objective::set_seats(const std::vector<Seat::Element>& seats) {
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if constexpr (std::is_same_v<T, Seat>) {
      term.elements.upload(seats);
      term.view.elements = term.elements.span();
    }
  });
}

inline PlaceForm Objective::between(const StateView& s, int standing, int moving, const Vec3& about) {
  PlaceForm sum;
  Buffer<PlaceForm> forms;  // summed on the host: they are too large for a block's memory on a device
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if constexpr (is_contact<T> && !requires { T::incremental; }) {
      forms.resize(term.view.elements.size);
      parallel_for(forms.size(), objective::FormBetween<T>{term.view, s, {standing, moving}, about, forms.span()});
      for (const PlaceForm& form : forms.download()) sum = sum + form;
    }
  });
  return sum;
}

inline Real Objective::slack_between(const StateView& s, int standing, int moving) {
  Real least = std::numeric_limits<Real>::infinity();
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if constexpr (Remembers<T>)
      least = reduce(term.view.elements.size, least, objective::SlackBetween<T>{term.view, s, {standing, moving}}, Smaller{});
  });
  return least;
}

inline EnergySum Objective::energy(const StateView& s) {
  EnergySum total;
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if (term.view.elements.size == 0) return;
    const Stopwatch watch(term.ms);
    total = total + objective::energy_of(term, s);
  });
  return total;
}

inline std::string Objective::first_non_finite(const StateView& s) {
  std::string where;
  for_each([&]<class T>(std::string_view name, Term<T>& term) {
    const int n = term.view.elements.size;
    const int i = where.empty() ? reduce(n, n, objective::FirstNonFinite<T>{term.view, s, n}, Smaller{}) : n;
    if (i < n) where = "effect '" + std::string(name) + "', element " + std::to_string(i);
  });
  return where;
}

inline std::string Objective::first_non_finite_derivative() {
  std::string where;
  for_each([&]<class T>(std::string_view name, Term<T>& term) {
    if (term.count == 0 || !where.empty()) return;
    const SlotGroupBuffers& group = is_contact<T> ? contact_ : fixed_;
    const objective::FirstNonFiniteSlot kernel{
        term.offsets.gradient.span(),
        term.offsets.hessian.span(),
        {group.gradient.span().data + term.gradient_base, group.gradient.size() - term.gradient_base},
        {group.hessian.span().data + term.hessian_base, group.hessian.size() - term.hessian_base},
        term.count};
    if (const int i = reduce(term.count, term.count, kernel, Smaller{}); i < term.count)
      where = "derivatives of effect '" + std::string(name) + "', active element " + std::to_string(i);
  });
  return where;
}

/// Finds the contributing elements of a group and gives each its slots.
inline void Objective::set_pattern(const StateView& s, bool contact) {
  SlotGroupBuffers& group = contact ? contact_ : fixed_;
  int gradient_slots = 0, hessian_slots = 0;
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if (is_contact<T> != contact) return;
    const int n = term.view.elements.size;
    term.count = n;
    if (n == 0) return;
    const Stopwatch watch(term.ms);
    if constexpr (is_contact<T> && requires { term.view.active(s, 0); }) {
      scratch_.resize(n + 1);
      parallel_for(n + 1, objective::FlagActive<T>{term.view, s, scratch_.span()});
      term.count = exclusive_scan(scratch_.span());
      term.active.resize(term.count);
      parallel_for(n, objective::Compact{scratch_.span(), term.active.span()});
    }
    if constexpr (sleeps<T>) {
      scratch_.resize(n + 1);
      parallel_for(n + 1, objective::FlagAwake<T>{term.view, s, scratch_.span()});
      term.count = exclusive_scan(scratch_.span());
      term.active.resize(term.count < n ? term.count : 0);
      if (term.count < n) parallel_for(n, objective::Compact{scratch_.span(), term.active.span()});
    }
    term.offsets.gradient.resize(term.count + 1);
    term.offsets.hessian.resize(term.count + 1);
    parallel_for(term.count + 1,
                 objective::CountBlocks<T>{
                     term.view, s, {term.active.span()}, term.count, term.offsets.gradient.span(), term.offsets.hessian.span()});
    term.gradient_base = gradient_slots;
    term.hessian_base = hessian_slots;
    term.gradient_slots = exclusive_scan(term.offsets.gradient.span());
    gradient_slots += term.gradient_slots;
    hessian_slots += exclusive_scan(term.offsets.hessian.span());
  });
  group.rows.resize(gradient_slots);
  group.keys.resize(hessian_slots);
  group.gradient.resize(gradient_slots);
  group.hessian.resize(hessian_slots);
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if (is_contact<T> != contact || term.count == 0) return;
    const Stopwatch watch(term.ms);
    parallel_for(term.count, objective::EmitKeys<T>{term.view,
                                                    s,
                                                    {term.active.span()},
                                                    term.offsets.gradient.span(),
                                                    term.offsets.hessian.span(),
                                                    term.gradient_base,
                                                    term.hessian_base,
                                                    group.rows.span(),
                                                    group.keys.span()});
  });
  if (!contact || group.rows.size() > 0) group.gather.set_rows(blocks_, group.rows);
}

inline void Objective::fill(const StateView& s, HessianMode mode, bool contact, bool hessian) {
  SlotGroupBuffers& group = contact ? contact_ : fixed_;
  for_each([&]<class T>(std::string_view, Term<T>& term) {
    if (is_contact<T> != contact || term.count == 0) return;
    const Stopwatch watch(term.ms);
    parallel_for(term.count,
                 objective::FillSlots<T>{term.view,
                                         s,
                                         {term.active.span()},
                                         mode,
                                         hessian,
                                         term.offsets.gradient.span(),
                                         term.offsets.hessian.span(),
                                         term.gradient_base,
                                         term.hessian_base,
                                         group.gradient.span(),
                                         group.hessian.span()},
                 kFew);
  });
  if (!contact || group.rows.size() > 0) group.gather.gather(group.gradient.span(), contact, gradient_.span());
}

template <class F>
void Objective::for_each_force(const StateView& s, int blocks, const F& f) {
  set_pattern(s, true);
  for (const bool contact : {false, true}) {
    fill(s, HessianMode::exact, contact, false);
    const SlotGroupBuffers& group = contact ? contact_ : fixed_;
    const std::vector<std::uint64_t> rows = group.rows.download();
    const std::vector<Vec3> gradient = group.gradient.download();
    for_each([&]<class T>(std::string_view, Term<T>& term) {
      if (is_contact<T> != contact || term.count == 0) return;
      std::vector<Vec3> force(static_cast<std::size_t>(blocks), Vec3::Zero());
      const auto first = static_cast<std::size_t>(term.gradient_base), end = first + static_cast<std::size_t>(term.gradient_slots);
      for (std::size_t k = first; k < end; ++k)
        if (rows[k] < force.size()) force[rows[k]] -= gradient[k];
      f(std::type_identity<T>{}, force);
    });
  }
}

inline void Objective::linearize(const StateView& s, HessianMode mode) {
  set_pattern(s, true);
  fill(s, mode, false, true);
  fill(s, mode, true, true);
  matrix_.accumulate_fixed(fixed_.hessian.span());
  matrix_.set_contact_pattern(contact_.keys.span());
  matrix_.accumulate_contact(contact_.hessian.span());
}
}  // namespace tape::TAPE_SIDE
