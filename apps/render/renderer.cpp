#include "apps/render/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/render/gl.hpp"
#include "apps/render/shaders.hpp"
#include "apps/render/vertices.hpp"
#include "tape/core/error.hpp"

namespace tape::render {
namespace {
constexpr int kSamples = 4, kShadowSize = 2048;
constexpr Real kGroundReach = 5;  // half width of the ground in diagonals of the scene
const Vec3 kBackground(0.90, 0.905, 0.91);

Vec3 direction(Real azimuth_deg, Real elevation_deg) {
  const Real a = azimuth_deg * std::numbers::pi / 180, e = elevation_deg * std::numbers::pi / 180;
  return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
}
const Vec3 kToKey = direction(-125, 52), kToFill = direction(10, 25);

/// Orthographic view along the key light.
struct LightView {
  Eigen::Matrix4d clip_from_world;
  Real width;  ///< [m] of the square that the shadow map covers
};

/// The view that just holds `bounds`.
LightView light_view(const Bounds& bounds, const Vec3& origin) {
  const Vec3 x = kToKey.cross(Vec3::UnitZ()).normalized(), y = kToKey.cross(x);
  Bounds box;  // in light axes
  for (int i = 0; i < 8; ++i) {
    const Vec3 p = bounds.corner(static_cast<Bounds::CornerType>(i)) - origin;
    box.extend(Vec3(x.dot(p), y.dot(p), kToKey.dot(p)));
  }
  const Vec3 size = box.sizes(), middle = box.center();
  const Real width = std::max({size.x(), size.y(), 1e-3}) * (1 + 8.0 / kShadowSize), depth = std::max(size.z(), 1e-3) * 1.02;
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();  // depth 0 at the end towards the light, 1 at the other
  m.row(0) << 2 / width * x.transpose(), -2 / width * middle.x();
  m.row(1) << 2 / width * y.transpose(), -2 / width * middle.y();
  m.row(2) << -kToKey.transpose() / depth, middle.z() / depth + 0.5;
  return {m, width};
}

Eigen::Matrix4d texture_from_clip() {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m(0, 0) = m(1, 1) = m(0, 3) = m(1, 3) = 0.5;
  return m;
}

/// Half the depth of the nearest corner of `bounds`; a thousandth of the diagonal where the camera stands among the things. [m]
Real near_plane(const Bounds& bounds, const Camera& camera) {
  Real nearest = std::numeric_limits<Real>::infinity();
  for (int i = 0; i < 8; ++i) nearest = std::min(nearest, camera.from_world(bounds.corner(static_cast<Bounds::CornerType>(i))).z());
  return std::max({nearest / 2, 1e-3 * bounds.diagonal().norm(), 1e-5});
}

void require_aspect(const Camera& camera, int width, int height) {
  if (std::abs(camera.width * height - camera.height * width) > std::max(camera.width, camera.height))
    throw InputError("render: a camera of " + std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                     " px for a picture of " + std::to_string(width) + " x " + std::to_string(height) +
                     " px; allowed is the same aspect ratio");
}
}  // namespace

struct Renderer::Impl {
  int width, height;
  gl::Context context;
  gl::Program depth{shaders::kDepthVertex, shaders::kDepthFragment}, surface{shaders::kSurfaceVertex, shaders::kSurfaceFragment},
      ground{shaders::kGroundVertex, shaders::kGroundFragment};
  gl::Triangles triangles;
  gl::ShadowMap shadow{kShadowSize};
  gl::SampledFrame frame;

  Impl(int w, int h) : width(w), height(h), context(w, h), frame(w, h, kSamples) {
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_DEPTH_CLAMP);  // the ground may come nearer than the near plane
    gl::set_clip_depth_from_zero_to_one();
  }
  ~Impl() { context.make_current(); }

  void draw_shadows(const LightView& light) const {
    shadow.begin();
    depth.use();
    depth.set("clip_from_world", light.clip_from_world);
    triangles.draw();
  }

  /// Makes `program` current and tells it what ground and surfaces share.
  void use(const gl::Program& program, const LightView& light, const Eigen::Matrix4d& clip_from_world) const {
    program.use();
    program.set("clip_from_world", clip_from_world);
    program.set("shadow_from_world", Eigen::Matrix4d(texture_from_clip() * light.clip_from_world));
    program.set("shadow_step", light.width / kShadowSize);
    program.set("to_key", kToKey);
  }

  void draw_ground(Real z, const Bounds& bounds, const Vec3& origin) const {
    const Real size = bounds.diagonal().norm(), line_step = size < 2 ? 0.01 : 0.1;
    const auto to_line = [&](Real x) { return std::remainder(-x, 10 * line_step); };
    ground.set("ground", z - origin.z());
    ground.set("reach", kGroundReach * size);
    ground.set("background", kBackground);
    ground.set("line_step", line_step);
    ground.set("line_origin", Vec3(to_line(origin.x()), to_line(origin.y()), 0));
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  }

  void draw(const RenderScene& scene, const Camera& camera) {
    const Bounds bounds = scene.bounds.value_or(bounds_of(scene.meshes));
    const Vec3 origin = bounds.center();
    Camera from_origin = camera;
    from_origin.X_WC.position -= origin;
    const Eigen::Matrix4d clip_from_world = from_origin.clip_from_world(near_plane(bounds, camera));
    const LightView light = light_view(bounds, origin);
    triangles.upload(corners_of(scene.meshes, origin));
    draw_shadows(light);
    frame.begin(kBackground);
    shadow.bind();
    use(surface, light, clip_from_world);
    surface.set("eye", from_origin.X_WC.position);
    surface.set("to_fill", kToFill);
    triangles.draw();
    if (scene.ground && camera.X_WC.position.z() > *scene.ground) {
      use(ground, light, clip_from_world);
      draw_ground(*scene.ground, bounds, origin);
    }
    frame.resolve();
  }

  Picture picture() const {
    Picture picture(width, height);
    const std::uint8_t* from = context.pixels().data();
    for (std::size_t i = 0; i < picture.rgb.size(); i += 3, from += 4) std::copy_n(from, 3, picture.rgb.data() + i);
    return picture;
  }
};

Renderer::Renderer(int width, int height) : impl_(std::make_unique<Impl>(width, height)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

Picture Renderer::draw(const RenderScene& scene, const Camera& camera) {
  require_aspect(camera, impl_->width, impl_->height);
  impl_->context.make_current();
  impl_->draw(scene, camera);
  return impl_->picture();
}
}  // namespace tape::render
