#pragma once
#include <span>
#include <vector>

#include "tape/contact/pair.hpp"
#include "tape/core/settings.hpp"

namespace tape {
/// The largest pressure of a blade on a strip.
struct BladePressure {
  Real peak = 0;           ///< [Pa]
  int triangle = -1;       ///< of the element with it; -1: no blade touches
  std::vector<int> above;  ///< triangles of the elements at the threshold or above, in order
};

/// Pressure of sharp things on the elements of strips: p_e = (sum of the forces on e) / A_e. A blade's vertex loads a triangle, with its
/// area; its edge an edge of the strip, with a third of the triangles at that; its triangle a vertex, with a third of those around
/// it. Of a pair's force that part counts that acts on sharp vertices, by the weights of the closest points.  Source: the paper, Sec.
/// III-D.
class BladePressureProbe {
 public:
  /// @param triangles  of strips, by the world's vertices
  /// @param area       [triangles] m^2, at rest
  /// @param sharp      [vertices of the world] 1: of a blade's edge
  BladePressureProbe(const std::vector<Index3>& triangles, const std::vector<Real>& area, const std::vector<char>& sharp);

  /// @param force      [pairs] N, by which each pair's barrier pushes its two primitives apart
  /// @param x          [vertices of the world] m
  /// @param threshold  [Pa]
  BladePressure measure(const std::vector<ContactPair>& pairs, const std::vector<Real>& force, const std::vector<Vec3>& x,
                        Real threshold) const;

 private:
  std::span<const int> around(int v) const { return {around_.data() + begin_[v], around_.data() + begin_[v + 1]}; }
  bool is_of_strip(int v) const { return v + 1 < static_cast<int>(begin_.size()) && begin_[v] < begin_[v + 1]; }
  /// Triangles that have all of the vertices.
  std::vector<int> triangles_at(const std::vector<int>& vertices) const;
  Real sharp_part(const ContactPair& pair, const std::vector<Vec3>& x, int first, int end) const;

  std::vector<Index3> triangles_;
  std::vector<Real> area_;
  std::vector<char> sharp_;
  std::vector<int> begin_, around_;  ///< of vertex v: around_[begin_[v] ... begin_[v + 1]), triangles
};

/// When to cut.
struct TriggerParams {
  Real threshold = 1e3;
  int steps = 2;
  int cooldown = 3;
  int retry = 3;
  template <class F>
  void fields(F&& f) {
    f("threshold", threshold, "Pa", Range::positive(), "blade pressure that cuts");
    f("steps", steps, "1", Range::closed(1, 1000), "steps on end that it must last");
    f("cooldown", cooldown, "1", Range::closed(0, 1000), "steps after a cut in which none is made");
    f("retry", retry, "1", Range::closed(0, 1000), "steps after a refused cut in which none is tried");
  }
};

/// Counts the steps of one strip towards a cut. Part of the state of a run.
struct CutTrigger {
  int above = 0;    ///< steps on end with the pressure at the threshold or above
  int waiting = 0;  ///< steps of the cooldown, or until the next try, that are left
  /// Once at the end of each step. @returns whether to cut now; the cooldown then starts.
  bool update(Real peak, const TriggerParams& params) {
    if (waiting > 0) {
      --waiting;
      return false;
    }
    above = peak >= params.threshold ? above + 1 : 0;
    if (above < params.steps) return false;
    above = 0;
    waiting = params.cooldown;
    return true;
  }
};
}  // namespace tape
