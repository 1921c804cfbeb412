#include "apps/render/gl.hpp"

#include <array>
#include <cstddef>

#include "tape/core/error.hpp"

namespace tape::render::gl {
namespace {
OSMesaContext create_context() {
  const std::array<int, 13> attributes{OSMESA_FORMAT,
                                       OSMESA_RGBA,
                                       OSMESA_DEPTH_BITS,
                                       0,
                                       OSMESA_STENCIL_BITS,
                                       0,
                                       OSMESA_PROFILE,
                                       OSMESA_CORE_PROFILE,
                                       OSMESA_CONTEXT_MAJOR_VERSION,
                                       4,
                                       OSMESA_CONTEXT_MINOR_VERSION,
                                       5,
                                       0};
  return OSMesaCreateContextAttribs(attributes.data(), nullptr);
}

GLuint compile(GLenum kind, const std::string& source) {
  const GLuint shader = glCreateShader(kind);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good) return shader;
  std::string log(2000, '\0');
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw CheckFailed("shader: " + log);
}
void require_complete() { TAPE_CHECK(glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE); }
}  // namespace

Context::Context(int width, int height) : width_(width), height_(height), context_(create_context()) {
  if (!context_) throw InputError("render: this OSMesa offers no OpenGL 4.5 core context; install the package libosmesa6");
  pixels_.resize(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  make_current();
}
Context::~Context() { OSMesaDestroyContext(context_); }
void Context::make_current() {
  if (!OSMesaMakeCurrent(context_, pixels_.data(), GL_UNSIGNED_BYTE, width_, height_))
    throw InputError("render: OSMesa refuses a picture of " + std::to_string(width_) + " x " + std::to_string(height_) + " px");
  OSMesaPixelStore(OSMESA_Y_UP, 0);
}

void set_clip_depth_from_zero_to_one() {
  const auto clip_control = reinterpret_cast<PFNGLCLIPCONTROLPROC>(OSMesaGetProcAddress("glClipControl"));  // not exported by name
  TAPE_CHECK(clip_control);
  clip_control(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
}

Program::Program(const std::string& vertex, const std::string& fragment) : id_(glCreateProgram()) {
  for (const GLuint shader : {compile(GL_VERTEX_SHADER, vertex), compile(GL_FRAGMENT_SHADER, fragment)}) {
    glAttachShader(id_, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(id_);
  GLint good = 0;
  glGetProgramiv(id_, GL_LINK_STATUS, &good);
  TAPE_CHECK(good);
}
Program::~Program() { glDeleteProgram(id_); }
void Program::use() const { glUseProgram(id_); }
void Program::set(const char* name, const Eigen::Matrix4d& m) const {
  const Eigen::Matrix4f f = m.cast<float>();
  glUniformMatrix4fv(glGetUniformLocation(id_, name), 1, GL_FALSE, f.data());
}
void Program::set(const char* name, const Vec3& v) const {
  glUniform3f(glGetUniformLocation(id_, name), static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()));
}
void Program::set(const char* name, Real value) const { glUniform1f(glGetUniformLocation(id_, name), static_cast<float>(value)); }

Triangles::Triangles() {
  glGenVertexArrays(1, &array_);
  glGenBuffers(1, &buffer_);
  glBindVertexArray(array_);
  glBindVertexBuffer(0, buffer_, 0, sizeof(DrawVertex));
  const auto attribute = [](GLuint location, GLint size, GLenum type, std::size_t offset) {
    glVertexAttribFormat(location, size, type, type == GL_UNSIGNED_BYTE, static_cast<GLuint>(offset));
    glVertexAttribBinding(location, 0);
    glEnableVertexAttribArray(location);
  };
  attribute(0, 3, GL_FLOAT, offsetof(DrawVertex, position));
  attribute(1, 3, GL_FLOAT, offsetof(DrawVertex, normal));
  attribute(2, 4, GL_UNSIGNED_BYTE, offsetof(DrawVertex, front));
  attribute(3, 4, GL_UNSIGNED_BYTE, offsetof(DrawVertex, back));
}
Triangles::~Triangles() {
  glDeleteBuffers(1, &buffer_);
  glDeleteVertexArrays(1, &array_);
}
void Triangles::upload(const std::vector<DrawVertex>& corners) {
  count_ = static_cast<int>(corners.size());
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners.size() * sizeof(DrawVertex)), corners.data(), GL_STREAM_DRAW);
}
void Triangles::draw() const {
  glBindVertexArray(array_);
  glDrawArrays(GL_TRIANGLES, 0, count_);
}

ShadowMap::ShadowMap(int size) : size_(size) {
  glGenTextures(1, &depth_);
  bind();
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, size, size, 0, GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
  const std::array<float, 4> lit{1, 1, 1, 1};
  glTexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, lit.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glGenFramebuffers(1, &frame_);
  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth_, 0);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
  require_complete();
}
ShadowMap::~ShadowMap() {
  glDeleteFramebuffers(1, &frame_);
  glDeleteTextures(1, &depth_);
}
void ShadowMap::begin() const {
  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  glViewport(0, 0, size_, size_);
  glClearDepth(1);
  glDepthFunc(GL_LESS);
  glClear(GL_DEPTH_BUFFER_BIT);
}
void ShadowMap::bind() const {
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, depth_);
}

SampledFrame::SampledFrame(int width, int height, int samples) : width_(width), height_(height) {
  glGenRenderbuffers(1, &color_);
  glBindRenderbuffer(GL_RENDERBUFFER, color_);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_RGBA8, width, height);
  glGenRenderbuffers(1, &depth_);
  glBindRenderbuffer(GL_RENDERBUFFER, depth_);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_DEPTH_COMPONENT32F, width, height);
  glGenFramebuffers(1, &frame_);
  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
  require_complete();
}
SampledFrame::~SampledFrame() {
  glDeleteFramebuffers(1, &frame_);
  glDeleteRenderbuffers(1, &color_);
  glDeleteRenderbuffers(1, &depth_);
}
void SampledFrame::begin(const Vec3& c) const {
  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  glViewport(0, 0, width_, height_);
  glClearColor(static_cast<float>(c.x()), static_cast<float>(c.y()), static_cast<float>(c.z()), 1);
  glClearDepth(0);
  glDepthFunc(GL_GREATER);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}
void SampledFrame::resolve() const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, frame_);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glFinish();
}
}  // namespace tape::render::gl
