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

std::string script(const Plot& plot, const std::string& terminal, const std::string& output) {
  std::vector<PlotPoint> all, front, others;
  for (const PlotPoint& p : plot.points)
    if (can_show(p)) {
      all.push_back(p);
      (p.pareto ? front : others).push_back(p);
    }
  if (all.empty()) throw InputError("plot \"" + plot.title + "\": no point is positive and finite");
  std::string text = "set terminal " + terminal + "\nset output " + quoted(output) + '\n';
  text += "set title " + quoted(plot.title) + " noenhanced\nset xlabel " + quoted(plot.x_label) + " noenhanced\n";
  text += "set ylabel " + quoted(plot.y_label) + " noenhanced\nset logscale xy\nset format '%g'\nset grid\nset key top right\n";
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

void run_gnuplot(const std::string& text) {
  video::Process gnuplot({"gnuplot", "-"});
  const bool sent = gnuplot.send(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
  const bool done = gnuplot.wait();
  if (!sent || !done) throw InputError("gnuplot failed: " + gnuplot.messages());
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

void write_plot(const Plot& plot, const std::filesystem::path& base) {
  struct Format {
    const char *extension, *terminal;
  };
  for (const auto& [extension, terminal] : {Format{".png", "pngcairo size 1200,800 font 'DejaVu Sans,12' background 'white'"},
                                            Format{".svg", "svg size 1200,800 font 'DejaVu Sans,12' background 'white'"}}) {
    std::filesystem::path name = base;
    name += extension;
    cosim::NewFile file(name);
    run_gnuplot(script(plot, terminal, file.temporary().string()));
    file.commit();
  }
}
}  // namespace tape::report
