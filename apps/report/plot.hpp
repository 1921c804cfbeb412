#pragma once
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "tape/core/types.hpp"

namespace tape::report {
struct PlotPoint {
  Real x = 0, y = 0;
  std::string label;    ///< beside the point; may be empty
  bool pareto = false;  ///< marked, and joined with the other marked ones
};
/// Log-log scatter plot. Points that are not positive and finite cannot be shown and are left out.
struct Plot {
  std::string title, x_label, y_label;
  std::vector<PlotPoint> points;
};

struct CurvePoint {
  Real x = 0, y = 0;
  bool hollow = false;  ///< marked with a ring
};
struct Curve {
  std::string name;
  std::vector<CurvePoint> points;
};
/// Lines over linear axes, y from zero on. Points that are not finite are left out.
struct Curves {
  std::string title, x_label, y_label;
  std::vector<Curve> curves;
};

/// The points worth their cost: from the cheapest on, each that brings the error down by 1 % at least. Points that are not finite are
/// never among them.
std::vector<bool> pareto_front(const std::vector<Real>& cost, const std::vector<Real>& error);

/// Draws `base`.png and `base`.svg with gnuplot.
/// @throws InputError where gnuplot is missing or fails, or the folder cannot be written
void write_plot(const Plot& plot, const std::filesystem::path& base);
/// Several on one page, two in a row.  @throws InputError as write_plot
void write_page(const std::vector<std::variant<Curves, Plot>>& panels, const std::filesystem::path& base);
}  // namespace tape::report
