#include "apps/score/overlay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace tape::score {
namespace {
constexpr int kShift = 6;  // OpenCV draws at 1/64 px

/// A picture as OpenCV sees it: the same memory.
cv::Mat matrix(render::Picture& picture) { return {picture.height, picture.width, CV_8UC3, picture.rgb.data()}; }
cv::Mat matrix(const render::Picture& picture) { return matrix(const_cast<render::Picture&>(picture)); }

cv::Scalar scalar(const std::array<std::uint8_t, 3>& color) { return {double(color[0]), double(color[1]), double(color[2])}; }
cv::Point fine(const Vec2& pixel) { return {cvRound(pixel.x() * (1 << kShift)), cvRound(pixel.y() * (1 << kShift))}; }
void line(render::Picture& picture, const Vec2& a, const Vec2& b, const std::array<std::uint8_t, 3>& color) {
  cv::line(matrix(picture), fine(a), fine(b), scalar(color), 1, cv::LINE_AA, kShift);
}
}  // namespace

render::Picture read_photograph(const std::filesystem::path& file, const cosim::Calibration& calibration) {
  const cv::Mat read = cv::imread(file.string(), cv::IMREAD_COLOR);
  if (read.empty()) throw InputError(file.string() + ": cannot be read as a picture");
  cosim::require_resolution(calibration, read.cols, read.rows, "the camera", file.string());
  render::Picture picture(read.cols, read.rows);
  cv::cvtColor(read, matrix(picture), cv::COLOR_BGR2RGB);
  return picture;
}

render::Picture undistorted(const render::Picture& photograph, const cosim::Calibration& calibration) {
  cosim::require_resolution(calibration, photograph.width, photograph.height, "the camera", "the photograph");
  cv::Mat u(photograph.height, photograph.width, CV_32F), v = u.clone();
  for (int y = 0; y < photograph.height; ++y)
    for (int x = 0; x < photograph.width; ++x) {
      const Vec2 ideal = calibration.normalized(Vec2(x, y));
      const bool seen = !cosim::folds_before(calibration.lens, ideal);
      const Vec2 source = seen ? calibration.pixel(cosim::distort(calibration.lens, ideal)) : Vec2(-2, -2);
      u.at<float>(y, x) = static_cast<float>(source.x());
      v.at<float>(y, x) = static_cast<float>(source.y());
    }
  render::Picture picture(photograph.width, photograph.height);
  cv::remap(matrix(photograph), matrix(picture), u, v, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  return picture;
}

render::Picture blended(const render::Picture& real, const render::Picture& simulated, Real share) {
  if (real.width != simulated.width || real.height != simulated.height)
    throw InputError(fmt::format("the real picture has {} x {} px, the simulated one {} x {} px (allowed: the same)", real.width,
                                 real.height, simulated.width, simulated.height));
  render::Picture picture(real.width, real.height);
  cv::addWeighted(matrix(real), 1 - share, matrix(simulated), share, 0, matrix(picture));
  return picture;
}

render::Picture tiled(const std::vector<render::Picture>& pictures, int columns, int width) {
  TAPE_CHECK(!pictures.empty() && columns > 0);
  const int w = std::min(pictures[0].width, width / columns) / 2 * 2;
  const int h = static_cast<int>(std::lround(Real(w) * pictures[0].height / pictures[0].width)) / 2 * 2;
  const int rows = (static_cast<int>(pictures.size()) + columns - 1) / columns;
  render::Picture whole(columns * w, rows * h);
  std::ranges::fill(whole.rgb, std::uint8_t{255});
  for (int i = 0; const render::Picture& picture : pictures) {
    render::Picture tile(w, h);
    cv::resize(matrix(picture), matrix(tile), {w, h}, 0, 0, cv::INTER_AREA);
    paste(whole, tile, i % columns * w, i / columns * h);
    ++i;
  }
  return whole;
}

void draw_landmarks(render::Picture& picture, const FrameError& frame) {
  constexpr int kRadius = 7;  // [px]
  constexpr Real kArm = 6;    // [px]
  const double end = frame.estimated ? 270 : 360;
  cv::ellipse(matrix(picture), fine(frame.real), {kRadius << kShift, kRadius << kShift}, 0, 0, end, scalar(kRealColor), 2, cv::LINE_AA,
              kShift);
  if (!frame.in_front) return;
  line(picture, frame.real, frame.simulated, kSimulatedColor);
  for (const Vec2& arm : {Vec2(kArm, 0), Vec2(0, kArm)}) line(picture, frame.simulated - arm, frame.simulated + arm, kSimulatedColor);
}

void draw_rim(render::Picture& picture, const render::Camera& camera, const Hub& hub) {
  const std::vector<Vec2> outline = rim_outline(camera, hub);
  for (std::size_t i = 0; i < outline.size(); ++i) line(picture, outline[i], outline[(i + 1) % outline.size()], kSimulatedColor);
}
}  // namespace tape::score
