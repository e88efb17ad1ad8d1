// The programs that draw a scene, in GLSL 3.30. Colours come in as sRGB; light is added up in
// linear values.
#pragma once

namespace sinew::render {

// size scales a unit shape (triangles.h); shadow_from_world is the identity for solids. A normal
// of a scaled shape is divided by the scale.
inline constexpr const char* kSolidVertexShader = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 clip_from_world, world_from_visual, shadow_from_world;
uniform vec3 size;
out vec3 normal_world;
out vec3 point_world;
void main() {
  vec4 point = shadow_from_world * world_from_visual * vec4(size * position, 1.0);
  point_world = point.xyz;
  normal_world = mat3(world_from_visual) * (normal / size);
  gl_Position = clip_from_world * point;
})";

// Sky and light reflected by the ground: 0.60 above, 0.35 below; the sun adds up to 0.55. Upward
// faces have 1.08 of their colour, the faces of a box to the left and to the front 0.71 and 0.59,
// so that its edges are seen, and those away from the sun 0.47.
inline constexpr const char* kSolidFragmentShader = R"(#version 330 core
in vec3 normal_world;
uniform vec3 colour, to_light;
out vec4 pixel;
void main() {
  vec3 n = normalize(normal_world);
  float light = mix(0.35, 0.60, 0.5 + 0.5 * n.z) + 0.55 * max(dot(n, to_light), 0.0);
  vec3 linear = pow(colour, vec3(2.2)) * light;
  pixel = vec4(pow(min(linear, vec3(1.0)), vec3(1.0 / 2.2)), 1.0);
})";

// Fades with the ground it lies on.
inline constexpr const char* kShadowFragmentShader = R"(#version 330 core
in vec3 point_world;
uniform vec3 center;
uniform float darkness, clear_m, end_m;
out vec4 pixel;
void main() {
  float there = 1.0 - smoothstep(clear_m, end_m, distance(point_world.xy, center.xy));
  pixel = vec4(0.10, 0.12, 0.15, darkness * there);
})";

// A square of 2 end_m about the point below the center.
inline constexpr const char* kGroundVertexShader = R"(#version 330 core
uniform mat4 clip_from_world;
uniform vec3 center;
uniform float end_m;
out vec2 place;
void main() {
  vec2 corner = vec2(gl_VertexID % 2, gl_VertexID / 2) * 2.0 - 1.0;
  place = center.xy + end_m * corner;
  gl_Position = clip_from_world * vec4(place, 0.0, 1.0);
})";

// Lines are about one and two pixels wide; where a cell is narrower than 8 pixels its lines fade,
// because they would shimmer.
inline constexpr const char* kGroundFragmentShader = R"(#version 330 core
in vec2 place;
uniform vec3 center, background;
uniform float clear_m, end_m;
out vec4 pixel;
float Line(float spacing, float width) {
  vec2 pixels = fwidth(place);
  vec2 away = abs(fract(place / spacing + 0.5) - 0.5) * spacing / pixels;
  vec2 line = clamp(0.5 + 0.5 * width - away, 0.0, 1.0);
  vec2 cell = spacing / pixels;
  line *= smoothstep(3.0, 8.0, cell);
  return max(line.x, line.y);
}
void main() {
  vec3 colour = vec3(0.80, 0.82, 0.84);
  colour = mix(colour, vec3(0.70, 0.72, 0.75), Line(0.1, 1.0));
  colour = mix(colour, vec3(0.50, 0.53, 0.57), Line(0.5, 2.0));
  float gone = smoothstep(clear_m, end_m, distance(place, center.xy));
  pixel = vec4(mix(colour, background, gone), 1.0);
})";

}  // namespace sinew::render
