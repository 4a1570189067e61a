// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/render/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/render/camera.h"
#include "reprise/render/character.h"
#include "reprise/render/gl_context.h"
#include "reprise/render/gl_objects.h"
#include "reprise/render/shaders.h"

namespace reprise {
namespace {

constexpr int shadow_size = 768;
constexpr int floor_light_size = 256;
constexpr int floor_taps = 16;
constexpr double shadow_reach = 0.13;  // metres: how far beside its caster a shadow ends on the floor

// Rows of the rotation part, then the translation that puts `origin` at zero.
Eigen::Matrix4d view_from_world(const View& view) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.block<1, 3>(0, 0) = view.right.transpose();
  m.block<1, 3>(1, 0) = view.up.transpose();
  m.block<1, 3>(2, 0) = view.forward.transpose();
  m.block<3, 1>(0, 3) = -m.block<3, 3>(0, 0) * view.eye;
  return m;
}

// Points spread evenly over the unit disk (Vogel's spiral).
std::vector<Eigen::Vector2f> disk_taps() {
  std::vector<Eigen::Vector2f> taps;
  for (int i = 0; i < floor_taps; ++i) {
    const float angle = 2.39996323F * static_cast<float>(i);
    const float radius = std::sqrt((static_cast<float>(i) + 0.5F) / floor_taps);
    taps.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return taps;
}

struct Rectangle {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

// The light on the floor, and where it is not full.
struct FloorLight {
  Eigen::Matrix<double, 2, 3> texture_from_ground = Eigen::Matrix<double, 2, 3>::Zero();  // from (x, z, 1)
  std::vector<Eigen::Vector2d> outline;  // (x, z); all about the anchor
};

}  // namespace

struct SequenceRenderer::Impl {
  Impl(const MeshSequence& s, const RenderOptions& o) : sequence(s), options(o), path(s, o) {
    const GlContext::Scope scope(context);
    check_limits();
    character = std::make_unique<Character>(sequence, options);
    make_targets();
    floor_light_program = std::make_unique<Program>(shaders::screen_vertex, shaders::floor_light_fragment);
    floor_light_program->use();
    floor_light_program->set("taps", disk_taps());
    floor_light_program->set("search_radius", shadow_reach);
    average_program = std::make_unique<Program>(shaders::screen_vertex, shaders::average_fragment);
    shadow_program = std::make_unique<Program>(shaders::shadow_vertex, shaders::empty_fragment);
    sky_program = std::make_unique<Program>(shaders::backdrop_vertex, shaders::sky_fragment);
    const std::string floor = shaders::floor_fragment;
    lit_floor_program =
        std::make_unique<Program>(shaders::backdrop_vertex, (shaders::lit_floor_head + floor).c_str());
    plain_floor_program =
        std::make_unique<Program>(shaders::backdrop_vertex, (shaders::plain_floor_head + floor).c_str());
    const bool is_textured = character->is_textured();
    const std::string surface_vertex =
        is_textured ? shaders::textured_vertex_head : shaders::colored_vertex_head;
    const std::string surface_fragment =
        is_textured ? shaders::textured_fragment_head : shaders::colored_fragment_head;
    surface_program = std::make_unique<Program>((surface_vertex + shaders::surface_vertex).c_str(),
                                                (surface_fragment + shaders::surface_fragment).c_str());
    composite_program = std::make_unique<Program>(shaders::screen_vertex, shaders::composite_fragment);
  }

  void check_limits() const {
    GLint max_size = 0;
    GLint max_samples = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &max_size);
    glGetIntegerv(GL_MAX_SAMPLES, &max_samples);
    if (options.width > max_size || options.height > max_size) {
      throw InvalidArgument(
          fmt::format("picture size: the OpenGL driver offers at most {0} x {0}, asked for {1} x {2}",
                      max_size, options.width, options.height));
    }
    if (options.samples > max_samples) {
      throw InvalidArgument(fmt::format("samples: the OpenGL driver offers at most {}, asked for {}",
                                        max_samples, options.samples));
    }
  }

  void make_targets() {
    shadow_texture = make_texture(GL_DEPTH_COMPONENT32F, shadow_size, shadow_size, GL_DEPTH_COMPONENT,
                                  GL_FLOAT, GL_NEAREST);
    shadow_target = make_framebuffer();
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, shadow_texture, 0);
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
    check_framebuffer("the shadow map");
    // The floor reads plain depths, the character compares: one texture seen through two samplers.
    glGenSamplers(1, &compare_sampler);
    glSamplerParameteri(compare_sampler, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glSamplerParameteri(compare_sampler, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glSamplerParameteri(compare_sampler, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glSamplerParameteri(compare_sampler, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glSamplerParameteri(compare_sampler, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glSamplerParameteri(compare_sampler, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);

    for (int i = 0; i < 2; ++i) {
      floor_lights[i] =
          make_texture(GL_RG8, floor_light_size, floor_light_size, GL_RG, GL_UNSIGNED_BYTE, GL_LINEAR);
      floor_light_targets[i] = make_framebuffer();
      glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, floor_lights[i], 0);
      check_framebuffer("the light on the floor");
    }

    const GLuint picture =
        make_texture(GL_RGBA8, options.width, options.height, GL_RGBA, GL_UNSIGNED_BYTE, GL_NEAREST);
    picture_target = make_framebuffer();
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, picture, 0);
    check_framebuffer("the picture");

    layer = make_texture(GL_RGBA8, options.width, options.height, GL_RGBA, GL_UNSIGNED_BYTE, GL_NEAREST);
    layer_target = make_framebuffer();
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, layer, 0);
    check_framebuffer("the character");

    const GLsizei samples = options.samples > 1 ? options.samples : 0;
    GLuint renderbuffers[2];
    glGenRenderbuffers(2, renderbuffers);
    character_target = make_framebuffer();
    const GLenum formats[] = {GL_RGBA8, GL_DEPTH_COMPONENT32F};
    const GLenum attachments[] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
    for (int i = 0; i < 2; ++i) {
      glBindRenderbuffer(GL_RENDERBUFFER, renderbuffers[i]);
      glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, formats[i], options.width, options.height);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachments[i], GL_RENDERBUFFER, renderbuffers[i]);
    }
    check_framebuffer("the multisampled character");
  }

  // Depths of the frame as the key light sees them. Returns light clip space from the world; the window moves
  // in whole texels, so that shadow edges do not crawl.
  Eigen::Matrix4d draw_shadow_map(std::size_t frame_idx) {
    const View& light = path.light();
    const LightWindow& window = path.light_window();
    const Eigen::Vector3d anchor = path.anchor(frame_idx);
    const double texel = 2.0 * window.half_size / floor_light_size;
    const double x = texel * std::round((light.right.dot(anchor) + window.center.x()) / texel);
    const double y = texel * std::round((light.up.dot(anchor) + window.center.y()) / texel);
    const double near = light.forward.dot(anchor) + window.near;
    const double range = window.far - window.near;
    Eigen::Matrix4d light_from_world = view_from_world(light);
    light_from_world(0, 3) = -x;
    light_from_world(1, 3) = -y;
    light_from_world(2, 3) = -near - 0.5 * range;
    light_from_world.topRows<2>() /= window.half_size;
    light_from_world.row(2) /= 0.5 * range;

    glBindFramebuffer(GL_FRAMEBUFFER, shadow_target);
    glViewport(0, 0, shadow_size, shadow_size);
    glEnable(GL_DEPTH_TEST);
    glClear(GL_DEPTH_BUFFER_BIT);
    shadow_program->use();
    shadow_program->set("light_from_world", light_from_world);
    character->draw();
    return light_from_world;
  }

  // Unit coordinates (0 to 1) from clip coordinates (-1 to 1).
  static Eigen::Matrix4d unit_from_clip() {
    Eigen::Matrix4d m = 0.5 * Eigen::Matrix4d::Identity();
    m.col(3) << 0.5, 0.5, 0.5, 1.0;
    return m;
  }

  // Fills `floor_lights` where the frame's shadow may fall.
  FloorLight draw_floor_light(std::size_t frame_idx, const Eigen::Matrix4d& shadow_from_world) {
    const Eigen::Vector3d anchor = path.anchor(frame_idx);
    // On the floor, texture x, y and depth are affine in the ground's x, z.
    Eigen::Matrix3d shadow_from_ground;
    shadow_from_ground.col(0) = shadow_from_world.block<3, 1>(0, 0);
    shadow_from_ground.col(1) = shadow_from_world.block<3, 1>(0, 2);
    shadow_from_ground.col(2) =
        shadow_from_world.block<3, 3>(0, 0) * anchor + shadow_from_world.block<3, 1>(0, 3);
    Eigen::Matrix3d unit_from_ground = shadow_from_ground;
    unit_from_ground.row(2) << 0.0, 0.0, 1.0;
    const Eigen::Matrix3d ground_from_unit = unit_from_ground.inverse();
    const Eigen::Vector3d floor_depth = (shadow_from_ground.row(2) * ground_from_unit).transpose();

    // As the light sees it, the shadow hides behind the character, but for its soft edge.
    const PositionsView positions = sequence.frame(frame_idx);
    Eigen::Array2d low = Eigen::Array2d::Constant(INFINITY);
    Eigen::Array2d high = Eigen::Array2d::Constant(-INFINITY);
    for (Eigen::Index v = 0; v < positions.rows(); ++v) {
      const Eigen::Vector3d p = positions.row(v).cast<double>();
      if (!p.allFinite()) continue;
      const Eigen::Array2d unit =
          shadow_from_world.block<2, 3>(0, 0) * p + shadow_from_world.block<2, 1>(0, 3);
      low = low.min(unit);
      high = high.max(unit);
    }
    if (!(low.x() < INFINITY)) return {};
    const double margin = 0.5 * shadow_reach / path.light_window().half_size + 3.0 / floor_light_size;
    low -= margin;
    high += margin;
    const Eigen::Array2i first = (low * floor_light_size).floor().cast<int>();
    const Eigen::Array2i size = (high * floor_light_size).ceil().cast<int>() - first;

    const GLfloat full[] = {1.0F, 1.0F, 1.0F, 1.0F};
    for (const GLuint target : {floor_light_targets[1], floor_light_targets[0]}) {
      glBindFramebuffer(GL_FRAMEBUFFER, target);
      glClearBufferfv(GL_COLOR, 0, full);
    }
    glViewport(0, 0, floor_light_size, floor_light_size);
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_SCISSOR_TEST);
    glScissor(first.x(), first.y(), size.x(), size.y());
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, shadow_texture);
    glBindSampler(0, 0);
    floor_light_program->use();
    floor_light_program->set("depths", 0);
    floor_light_program->set("half_size", path.light_window().half_size);
    floor_light_program->set("depth_range", path.light_window().far - path.light_window().near);
    floor_light_program->set("floor_depth", floor_depth);
    floor_light_program->set("light_height", -path.light().forward.y());
    glDrawArrays(GL_TRIANGLES, 0, 3);

    glBindFramebuffer(GL_FRAMEBUFFER, floor_light_targets[1]);
    glBindTexture(GL_TEXTURE_2D, floor_lights[0]);
    average_program->use();
    average_program->set("source", 0);
    average_program->set("half_texel", 0.5 / floor_light_size);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDisable(GL_SCISSOR_TEST);

    FloorLight light;
    // A mean lies half a texel beyond the first of its texels.
    light.texture_from_ground = unit_from_ground.topRows<2>();
    light.texture_from_ground.col(2).array() -= 0.5 / floor_light_size;
    for (const double x : {low.x(), high.x()}) {
      for (const double y : {low.y(), high.y()}) {
        light.outline.emplace_back((ground_from_unit * Eigen::Vector3d(x, y, 1.0)).head<2>());
      }
    }
    return light;
  }

  void draw_backdrop(std::size_t frame_idx, const View& view, const FloorLight& light) {
    const Eigen::Vector3d anchor = path.anchor(frame_idx);
    const double eye_height = view.eye.y() - path.ground_height();
    const Eigen::Vector2d eye_ground(view.eye.x(), view.eye.z());
    const Eigen::Vector2d eye_from_anchor = eye_ground - Eigen::Vector2d(anchor.x(), anchor.z());
    // The camera never rolls: the rows of the picture below the horizon are floor. Seen from below, a floor
    // would only hide the character.
    int floor_rows = 0;
    if (options.floor && eye_height > 0.0) {
      const double horizon =
          ((-1e-4 - view.forward.y()) / view.up.y() - path.tan_middle().y()) / path.tan_half_height();
      floor_rows = static_cast<int>(
          std::clamp(std::ceil((0.5 + 0.5 * horizon) * options.height - 0.5), 0.0, 1.0 * options.height));
    }
    Rectangle lit = pixels_around(view, eye_from_anchor, eye_height, light.outline);
    lit.y = std::min(lit.y, floor_rows);
    lit.height = std::min(lit.height, floor_rows - lit.y);

    glBindFramebuffer(GL_FRAMEBUFFER, picture_target);
    glViewport(0, 0, options.width, options.height);
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_SCISSOR_TEST);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, floor_lights[1]);
    glBindSampler(0, 0);
    const auto use = [&](Program& program) {
      program.use();
      program.set("ray_middle", Eigen::Vector3d(view.forward + path.tan_middle().x() * view.right +
                                                path.tan_middle().y() * view.up));
      program.set("ray_right", Eigen::Vector3d(path.tan_half_width() * view.right));
      program.set("ray_up", Eigen::Vector3d(path.tan_half_height() * view.up));
      program.set("eye_height", eye_height);
      program.set("eye_ground", Eigen::Vector2d(eye_ground.array() - eye_ground.array().floor()));
      program.set("eye_from_anchor", eye_from_anchor);
      program.set("fade_scale", 0.28 / (path.distance() * path.distance()));
    };
    const auto fill = [](const Rectangle& area) {
      glScissor(area.x, area.y, area.width, area.height);
      glDrawArrays(GL_TRIANGLES, 0, 3);
    };
    const int lit_right = lit.x + lit.width;
    const int lit_top = lit.y + lit.height;
    use(*sky_program);
    fill({0, floor_rows, options.width, options.height - floor_rows});
    use(*plain_floor_program);
    fill({0, 0, options.width, lit.y});
    fill({0, lit_top, options.width, floor_rows - lit_top});
    fill({0, lit.y, lit.x, lit.height});
    fill({lit_right, lit.y, options.width - lit_right, lit.height});
    use(*lit_floor_program);
    lit_floor_program->set("floor_light", 0);
    lit_floor_program->set("floor_light_from_ground", light.texture_from_ground);
    fill(lit);
    glDisable(GL_SCISSOR_TEST);
  }

  // From directions over depth, bounds of x and y, to the pixels there, with a margin for anti-aliasing.
  Rectangle pixels_between(const Eigen::Array2d& low, const Eigen::Array2d& high) const {
    const Eigen::Array2d half(path.tan_half_width(), path.tan_half_height());
    const Eigen::Array2d size(options.width, options.height);
    const auto pixel = [&](const Eigen::Array2d& slope) -> Eigen::Array2i {
      const Eigen::Array2d place = (0.5 + 0.5 * (slope - path.tan_middle().array()) / half) * size;
      return place.max(-2.0).min(size + 2.0).cast<int>();
    };
    const Eigen::Array2i first = (pixel(low) - 2).max(0);
    const Eigen::Array2i last = (pixel(high) + 3).min(Eigen::Array2i(options.width, options.height));
    return {first.x(), first.y(), std::max(last.x() - first.x(), 0), std::max(last.y() - first.y(), 0)};
  }

  // The part of the picture that a polygon on the ground covers, (x, z) about the anchor.
  Rectangle pixels_around(const View& view, const Eigen::Vector2d& eye_from_anchor, double eye_height,
                          const std::vector<Eigen::Vector2d>& polygon) const {
    if (polygon.empty()) return {};
    Eigen::Array2d low = Eigen::Array2d::Constant(INFINITY);
    Eigen::Array2d high = Eigen::Array2d::Constant(-INFINITY);
    for (const Eigen::Vector2d& point : polygon) {
      const Eigen::Vector2d ground = point - eye_from_anchor;
      const Eigen::Vector3d p(ground.x(), -eye_height, ground.y());
      const double depth = view.forward.dot(p);
      if (!(depth > 1e-3 * path.distance())) return {0, 0, options.width, options.height};  // beside the eye
      const Eigen::Array2d slope = Eigen::Array2d(view.right.dot(p), view.up.dot(p)) / depth;
      low = low.min(slope);
      high = high.max(slope);
    }
    return pixels_between(low, high);
  }

  // The part of the picture that the frame's vertices cover, with a margin for anti-aliasing; and their
  // depths.
  Rectangle covered(std::size_t frame_idx, const View& view, double* nearest, double* farthest) const {
    const PositionsView positions = sequence.frame(frame_idx);
    const Eigen::Matrix4f from_world = view_from_world(view).cast<float>();
    const Eigen::Matrix3f rotation = from_world.topLeftCorner<3, 3>();
    const Eigen::Vector3f translation = from_world.block<3, 1>(0, 3);
    Eigen::Array2f low = Eigen::Array2f::Constant(INFINITY);
    Eigen::Array2f high = Eigen::Array2f::Constant(-INFINITY);
    float near = INFINITY;
    float far = -INFINITY;
    for (Eigen::Index v = 0; v < positions.rows(); ++v) {
      const Eigen::Vector3f p = rotation * positions.row(v).transpose() + translation;
      if (!p.allFinite()) continue;
      near = std::min(near, p.z());
      far = std::max(far, p.z());
      const Eigen::Array2f slope = p.head<2>().array() / std::max(p.z(), 1e-6F);
      low = low.min(slope);
      high = high.max(slope);
    }
    *nearest = near;
    *farthest = far;
    if (!(near < INFINITY)) return {};
    return pixels_between(low.cast<double>(), high.cast<double>());
  }

  void draw_character(std::size_t frame_idx, const View& view, const Eigen::Matrix4d& shadow_from_world) {
    double nearest = 0.0;
    double farthest = 0.0;
    const Rectangle area = covered(frame_idx, view, &nearest, &farthest);
    if (area.width == 0 || area.height == 0) return;
    const double near = std::max(0.98 * nearest, 1e-3 * path.distance());
    const double far = std::max(1.02 * farthest, 2.0 * near);
    Eigen::Matrix4d clip_from_view = Eigen::Matrix4d::Zero();
    clip_from_view(0, 0) = 1.0 / path.tan_half_width();
    clip_from_view(1, 1) = 1.0 / path.tan_half_height();
    clip_from_view(0, 2) = -path.tan_middle().x() / path.tan_half_width();
    clip_from_view(1, 2) = -path.tan_middle().y() / path.tan_half_height();
    clip_from_view(2, 2) = (far + near) / (far - near);
    clip_from_view(2, 3) = -2.0 * far * near / (far - near);
    clip_from_view(3, 2) = 1.0;

    // Only the covered rectangle is cleared, drawn with multisampling, resolved and composed: a fraction of
    // the picture.
    glBindFramebuffer(GL_FRAMEBUFFER, character_target);
    glViewport(0, 0, options.width, options.height);
    glEnable(GL_SCISSOR_TEST);
    glScissor(area.x, area.y, area.width, area.height);
    glEnable(GL_DEPTH_TEST);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, shadow_texture);
    glBindSampler(0, compare_sampler);
    const LightWindow& window = path.light_window();
    const double texel = 2.0 * window.half_size / shadow_size;
    Eigen::Matrix4d biased = shadow_from_world;
    biased(2, 3) -= 2.0 * texel / (window.far - window.near);
    surface_program->use();
    surface_program->set("shadow", 0);
    if (character->is_textured()) {
      glActiveTexture(GL_TEXTURE1);
      glBindTexture(GL_TEXTURE_2D, character->texture());
      glActiveTexture(GL_TEXTURE0);
      surface_program->set("picture", 1);
    }
    surface_program->set("clip_from_world", Eigen::Matrix4d(clip_from_view * view_from_world(view)));
    surface_program->set("shadow_from_world", biased);
    surface_program->set("shadow_offset", 4.0 * texel);
    surface_program->set("shadow_step", 1.6 / shadow_size);
    surface_program->set("eye", view.eye);
    surface_program->set("to_light", Eigen::Vector3d(-path.light().forward));
    // From beside the camera, opposite to the key light.
    surface_program->set("to_fill", Eigen::Vector3d((view.right * 0.8 - view.forward * 0.6).normalized()));
    // From behind the character, high on the side of the fill.
    surface_program->set(
        "to_rim", Eigen::Vector3d((view.right * 0.55 + view.forward * 0.65 + view.up * 0.5).normalized()));
    character->draw();

    glBindFramebuffer(GL_READ_FRAMEBUFFER, character_target);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, layer_target);
    glBlitFramebuffer(area.x, area.y, area.x + area.width, area.y + area.height, area.x, area.y,
                      area.x + area.width, area.y + area.height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, picture_target);
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glBindTexture(GL_TEXTURE_2D, layer);
    glBindSampler(0, 0);
    composite_program->use();
    composite_program->set("layer", 0);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDisable(GL_BLEND);
    glDisable(GL_SCISSOR_TEST);
  }

  Image read_picture() {
    Image image{.width = options.width, .height = options.height};
    const auto width = static_cast<std::size_t>(options.width);
    const auto height = static_cast<std::size_t>(options.height);
    pixels.resize(4 * width * height);
    glBindFramebuffer(GL_FRAMEBUFFER, picture_target);
    // Four bytes a pixel, as the driver keeps them: it converts to three far more slowly than the loop below.
    glReadPixels(0, 0, options.width, options.height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    image.rgb.resize(3 * width * height);
    std::uint8_t* out = image.rgb.data();
    for (std::size_t row = height; row-- > 0;) {  // OpenGL's rows go upwards
      const std::uint8_t* in = pixels.data() + 4 * width * row;
      for (std::size_t column = 0; column < width; ++column, in += 4, out += 3) {
        out[0] = in[0];
        out[1] = in[1];
        out[2] = in[2];
      }
    }
    return image;
  }

  const MeshSequence& sequence;
  RenderOptions options;
  CameraPath path;
  GlContext context;
  std::unique_ptr<Character> character;
  GLuint shadow_texture = 0;
  GLuint shadow_target = 0;
  GLuint compare_sampler = 0;
  GLuint floor_lights[2] = {};  // as sampled, averaged
  GLuint floor_light_targets[2] = {};
  GLuint picture_target = 0;
  GLuint layer = 0;
  GLuint layer_target = 0;
  GLuint character_target = 0;
  std::unique_ptr<Program> shadow_program;
  std::unique_ptr<Program> floor_light_program;
  std::unique_ptr<Program> average_program;
  std::unique_ptr<Program> sky_program;
  std::unique_ptr<Program> lit_floor_program;
  std::unique_ptr<Program> plain_floor_program;
  std::unique_ptr<Program> surface_program;
  std::unique_ptr<Program> composite_program;
  std::vector<std::uint8_t> pixels;
};

SequenceRenderer::SequenceRenderer(const MeshSequence& sequence, const RenderOptions& options) {
  if (options.width < 1 || options.height < 1) {
    throw InvalidArgument(
        fmt::format("picture size: expected at least 1 x 1, found {} x {}", options.width, options.height));
  }
  if (options.samples < 1) {
    throw InvalidArgument(fmt::format("samples: expected at least 1, found {}", options.samples));
  }
  impl_ = std::make_unique<Impl>(sequence, options);
}

SequenceRenderer::~SequenceRenderer() = default;

Image SequenceRenderer::draw(std::size_t frame_idx) {
  Impl& impl = *impl_;
  const GlContext::Scope scope(impl.context);
  impl.character->upload_frame(frame_idx);
  const View view = impl.path.view(frame_idx);
  const Eigen::Matrix4d shadow_from_world = Impl::unit_from_clip() * impl.draw_shadow_map(frame_idx);
  FloorLight light;
  if (impl.options.floor) light = impl.draw_floor_light(frame_idx, shadow_from_world);
  impl.draw_backdrop(frame_idx, view, light);
  impl.draw_character(frame_idx, view, shadow_from_world);
  Image image = impl.read_picture();
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
    throw Error(fmt::format("the OpenGL driver failed on frame {} (error {:#x})", frame_idx, error));
  }
  return image;
}

}  // namespace reprise
