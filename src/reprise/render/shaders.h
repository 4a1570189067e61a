// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The renderer's shaders (GLSL 3.30). Lighting happens in linear light; what leaves a fragment shader is
// sRGB.

#pragma once

namespace reprise::shaders {

inline constexpr const char* shadow_vertex = R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 light_from_world;
void main() { gl_Position = light_from_world * vec4(position, 1.0); }
)";

inline constexpr const char* empty_fragment = R"(#version 330 core
void main() {}
)";

// One triangle over the whole target.
inline constexpr const char* screen_vertex = R"(#version 330 core
out vec2 unit;
void main() {
  unit = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);
  gl_Position = vec4(2.0 * unit - 1.0, 0.0, 1.0);
}
)";

// What of the light reaches the floor, over the window of the shadow map: r = key light, whose penumbra
// widens with the height of what casts the shadow; g = sky light near contacts. The taps turn from texel to
// texel in a 2 x 2 pattern, which `average_fragment` then makes one: four times the taps for the price of one
// more pass.
inline constexpr const char* floor_light_fragment = R"(#version 330 core
in vec2 unit;
out vec4 result;
const int tap_count = 16;
uniform vec2 taps[tap_count];  // over the unit disk
uniform sampler2D depths;
uniform float half_size;       // of the window, metres
uniform float depth_range;     // metres
uniform vec3 floor_depth;      // depth of the floor at unit (x, y): dot(floor_depth, (x, y, 1))
uniform float light_height;    // sine of the light's elevation
uniform float search_radius;   // metres
void main() {
  float floor_here = dot(floor_depth, vec3(unit, 1.0));
  float to_unit = 0.5 / half_size;
  vec2 odd = floor(mod(gl_FragCoord.xy, 2.0));
  float turn = 0.39269908 * (odd.x + 2.0 * odd.y);  // sixteenths of a circle
  mat2 rotation = mat2(cos(turn), sin(turn), -sin(turn), cos(turn));
  mat2 search = search_radius * to_unit * rotation;
  float blocker_distance = 0.0;
  float blockers = 0.0;
  float contact = 0.0;
  for (int i = 0; i < tap_count; ++i) {
    float depth = textureLod(depths, unit + search * taps[i], 0.0).r;
    float gap = (floor_here - depth) * depth_range;
    float blocks = depth < 1.0 && gap > 0.0 ? 1.0 : 0.0;
    float height = gap * light_height;
    blockers += blocks;
    blocker_distance += blocks * gap;
    contact += blocks / (1.0 + 160.0 * height * height);
  }
  float radius = clamp(0.11 * blocker_distance / max(blockers, 1.0), 0.014, search_radius) * to_unit;
  mat2 filtering = radius * rotation;
  float blocked = 0.0;
  for (int i = 0; i < tap_count; ++i) {
    float depth = textureLod(depths, unit + filtering * taps[i], 0.0).r;
    blocked += depth < 1.0 && depth < floor_here ? 1.0 : 0.0;
  }
  result = vec4(1.0 - blocked / float(tap_count), 1.0 - contact / float(tap_count), 0.0, 1.0);
}
)";

// Mean of 2 x 2 texels: one look between them.
inline constexpr const char* average_fragment = R"(#version 330 core
in vec2 unit;
out vec4 result;
uniform sampler2D source;
uniform float half_texel;
void main() { result = texture(source, unit + half_texel); }
)";

inline constexpr const char* backdrop_vertex = R"(#version 330 core
uniform vec3 ray_middle;
uniform vec3 ray_right;
uniform vec3 ray_up;
out vec3 ray;
void main() {
  vec2 ndc = 2.0 * vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0) - 1.0;
  ray = ray_middle + ndc.x * ray_right + ndc.y * ray_up;
  gl_Position = vec4(ndc, 0.0, 1.0);
}
)";

// The studio above the horizon. Colours of the backdrop are mixed in sRGB; they are nearly grey.
inline constexpr const char* sky_fragment = R"(#version 330 core
in vec3 ray;
out vec4 result;
const vec3 horizon = vec3(0.925, 0.932, 0.942);
const vec3 zenith = vec3(0.800, 0.820, 0.848);
void main() {
  float rise = min(abs(ray.y) * 1.5, 1.0);
  vec3 color = mix(horizon, zenith, rise * rise * (3.0 - 2.0 * rise));
  // Half a step of ordered noise hides the bands of the slow gradients.
  float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  result = vec4(color + (noise - 0.5) / 255.0, 1.0);
}
)";

// The floor, by meeting each view ray with the plane: nothing to clip, nothing to fight over depth. To be
// preceded by one of the two heads below: the look at the light costs a software renderer as much as all the
// rest, and only a small part of the picture needs it.
inline constexpr const char* lit_floor_head = R"(#version 330 core
uniform sampler2D floor_light;
uniform mat3x2 floor_light_from_ground;  // (x, z, 1) about the anchor -> texture
vec2 light_at(vec2 about) { return texture(floor_light, floor_light_from_ground * vec3(about, 1.0)).rg; }
)";
inline constexpr const char* plain_floor_head = R"(#version 330 core
vec2 light_at(vec2 about) { return vec2(1.0); }
)";
inline constexpr const char* floor_fragment = R"(
in vec3 ray;
out vec4 result;
uniform float eye_height;        // above the floor
uniform vec2 eye_ground;         // (x, z) modulo a metre: keeps the grid sharp far from the origin
uniform vec2 eye_from_anchor;    // (x, z)
uniform float fade_scale;        // per square metre
const vec3 horizon = vec3(0.925, 0.932, 0.942);
const vec3 ground = vec3(0.862, 0.868, 0.876);
const vec3 shadow = vec3(0.655, 0.672, 0.700);

// Part of the pixel covered by lines `width` wide at all whole numbers. `pixel`: its size on the floor in the
// same unit, `per_pixel`: one over it.
float lines(vec2 p, vec2 pixel, vec2 per_pixel, float width) {
  vec2 to_line = abs(fract(p + 0.5) - 0.5);
  vec2 drawn = width * per_pixel;
  vec2 cover = clamp(0.5 * max(drawn, 1.0) + 0.5 - to_line * per_pixel, 0.0, 1.0);
  cover *= min(drawn, 1.0);                              // thinner than a pixel: paler instead
  cover *= 1.0 - smoothstep(0.15, 0.45, pixel);          // too dense to resolve: gone before it shimmers
  return max(cover.x, cover.y);
}

void main() {
  vec2 step_ground = ray.xz * (eye_height / max(-ray.y, 1e-4));
  vec2 pixel = max(fwidth(step_ground), vec2(1e-6));
  vec2 per_pixel = 1.0 / pixel;
  vec2 p = eye_ground + step_ground;
  vec2 about = eye_from_anchor + step_ground;
  float fade = 1.0 / (1.0 + dot(about, about) * fade_scale);
  fade *= fade * fade;
  vec2 light = light_at(about);
  // Every 0.25 m, 6 mm wide; every metre, 11 mm wide.
  float shade = 1.0 - 0.055 * lines(4.0 * p, 4.0 * pixel, 0.25 * per_pixel, 0.024);
  shade *= 1.0 - 0.130 * lines(p, pixel, per_pixel, 0.011);
  shade *= mix(0.62, 1.0, light.g);
  vec3 color = mix(horizon, ground * mix(shadow, vec3(1.0), light.r) * shade, fade);
  float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  result = vec4(color + (noise - 0.5) / 255.0, 1.0);
}
)";

// The character. Each surface shader is to be preceded by one of the two heads: what is drawn on the surface,
// a texture or one colour a vertex.
inline constexpr const char* colored_vertex_head = R"(#version 330 core
layout(location = 3) in vec3 color;
out vec3 paint;
void pass_paint() {
  paint = mix(color / 12.92, pow((color + 0.055) / 1.055, vec3(2.4)), step(0.04045, color));
}
)";
inline constexpr const char* colored_fragment_head = R"(#version 330 core
in vec3 paint;
vec3 albedo() { return paint; }
)";
inline constexpr const char* textured_vertex_head = R"(#version 330 core
layout(location = 3) in vec2 uv;
out vec2 paint;
void pass_paint() { paint = uv; }
)";
inline constexpr const char* textured_fragment_head = R"(#version 330 core
in vec2 paint;
uniform sampler2D picture;
vec3 albedo() { return texture(picture, paint).rgb; }
)";

inline constexpr const char* surface_vertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 open;
uniform mat4 clip_from_world;
uniform mat4 shadow_from_world;
uniform float shadow_offset;  // metres along the normal
uniform vec3 to_light;
uniform vec3 eye;
out vec3 world_normal;
out vec3 to_eye;
out vec3 shadow_position;
out vec2 openness;
void main() {
  gl_Position = clip_from_world * vec4(position, 1.0);
  world_normal = normal;
  to_eye = eye - position;
  openness = open;
  // Always towards the light, so that neither side of a surface shades itself.
  float side = dot(normal, to_light) < 0.0 ? -1.0 : 1.0;
  shadow_position = vec3(shadow_from_world * vec4(position + side * shadow_offset * normal, 1.0));
  pass_paint();
}
)";

inline constexpr const char* surface_fragment = R"(
in vec3 world_normal;
in vec3 to_eye;
in vec3 shadow_position;
in vec2 openness;  // of the front, of the back
out vec4 result;
uniform sampler2DShadow shadow;
uniform float shadow_step;  // a texel of the shadow map
uniform vec3 to_light;
uniform vec3 to_fill;
uniform vec3 to_rim;
const vec3 key_light = vec3(1.04, 0.985, 0.91);
const vec3 sky_light = vec3(0.30, 0.335, 0.39);
const vec3 ground_light = vec3(0.165, 0.15, 0.14);
const vec3 fill_light = vec3(0.10, 0.105, 0.12);
const vec3 rim_light = vec3(0.30, 0.31, 0.33);
// How far light reaches around the terminator: red light farthest, as in skin.
const vec3 wrap = vec3(0.16, 0.10, 0.08);
// By square roots, within 0.004 of the exact curve: powers cost a software renderer far more.
vec3 srgb_from_linear(vec3 c) {
  vec3 r2 = sqrt(c);
  vec3 r4 = sqrt(r2);
  vec3 r8 = sqrt(r4);
  return clamp(0.662002687 * r2 + 0.684122060 * r4 - 0.323583601 * r8 - 0.0225411470 * c, 0.0, 1.0);
}
void main() {
  vec3 v = normalize(to_eye);
  vec3 n = world_normal;
  float size = dot(n, n);
  n = size > 1e-12 ? n * inversesqrt(size) : v;  // no triangle of positive area at a corner
  if (!gl_FrontFacing) n = -n;
  float open_here = gl_FrontFacing ? openness.x : openness.y;

  // Each look compares and mixes 2 x 2 texels: together a soft edge of four texels.
  float lit = 0.25 * (texture(shadow, shadow_position + vec3(-shadow_step, -shadow_step, 0.0)) +
                      texture(shadow, shadow_position + vec3(shadow_step, -shadow_step, 0.0)) +
                      texture(shadow, shadow_position + vec3(-shadow_step, shadow_step, 0.0)) +
                      texture(shadow, shadow_position + vec3(shadow_step, shadow_step, 0.0)));

  float n_l = dot(n, to_light);
  vec3 light = key_light * (clamp((n_l + wrap) / (1.0 + wrap), 0.0, 1.0) * lit);
  float up = 0.5 + 0.5 * n.y;
  vec3 around = mix(ground_light, sky_light, up) + fill_light * clamp(0.2 + 0.8 * dot(n, to_fill), 0.0, 1.0);
  light += around * open_here;
  float n_v = clamp(dot(n, v), 0.0, 1.0);
  float edge = 1.0 - n_v;
  edge *= edge;
  // The sheen of skin and cloth: of the key light, and of what stands behind at grazing angles.
  vec3 h = normalize(v + to_light);
  float n_h = clamp(dot(n, h), 0.0, 1.0);
  n_h *= n_h;
  n_h *= n_h;
  n_h *= n_h;
  n_h *= n_h;
  vec3 sheen = key_light * (0.07 * n_h * lit * clamp(4.0 * n_l, 0.0, 1.0));
  sheen += rim_light * (edge * open_here * (0.12 * up + clamp(dot(n, to_rim), 0.0, 1.0)));
  vec3 paint_here = albedo();
  vec3 color = paint_here * light + sheen * (0.4 + 0.6 * paint_here);
  // A soft shoulder from 0.75 keeps pale colours from burning out.
  vec3 above = max(color - 0.75, 0.0);
  color = min(color, vec3(0.75)) + above / (1.0 + 4.0 * above);
  result = vec4(srgb_from_linear(clamp(color, 0.0, 1.0)), 1.0);
}
)";

// Lays the resolved character (premultiplied by its coverage) over the backdrop.
inline constexpr const char* composite_fragment = R"(#version 330 core
out vec4 result;
uniform sampler2D layer;
void main() { result = texelFetch(layer, ivec2(gl_FragCoord.xy), 0); }
)";

}  // namespace reprise::shaders
