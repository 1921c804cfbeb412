#include "apps/score/statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace tape::score {
namespace {
constexpr Real kZ = 1.959963984540054;  // 97.5 % of a normal distribution lie below

/// A number below n, each equally likely. std::uniform_int_distribution differs between standard libraries.
int below(int n, std::mt19937_64& random) {
  const auto count = static_cast<std::uint64_t>(n);
  const std::uint64_t surplus = (std::mt19937_64::max() % count + 1) % count;  // 2^64 mod n: what would favour the small ones
  std::uint64_t draw = random();
  while (draw > std::mt19937_64::max() - surplus) draw = random();
  return static_cast<int>(draw % count);
}

/// Of sorted values, linear between neighbours.
Real quantile(const std::vector<Real>& sorted, Real share) {
  const Real place = share * static_cast<Real>(sorted.size() - 1);
  const auto i = static_cast<std::size_t>(place);
  const std::size_t next = std::min(i + 1, sorted.size() - 1);
  return sorted[i] + (place - static_cast<Real>(i)) * (sorted[next] - sorted[i]);
}
}  // namespace

Interval wilson(Proportion p) {
  if (p.trials <= 0 || p.successes < 0 || p.successes > p.trials)
    throw InputError(fmt::format("{} successes out of {} trials (allowed: 0 to all of at least one trial)", p.successes, p.trials));
  const Real n = p.trials, z2 = kZ * kZ, scale = 1 / (1 + z2 / n);
  const Real middle = scale * (p.value() + z2 / (2 * n));
  const Real half = scale * kZ * std::sqrt(p.value() * (1 - p.value()) / n + z2 / (4 * n * n));
  // The ends of the scale are exact; the formula misses them by a rounding.
  return {p.successes == 0 ? 0 : middle - half, p.successes == p.trials ? 1 : middle + half};
}

Difference newcombe(Proportion a, Proportion b) {
  const Interval of_a = wilson(a), of_b = wilson(b);
  const Real d = a.value() - b.value();
  return {d, {d - std::hypot(a.value() - of_a.low, of_b.high - b.value()), d + std::hypot(of_a.high - a.value(), b.value() - of_b.low)}};
}

std::optional<Real> Confusion::balanced_accuracy() const {
  const int successes = true_positive + false_negative, failures = true_negative + false_positive;
  if (successes == 0 || failures == 0) return std::nullopt;
  return 0.5 * (static_cast<Real>(true_positive) / successes + static_cast<Real>(true_negative) / failures);
}

Real Confusion::mcnemar() const {
  const int n = false_positive + false_negative;
  const auto log_choose = [n](int k) { return std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0); };
  Real tail = 0;
  for (int k = 0; k <= std::min(false_positive, false_negative); ++k) tail += std::exp(log_choose(k) - n * std::log(2.0));
  return std::min(1.0, 2 * tail);
}

Confusion compare(const std::vector<bool>& simulated, const std::vector<bool>& real) {
  if (simulated.size() != real.size() || real.empty())
    throw InputError(
        fmt::format("{} simulated and {} real outcomes (allowed: the same number, at least one)", simulated.size(), real.size()));
  Confusion counts;
  for (std::size_t i = 0; i < real.size(); ++i)
    ++(real[i] ? (simulated[i] ? counts.true_positive : counts.false_negative)
               : (simulated[i] ? counts.false_positive : counts.true_negative));
  return counts;
}

Interval bootstrap(int n, const std::function<Real(const std::vector<int>&)>& statistic, const BootstrapParams& params) {
  require_valid(params, "bootstrap");
  if (n <= 0) throw InputError("bootstrap: there is no episode (allowed: at least one)");
  std::mt19937_64 random(static_cast<std::uint64_t>(params.seed));
  std::vector<int> drawn(static_cast<std::size_t>(n));
  std::vector<Real> results(static_cast<std::size_t>(params.resamples));
  for (Real& result : results) {
    for (int& i : drawn) i = below(n, random);
    result = statistic(drawn);
  }
  std::sort(results.begin(), results.end());
  return {quantile(results, (1 - params.level) / 2), quantile(results, (1 + params.level) / 2)};
}

Interval bootstrap_mean(const std::vector<Real>& values, const BootstrapParams& params) {
  return bootstrap(
      static_cast<int>(values.size()),
      [&](const std::vector<int>& drawn) {
        Real sum = 0;
        for (int i : drawn) sum += values[static_cast<std::size_t>(i)];
        return sum / static_cast<Real>(drawn.size());
      },
      params);
}

Real mean(const std::vector<Real>& values) {
  if (values.empty()) throw InputError("the mean of nothing is undefined (allowed: at least one value)");
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<Real>(values.size());
}
}  // namespace tape::score
