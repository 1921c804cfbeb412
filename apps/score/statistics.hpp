#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "tape/core/settings.hpp"

namespace tape::score {
struct Interval {
  Real low = 0, high = 0;
};
/// So many successes out of so many trials.
struct Proportion {
  int successes = 0, trials = 0;
  Real value() const { return static_cast<Real>(successes) / trials; }
};

/// Score interval of a proportion p = k/n at 95 %, z = 1.959964:
///   (p + z^2/2n -+ z sqrt(p (1-p)/n + z^2/4n^2)) / (1 + z^2/n).  Source: [Wilson 1927].
/// @throws InputError unless 0 <= k <= n and n > 0
Interval wilson(Proportion p);

/// Difference of two proportions of independent groups.
struct Difference {
  Real value = 0;
  Interval interval;
};
/// a - b with its 95 % interval out of the Wilson intervals [l, u] of both:
///   low = d - sqrt((p_a - l_a)^2 + (u_b - p_b)^2),  high = d + sqrt((u_a - p_a)^2 + (p_b - l_b)^2).  Source: [Newcombe 1998], method 10.
Difference newcombe(Proportion a, Proportion b);

/// Matched cases by what happened in reality and in the simulation; positive is success.
struct Confusion {
  int true_positive = 0;   ///< both succeed
  int false_positive = 0;  ///< in the simulation only
  int false_negative = 0;  ///< in reality only
  int true_negative = 0;   ///< both fail

  int cases() const { return true_positive + false_positive + false_negative + true_negative; }
  Proportion simulated() const { return {true_positive + false_positive, cases()}; }
  Proportion real() const { return {true_positive + false_negative, cases()}; }
  Proportion agreement() const { return {true_positive + true_negative, cases()}; }
  /// Mean recall over real successes and real failures. Undefined, and empty, where one of the two classes is.
  std::optional<Real> balanced_accuracy() const;
  /// McNemar's exact test: probability that chance alone splits the disagreements at least as unevenly over both sides,
  ///   min(1, 2 sum_{i <= min(b,c)} C(b+c, i) / 2^(b+c)),  b and c the false positives and negatives.  Source: [McNemar 1947].
  Real mcnemar() const;
};
/// Outcomes of the same cases in the same order.  @throws InputError unless both lists are of one length, and not empty
Confusion compare(const std::vector<bool>& simulated, const std::vector<bool>& real);

struct BootstrapParams {
  int resamples = 10000;
  Real level = 0.95;
  int seed = 1;
  template <class F>
  void fields(F&& f) {
    f("resamples", resamples, "1", Range::closed(100, 10'000'000), "how often the episodes are drawn again");
    f("level", level, "1", {.low = 0, .high = 1, .open_low = true, .open_high = true}, "share of the resamples inside the interval");
    f("seed", seed, "", Range::non_negative(), "of the random numbers");
  }
};
/// Percentile interval of a statistic of n episodes: it is computed for lists of n episodes drawn with replacement, and the interval
/// holds the middle `level` of the results. The same to the bit everywhere: the numbers are those of the standard's mt19937_64.
/// @param statistic  of a list of indices in [0, n)
/// @throws InputError without episodes, SettingsError for a setting out of range
Interval bootstrap(int n, const std::function<Real(const std::vector<int>&)>& statistic, const BootstrapParams& params = {});
/// Of the mean of one value per episode.
Interval bootstrap_mean(const std::vector<Real>& values, const BootstrapParams& params = {});

/// @throws InputError for an empty list
Real mean(const std::vector<Real>& values);
}  // namespace tape::score
