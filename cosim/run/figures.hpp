#pragma once
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cosim/run/run_log.hpp"

namespace cosim {
/// Numbers that a figure adds to the report: key with unit, and value.
using FigureValues = std::vector<std::pair<std::string, Real>>;

/// A measurement that a scene may ask for by name in `record.figures`.
struct Figure {
  std::string_view name, meaning;
  FigureValues (*measure)(const World& world, const RunLog& log);
};
/// All of them. Adding one: a function in figures.cpp and its line in the list.
std::span<const Figure> all_figures();

/// What the scene lacks for a figure; empty if nothing.
std::string why_unfit(std::string_view name, const World& world);
/// @throws InputError naming the figure that there is not, or that the scene has nothing to measure on
void require_figures(const std::vector<std::string>& names, const World& world);
FigureValues measure_figures(const std::vector<std::string>& names, const World& world, const RunLog& log);

/// Positions [m] on the middle line of the first strip at n equally spaced places of its rest length, start to tip. They
/// compare states on different meshes.
std::vector<Vec3> middle_line(const World& world, const State& state, int n);
}  // namespace cosim
