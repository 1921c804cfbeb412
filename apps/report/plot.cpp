#include "apps/report/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "apps/video/process.hpp"
#include "cosim/run/new_file.hpp"
#include "tape/core/settings.hpp"

namespace tape::report {
namespace {
/// Text inside single quotes of a gnuplot script, where only the quote itself is special (with `noenhanced`).
std::string quoted(std::string text) {
  for (std::size_t at = 0; (at = text.find('\'', at)) != std::string::npos; at += 2) text.insert(at, 1, '\'');
  std::replace(text.begin(), text.end(), '\n', ' ');
  return '\'' + text + '\'';
}
/// Text of a data block, whose columns are separated by spaces.
std::string cell(std::string text) {
  std::replace(text.begin(), text.end(), '"', '\'');
  std::replace(text.begin(), text.end(), '\n', ' ');
  return '"' + text + '"';
}

bool can_show(const PlotPoint& p) { return std::isfinite(p.x) && std::isfinite(p.y) && p.x > 0 && p.y > 0; }

std::string data_block(const std::string& name, std::vector<PlotPoint> points) {
  std::sort(points.begin(), points.end(), [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
  std::string text = "$" + name + " << EOD\n";
  for (const PlotPoint& p : points) text += tape::to_text(p.x) + ' ' + tape::to_text(p.y) + ' ' + cell(p.label) + '\n';
  return text + "EOD\n";
}

/// Range of a logarithmic axis: that of the values, and room on both sides.
std::string range(const std::vector<PlotPoint>& points, Real PlotPoint::*axis, Real below, Real above) {
  const auto less = [&](const PlotPoint& a, const PlotPoint& b) { return a.*axis < b.*axis; };
  const auto [low, high] = std::minmax_element(points.begin(), points.end(), less);
  return " [" + tape::to_text((*low).*axis / below) + ':' + tape::to_text((*high).*axis * above) + "]\n";
}

std::string axes(const std::string& title, const std::string& x_label, const std::string& y_label) {
  return "set title " + quoted(title) + " noenhanced\nset xlabel " + quoted(x_label) + " noenhanced\nset ylabel " + quoted(y_label) +
         " noenhanced\nset grid\nset key top right\n";
}

std::string panel(const Plot& plot) {
  std::vector<PlotPoint> all, front, others;
  for (const PlotPoint& p : plot.points)
    if (can_show(p)) {
      all.push_back(p);
      (p.pareto ? front : others).push_back(p);
    }
  if (all.empty()) throw InputError("plot \"" + plot.title + "\": no point is positive and finite");
  std::string text = axes(plot.title, plot.x_label, plot.y_label) + "set logscale xy\nset format '%g'\n";
  text += "set xrange" + range(all, &PlotPoint::x, 2, 10) + "set yrange" + range(all, &PlotPoint::y, 2, 2);
  text += data_block("all", all) + data_block("front", front) + data_block("others", others);
  text += "plot $all using 1:2 with points pointtype 7 pointsize 0.8 linecolor rgb '#7a8ba8' title 'runs'";
  if (!front.empty())
    text += ", $front using 1:2 with linespoints pointtype 6 pointsize 1.8 linewidth 2 linecolor rgb '#c1440e' title 'Pareto front'";
  // numbers below their points, the longer labels of the front above and to the right of theirs
  if (!others.empty()) text += ", $others using 1:2:3 with labels center offset 0,-0.8 font ',9' noenhanced notitle";
  if (!front.empty()) text += ", $front using 1:2:3 with labels left offset 0.6,0.7 font ',9' noenhanced notitle";
  return text + '\n';
}

std::string panel(const Curves& curves) {
  std::string blocks, lines;
  int k = 0;
  for (const Curve& curve : curves.curves) {
    std::string full, hollow;
    for (const CurvePoint& p : curve.points)
      if (std::isfinite(p.x) && std::isfinite(p.y)) (p.hollow ? hollow : full) += tape::to_text(p.x) + ' ' + tape::to_text(p.y) + '\n';
    if (full.empty() && hollow.empty()) continue;
    const std::string name = std::to_string(++k), style = " linecolor " + name;
    blocks += "$all" + name + " << EOD\n" + full + hollow + "EOD\n$hollow" + name + " << EOD\n" + hollow + "EOD\n";
    lines += std::string(k == 1 ? "plot " : ", ") + "$all" + name + " using 1:2 smooth unique with lines linewidth 1.5" + style +
             " title " + quoted(curve.name);
    if (!hollow.empty()) lines += ", $hollow" + name + " using 1:2 with points pointtype 6 pointsize 0.5" + style + " notitle";
  }
  if (k == 0) throw InputError("plot \"" + curves.title + "\": no point is finite");
  return axes(curves.title, curves.x_label, curves.y_label) + "set yrange [0:*]\n" + blocks + lines + '\n';
}

void run_gnuplot(const std::string& text) {
  video::Process gnuplot({"gnuplot", "-"});
  const bool sent = gnuplot.send(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
  const bool done = gnuplot.wait();
  if (!sent || !done) throw InputError("gnuplot failed: " + gnuplot.messages());
}

void draw(const std::string& text, int width, int height, const std::filesystem::path& base) {
  const std::string style = fmt::format(" size {},{} font 'DejaVu Sans,12' background 'white'", width, height);
  for (const auto& [extension, terminal] : {std::pair{".png", "pngcairo"}, std::pair{".svg", "svg"}}) {
    std::filesystem::path name = base;
    name += extension;
    cosim::NewFile file(name);
    run_gnuplot("set terminal " + (terminal + style) + "\nset output " + quoted(file.temporary().string()) + '\n' + text);
    file.commit();
  }
}
}  // namespace

std::vector<bool> pareto_front(const std::vector<Real>& cost, const std::vector<Real>& error) {
  TAPE_CHECK(cost.size() == error.size());
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < cost.size(); ++i)
    if (std::isfinite(cost[i]) && std::isfinite(error[i])) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return std::pair(cost[a], error[a]) < std::pair(cost[b], error[b]); });
  std::vector<bool> front(cost.size());
  Real best = std::numeric_limits<Real>::infinity();
  for (std::size_t i : order) {
    if (!(error[i] < 0.99 * best)) continue;
    front[i] = true;
    best = error[i];
  }
  return front;
}

void write_plot(const Plot& plot, const std::filesystem::path& base) { draw(panel(plot), 1200, 800, base); }

void write_page(const std::vector<std::variant<Curves, Plot>>& panels, const std::filesystem::path& base) {
  const auto rows = static_cast<int>(panels.size() + 1) / 2;
  std::string text = "set multiplot layout " + std::to_string(rows) + ",2\n";
  for (const auto& one : panels) text += "reset\n" + std::visit([](const auto& p) { return panel(p); }, one);
  draw(text + "unset multiplot\n", 1600, 500 * rows, base);
}
}  // namespace tape::report
