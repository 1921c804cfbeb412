#pragma once
#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "apps/render/vertices.hpp"

/// The little of OpenGL that the renderer needs, with owners.
namespace tape::render::gl {
/// OpenGL 4.5 core context that draws into memory, four bytes a pixel, rows from top to bottom.
class Context {
 public:
  Context(int width, int height);
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  void make_current();
  const std::vector<std::uint8_t>& pixels() const { return pixels_; }

 private:
  int width_, height_;
  OSMesaContext context_;
  std::vector<std::uint8_t> pixels_;
};

/// Depth in clip coordinates runs from 0 to w instead of from -w to w.
void set_clip_depth_from_zero_to_one();

/// Vertex and fragment shader, linked. Uniforms are set by name while the program is in use.
class Program {
 public:
  Program(const std::string& vertex, const std::string& fragment);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  void use() const;
  void set(const char* name, const Eigen::Matrix4d& m) const;
  void set(const char* name, const Vec3& v) const;
  void set(const char* name, Real value) const;

 private:
  GLuint id_;
};

/// Triangles on the OpenGL side, sent again for each picture.
class Triangles {
 public:
  Triangles();
  ~Triangles();
  Triangles(const Triangles&) = delete;
  Triangles& operator=(const Triangles&) = delete;
  void upload(const std::vector<DrawVertex>& corners);
  void draw() const;

 private:
  GLuint array_ = 0, buffer_ = 0;
  int count_ = 0;
};

/// Depth seen from the light, as a texture for comparisons.
class ShadowMap {
 public:
  explicit ShadowMap(int size);
  ~ShadowMap();
  ShadowMap(const ShadowMap&) = delete;
  ShadowMap& operator=(const ShadowMap&) = delete;
  void begin() const;  ///< drawing goes into the map from here on
  void bind() const;   ///< as texture unit 0
  int size() const { return size_; }

 private:
  int size_;
  GLuint frame_ = 0, depth_ = 0;
};

/// Picture with several samples per pixel.
class SampledFrame {
 public:
  SampledFrame(int width, int height, int samples);
  ~SampledFrame();
  SampledFrame(const SampledFrame&) = delete;
  SampledFrame& operator=(const SampledFrame&) = delete;
  void begin(const Vec3& srgb_background) const;  ///< drawing goes into the frame from here on; nearer is a larger depth
  void resolve() const;                           ///< averages the samples into the memory of the context

 private:
  int width_, height_;
  GLuint frame_ = 0, color_ = 0, depth_ = 0;
};
}  // namespace tape::render::gl
