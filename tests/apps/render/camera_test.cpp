#include "apps/render/camera.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "apps/render/renderer.hpp"
using namespace tape;
using namespace tape::render;

namespace {
const LookAtSettings kLookAt{.eye{0.4, -0.5, 0.3}, .target{0.02, 0.01, -0.03}, .fov = 40};
const PinholeSettings kOffCentre{.calibration{.fx = 500, .fy = 520, .cx = 250.3, .cy = 90.7, .width = 400, .height = 300},
                                 .position{0.1, 0.2, 0.9},
                                 .rotation{2.8, 0.3, -0.4}};

/// Square of half width r [m] about p that faces the camera.
Mesh marker(const Camera& camera, const Vec3& p, Real r) {
  const Vec3 x = r * camera.X_WC.rotation.col(0), y = r * camera.X_WC.rotation.col(1);
  return {.vertices{p - x - y, p + x - y, p + x + y, p - x + y}, .triangles{{0, 2, 1}, {0, 3, 2}}, .colors{Vec3(1, 0, 0)}, .gloss = 0};
}

/// Centre of the red pixels, weighted with their redness.
Vec2 red_centre(const Picture& picture) {
  Vec2 sum = Vec2::Zero();
  Real weight = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      if (const Real red = picture.at(x, y)[0] - picture.at(x, y)[1]; red > 10) sum += red * Vec2(x, y), weight += red;
  return sum / weight;
}

void expect_drawn_where_the_formula_says(const Camera& camera, Renderer& renderer, int width, int height) {
  for (const Vec2& pixel : {Vec2(30, 40), Vec2(200, 150), Vec2(371.5, 20.25), Vec2(60, 280)}) {
    const Real depth = 0.6;
    const Vec3 p_C((pixel.x() - camera.cx) / camera.fx * depth, (pixel.y() - camera.cy) / camera.fy * depth, depth);
    const Vec3 p_W = apply(camera.X_WC, p_C);
    EXPECT_LT((camera.project(p_W) - pixel).norm(), 1e-9);
    const Picture picture = renderer.draw({.meshes{marker(camera, p_W, 0.006)}}, camera);
    const Vec2 seen = red_centre(picture);  // pixel borders lie at half-integers, in the calibrated picture and in the drawn one
    const Vec2 expected((pixel.x() + 0.5) * width / camera.width - 0.5, (pixel.y() + 0.5) * height / camera.height - 0.5);
    EXPECT_LT((seen - expected).norm(), 0.3) << seen.transpose() << " instead of " << expected.transpose();
  }
}
}  // namespace

TEST(Camera, APointLandsOnThePixelThatTheFormulaSays) {
  Renderer renderer(400, 300);
  expect_drawn_where_the_formula_says(Camera::make(kLookAt, 400, 300), renderer, 400, 300);
  expect_drawn_where_the_formula_says(Camera::make(kOffCentre), renderer, 400, 300);
}

TEST(Camera, ACalibratedCameraMayBeDrawnInAnotherResolution) {
  Renderer renderer(800, 600);
  expect_drawn_where_the_formula_says(Camera::make(kOffCentre), renderer, 800, 600);
}

TEST(Camera, AnUnturnedPinholeLooksAlongZWithYDown) {
  const Camera camera = Camera::make(PinholeSettings{.calibration{.fx = 600, .fy = 500, .cx = 420, .cy = 230}});
  const Vec2 pixel = camera.project({0.2, 0.1, 2});  // 600 * 0.1 + 420, 500 * 0.05 + 230
  EXPECT_NEAR(pixel.x(), 480, 1e-9);
  EXPECT_NEAR(pixel.y(), 255, 1e-9);
}

TEST(Camera, LookAtShowsTheTargetInTheMiddleAndTheFieldOfViewFromEdgeToEdge) {
  const Camera camera = Camera::make(kLookAt, 400, 300);
  EXPECT_LT((camera.project(kLookAt.target) - Vec2(199.5, 149.5)).norm(), 1e-9);
  const Vec3 top = apply(camera.X_WC, {0, -std::tan(20 * std::numbers::pi / 180), 1});
  EXPECT_NEAR(camera.project(top).y(), -0.5, 1e-9);
  EXPECT_LT(camera.project(kLookAt.target + Vec3(0, 0, 0.01)).y(), 149.5) << "up is up";
}

TEST(Camera, TheOverviewHoldsTheWholeBoxAndUsesThePicture) {
  for (const Vec3& size : {Vec3(0.05, 0.05, 0.05), Vec3(3, 0.1, 0.02), Vec3(0.1, 0.2, 2)}) {
    const Bounds bounds(Vec3(0.3, -0.2, 0.1), Vec3(0.3, -0.2, 0.1) + size);
    const Camera camera = Camera::make(overview(bounds, 960, 540), 960, 540);
    Real reach = 0;  // largest distance from the middle, 1 at the border
    for (int i = 0; i < 8; ++i) {
      const Vec2 pixel = camera.project(bounds.corner(static_cast<Bounds::CornerType>(i)));
      reach = std::max({reach, std::abs(pixel.x() - 479.5) / 480, std::abs(pixel.y() - 269.5) / 270});
    }
    EXPECT_LT(reach, 0.95);
    EXPECT_GT(reach, 0.8);
  }
}

TEST(Camera, SettingsThatSpanNoViewAreRefused) {
  EXPECT_THROW(Camera::make(LookAtSettings{.eye{0, 0, 1}, .target{0, 0, 0}, .up{0, 0, 1}}, 100, 100), InputError);
  EXPECT_THROW(Camera::make(LookAtSettings{.eye{0, 0, 1}, .target{0, 0, 1}}, 100, 100), InputError);
  EXPECT_THROW(Camera::make(LookAtSettings{.fov = 180}, 100, 100), SettingsError);
  EXPECT_THROW(Camera::make(PinholeSettings{.calibration{.fx = 0}}), SettingsError);
}
