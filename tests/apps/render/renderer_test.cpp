#include "apps/render/renderer.hpp"

#include <gtest/gtest.h>

#include "tape/core/error.hpp"
#include "tape/math/rotation.hpp"
using namespace tape;
using namespace tape::render;

namespace {
constexpr int kWidth = 320, kHeight = 240;
const Vec3 kRed(0.8, 0.1, 0.1), kBlue(0.1, 0.1, 0.8);

/// Square of n x n cells, side [m], in the plane of x and y of the pose.
Mesh square(const Pose& pose, Real side, const Vec3& color, int n = 1) {
  Mesh m{.colors{color}, .gloss = 0};
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) m.vertices.push_back(apply(pose, Vec3(i - 0.5 * n, j - 0.5 * n, 0) * side / n));
  for (int j = 0; j < n; ++j)
    for (int i = 0, a = j * (n + 1); i < n; ++i, ++a) {
      m.triangles.push_back({a, a + 1, a + n + 2});
      m.triangles.push_back({a, a + n + 2, a + n + 1});
    }
  return m;
}
Mesh square_at(const Vec3& p, Real side, const Vec3& color) { return square({.position = p}, side, color); }

/// Camera above the origin at a distance, turned away from the vertical by about 50 degrees.
Camera camera_at(Real distance) {
  return Camera::make(LookAtSettings{.eye = distance * Vec3(0.3, -0.7, 0.64), .fov = 30}, kWidth, kHeight);
}
std::uint8_t* pixel(Picture& picture, const Camera& camera, const Vec3& p_W) {
  const Vec2 at = camera.project(p_W);
  return picture.at(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
}
}  // namespace

TEST(Renderer, DrawsEqualBytesFromEqualInput) {
  RenderScene scene{.meshes{square({rotation_exp({0.4, 0.2, 0}), Vec3(0, 0, 0.05)}, 0.1, kRed, 20)}, .ground = 0};
  Renderer first(kWidth, kHeight);
  const Picture once = first.draw(scene, camera_at(0.5));
  first.draw({.meshes{square_at(Vec3::Zero(), 1, kBlue)}}, camera_at(0.3));
  Renderer second(kWidth, kHeight);
  EXPECT_EQ(once.rgb, first.draw(scene, camera_at(0.5)).rgb);
  EXPECT_EQ(once.rgb, second.draw(scene, camera_at(0.5)).rgb);
}

TEST(Renderer, ASheetATenthOfAMillimetreAboveAnotherHidesIt) {
  Renderer renderer(kWidth, kHeight);
  for (Real size : {0.05, 0.5, 3.0}) {
    const Camera camera = camera_at(2.5 * size);
    Picture picture = renderer.draw(
        {.meshes{square_at(Vec3::Zero(), size, kBlue), square_at(Vec3(0, 0, 1e-4), 0.8 * size, kRed)}, .ground = -1e-4}, camera);
    for (int i = -15; i <= 15; ++i)
      for (int j = -15; j <= 15; ++j) {
        const std::uint8_t* rgb = pixel(picture, camera, Vec3(i, j, 0) * size * 0.38 / 15);
        EXPECT_GT(rgb[0], rgb[2]) << "scene of " << size << " m, at " << i << " " << j;
      }
  }
}

TEST(Renderer, APlaneDoesNotShadowItself) {
  Renderer renderer(kWidth, kHeight);
  for (Real size : {0.05, 3.0})
    for (Real tilt : {-0.7, 0.0, 0.7}) {
      const Camera camera = camera_at(2.5 * size);
      const Pose pose{rotation_exp({0, tilt, 0}), Vec3::Zero()};
      Picture picture = renderer.draw({.meshes{square(pose, size, kRed, 8)}}, camera);
      const int expected = pixel(picture, camera, Vec3::Zero())[0];
      for (int i = -15; i <= 15; ++i)
        for (int j = -15; j <= 15; ++j)
          EXPECT_NEAR(pixel(picture, camera, apply(pose, Vec3(i, j, 0) * size * 0.46 / 15))[0], expected, 1) << size << " m, tilt " << tilt;
    }
}

TEST(Renderer, AThingAboveTheGroundCastsAShadowAwayFromTheKeyLight) {
  Renderer renderer(kWidth, kHeight);
  const Camera camera = camera_at(1);
  Picture picture = renderer.draw({.meshes{square_at(Vec3(0, 0, 0.1), 0.06, kRed)}, .ground = 0}, camera);
  // the light stands 52 degrees high at azimuth -125 degrees: the shadow lies 0.1 m / tan 52 further, at azimuth 55
  const Vec3 shadow(0.0448, 0.0640, 0);
  const int dark = pixel(picture, camera, shadow)[1], lit = pixel(picture, camera, -shadow)[1];
  EXPECT_LT(dark, 0.75 * lit);
  EXPECT_GT(lit, 180);
}

TEST(Renderer, AFilmShowsItsBackColourFromBehind) {
  Renderer renderer(kWidth, kHeight);
  Mesh film = square_at(Vec3::Zero(), 0.1, kRed);
  film.back_color = kBlue;
  const LookAtSettings above{.eye{0, -0.1, 0.3}}, below{.eye{0, -0.1, -0.3}};
  const auto middle = [&](const LookAtSettings& view) {
    const Camera camera = Camera::make(view, kWidth, kHeight);
    Picture picture = renderer.draw({.meshes{film}, .ground = -0.1}, camera);
    const std::uint8_t* rgb = pixel(picture, camera, Vec3::Zero());
    return Vec3(rgb[0], rgb[1], rgb[2]);
  };
  EXPECT_GT(middle(above).x(), 3 * middle(above).z());
  EXPECT_GT(middle(below).z(), 3 * middle(below).x());
}

TEST(Renderer, AnEdgeSharperThanTheCreaseLooksSharp) {
  Renderer renderer(kWidth, kHeight);
  Mesh roof{.vertices{{-0.1, -0.1, 0}, {0, -0.1, 0.1}, {0.1, -0.1, 0}, {-0.1, 0.1, 0}, {0, 0.1, 0.1}, {0.1, 0.1, 0}},
            .triangles{{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}},
            .colors{kRed},
            .gloss = 0};
  const auto jump_at_the_ridge = [&](Real crease) {
    roof.crease = crease;
    const Camera camera = camera_at(0.8);
    Picture picture = renderer.draw({.meshes{roof}}, camera);
    return std::abs(pixel(picture, camera, {-0.006, 0, 0.094})[0] - pixel(picture, camera, {0.006, 0, 0.094})[0]);
  };
  EXPECT_GT(jump_at_the_ridge(35), 15);  // the faces are at right angles and the light comes from the left
  EXPECT_LT(jump_at_the_ridge(120), 5);
}

TEST(Renderer, ColoursThatDoNotFitAndOtherAspectRatiosAreRefused) {
  Renderer renderer(kWidth, kHeight);
  Mesh mesh = square_at(Vec3::Zero(), 0.1, kRed);
  EXPECT_THROW(renderer.draw({.meshes{mesh}}, Camera::make(LookAtSettings{}, 640, 360)), InputError);
  mesh.colors.push_back(kBlue);
  EXPECT_THROW(renderer.draw({.meshes{mesh}}, camera_at(1)), InputError);
}

TEST(Renderer, AnEmptySceneIsAnEmptyPicture) {
  Renderer renderer(kWidth, kHeight);
  const Picture picture = renderer.draw({}, camera_at(1));
  for (std::size_t i = 3; i < picture.rgb.size(); ++i) ASSERT_EQ(picture.rgb[i], picture.rgb[i % 3]);
}
