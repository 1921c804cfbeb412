#include "tape/cutting/blade_line.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tape/math/plane.hpp"

namespace tape {
Line simplified(const Line& line, Real tolerance) {
  std::vector<char> kept(line.size(), 0);
  kept.front() = kept.back() = 1;
  std::vector<std::pair<std::size_t, std::size_t>> pending{{0, line.size() - 1}};
  while (!pending.empty()) {
    const auto [first, last] = pending.back();
    pending.pop_back();
    std::size_t farthest = first;
    Real distance = tolerance;
    for (std::size_t i = first + 1; i < last; ++i)
      if (const Real d = distance_to_segment(line[i], line[first], line[last]); d > distance) distance = d, farthest = i;
    if (farthest == first) continue;
    kept[farthest] = 1;
    pending.push_back({first, farthest});
    pending.push_back({farthest, last});
  }
  Line out;
  for (std::size_t i = 0; i < line.size(); ++i)
    if (kept[i]) out.push_back(line[i]);
  return out;
}

Line averaged(const Line& line, Real window) {
  constexpr Real kSamples = 8, kMost = 2000;  // to a window, altogether
  std::vector<Real> length{0};
  Line integral{Vec2::Zero()};  // of the position over the arc length, up to each corner
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Real piece = (line[i + 1] - line[i]).norm();
    length.push_back(length.back() + piece);
    integral.push_back(integral.back() + piece * (line[i] + line[i + 1]) / 2);
  }
  const auto integral_to = [&](Real s) -> Vec2 {
    const auto next = std::upper_bound(length.begin() + 1, length.end() - 1, s);
    const std::size_t i = static_cast<std::size_t>(next - length.begin()) - 1;
    const Real piece = length[i + 1] - length[i], at = piece > 0 ? (s - length[i]) / piece : 0;
    return integral[i] + (s - length[i]) * (line[i] + at / 2 * (line[i + 1] - line[i]));
  };
  const int samples = static_cast<int>(std::clamp(std::ceil(kSamples * length.back() / window), 2.0, kMost));
  Line out{line.front()};
  for (int k = 1; k < samples; ++k) {
    const Real s = length.back() * k / samples, half = std::min({window / 2, s, length.back() - s});
    out.push_back((integral_to(s + half) - integral_to(s - half)) / (2 * half));
  }
  out.push_back(line.back());
  return out;
}

Real distance_to_line(const Vec2& p, const Line& line) {
  Real distance = (p - line.front()).norm();
  for (std::size_t i = 0; i + 1 < line.size(); ++i) distance = std::min(distance, distance_to_segment(p, line[i], line[i + 1]));
  return distance;
}

Real deviation(const Line& line, const Line& other) {
  Real largest = 0;
  for (const Vec2& p : line) largest = std::max(largest, distance_to_line(p, other));
  return largest;
}
}  // namespace tape
