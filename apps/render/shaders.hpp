#pragma once
#include <string>

/// GLSL sources. Positions are in metres from the middle of the scene; colours are mixed in linear light and written as sRGB.
namespace tape::render::shaders {
inline const std::string kHead = R"(#version 450 core
vec3 from_srgb(vec3 c) { return pow(c, vec3(2.2)); }
vec3 to_srgb(vec3 c) { return pow(clamp(c, 0.0, 1.0), vec3(1.0 / 2.2)); }
)";

inline const std::string kShadow = R"(
uniform sampler2DShadow shadow_map;
uniform mat4 shadow_from_world;
uniform vec3 to_key;        // towards the key light, unit length
uniform float shadow_step;  // [m] size of a texel of the shadow map
// Share of the key light that reaches p. The filter spans two texels to each side, so p is lifted by as much along its normal:
// a plane then never shadows itself, at any slope and any size of the scene.
float lit(vec3 p, vec3 n) {
  vec3 q = (shadow_from_world * vec4(p + shadow_step * (2.2 * n + 0.5 * to_key), 1)).xyz;
  if (any(greaterThan(abs(q.xy - 0.5), vec2(0.5)))) return 1.0;  // all that casts shadows lies inside
  q.z = min(q.z, 1.0);
  float texel = 1.0 / textureSize(shadow_map, 0).x, sum = 0.0;
  for (int i = 0; i < 4; ++i) sum += texture(shadow_map, vec3(q.xy + texel * (vec2(i & 1, i >> 1) * 2.0 - 1.0), q.z));
  return 0.25 * sum;
}
)";

inline const std::string kDepthVertex = kHead + R"(
layout(location = 0) in vec3 position;
uniform mat4 clip_from_world;
void main() { gl_Position = clip_from_world * vec4(position, 1); }
)";
inline const std::string kDepthFragment = kHead + "void main() {}\n";

inline const std::string kSurfaceVertex = kHead + R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 front;
layout(location = 3) in vec4 back;
uniform mat4 clip_from_world;
out vec3 at, n_in, front_color, back_color;
out float gloss;
void main() {
  gl_Position = clip_from_world * vec4(position, 1);
  at = position;
  n_in = normal;
  front_color = from_srgb(front.rgb);
  back_color = from_srgb(back.rgb);
  gloss = front.a;
}
)";

inline const std::string kSurfaceFragment = kHead + kShadow + R"(
in vec3 at, n_in, front_color, back_color;
in float gloss;
uniform vec3 eye, to_fill;
out vec4 color;
void main() {
  vec3 n = normalize(gl_FrontFacing ? n_in : -n_in);
  vec3 albedo = gl_FrontFacing ? front_color : back_color;
  float facing = dot(n, to_key);
  float key = 0.0, highlight = 0.0;
  if (facing > 0.0) {
    float reach = lit(at, n);
    key = reach * facing;
    vec3 middle = normalize(to_key + normalize(eye - at));
    highlight = reach * gloss * pow(max(dot(n, middle), 0.0), 48.0);
  }
  float fill = max(dot(n, to_fill), 0.0);
  vec3 sky = mix(vec3(0.20, 0.19, 0.18), vec3(0.40, 0.42, 0.45), 0.5 + 0.5 * n.z);
  color = vec4(to_srgb(albedo * (sky + 0.68 * key * vec3(1.0, 0.98, 0.94) + 0.14 * fill) + 0.5 * highlight), 1);
}
)";

inline const std::string kGroundVertex = kHead + R"(
uniform mat4 clip_from_world;
uniform float ground, reach;  // [m] height, half width
out vec3 at;
void main() {
  at = vec3(reach * (vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0), ground);
  gl_Position = clip_from_world * vec4(at, 1);
}
)";

/// The ground has the colour of the background, so that it has no visible border; shadows and lines stand out from it.
inline const std::string kGroundFragment = kHead + kShadow + R"(
in vec3 at;
uniform vec3 background, line_origin;
uniform float line_step, reach;  // [m] between fine lines; every tenth is strong
out vec4 color;
// Share of the pixel covered by lines of 1.2 px; fades out where lines come closer than a few pixels.
float lines(vec2 p, float step_m) {
  vec2 t = p / step_m, width = fwidth(t);
  vec2 distance_px = abs(fract(t - 0.5) - 0.5) / width;
  vec2 cover = clamp(1.1 - distance_px, 0.0, 1.0) * (1.0 - smoothstep(0.08, 0.30, width));
  return max(cover.x, cover.y);
}
void main() {
  float fade = 1.0 - smoothstep(0.35, 0.95, length(at.xy) / reach);
  vec2 p = at.xy - line_origin.xy;
  float ink = fade * max(0.07 * lines(p, line_step), 0.17 * lines(p, 10.0 * line_step));
  float shade = 0.42 * (1.0 - lit(at, vec3(0, 0, 1)));
  color = vec4(background * (1.0 - ink) * (1.0 - shade), 1);
}
)";
}  // namespace tape::render::shaders
