// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/effects/capture_effects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/mesh/closest_point.h"
#include "reprise/synthetic/effects/smooth_field.h"

namespace reprise {

namespace {

// Every vertex slides along the tangent plane by its part of `displacement` (N x 3) and back onto the
// surface.
void slide(const Topology& topology, PositionsRef positions, const Positions& normals,
           const Eigen::MatrixXf& displacement) {
  std::vector<Eigen::Vector3d> points(static_cast<std::size_t>(positions.rows()));
  for (std::size_t v = 0; v < points.size(); ++v) {
    points[v] = positions.row(static_cast<Eigen::Index>(v)).cast<double>();
  }
  const ClosestPointTree surface(std::move(points), topology.triangles);
  Positions moved(positions.rows(), 3);
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    const Eigen::Vector3d normal = normals.row(v).cast<double>();
    const Eigen::Vector3d d = displacement.row(v).cast<double>();
    const Eigen::Vector3d target = positions.row(v).cast<double>().transpose() + d - normal * normal.dot(d);
    // What faces the other way is another side of something thin.
    std::optional<SurfacePoint> landed =
        surface.closest(target, std::numeric_limits<double>::infinity(), &normal);
    if (!landed) landed = surface.closest(target);
    moved.row(v) = landed->point.cast<float>();
  }
  positions = moved;
}

double to_linear(std::uint8_t value) {
  const double s = value / 255.0;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

std::uint8_t to_srgb(double value) {
  const double s = value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(s, 0.0, 1.0)));
}

struct Light {
  Eigen::Vector3d direction;  // towards the light
  Eigen::Vector3d color;      // linear
};

// A warm key, a cool fill from the other side, and a rim from behind, over an even ambient light. A surface
// that faces all ways gets 1 on average, so that the colours keep their overall brightness.
Eigen::Vector3d studio_irradiance(const Eigen::Vector3d& normal) {
  static const std::array<Light, 3> lights = {
      {{Eigen::Vector3d(0.6, 0.7, 0.5).normalized(), {1.30, 1.22, 1.10}},
       {Eigen::Vector3d(-0.8, 0.3, 0.4).normalized(), {0.55, 0.62, 0.72}},
       {Eigen::Vector3d(0.1, 0.5, -0.9).normalized(), {0.70, 0.70, 0.74}}}};
  // A cosine is a quarter on average over all directions.
  static const Eigen::Vector3d ambient = [] {
    Eigen::Vector3d rest = Eigen::Vector3d::Ones();
    for (const Light& light : lights) rest -= 0.25 * light.color;
    return rest;
  }();
  Eigen::Vector3d sum = ambient;
  for (const Light& light : lights) sum += light.color * std::max(0.0, normal.dot(light.direction));
  return sum;
}

}  // namespace

void validate(const CaptureEffects& effects) {
  const auto check_number = [](const char* name, double value, bool needs_positive) {
    if (!std::isfinite(value) || value < 0.0 || (needs_positive && value == 0.0)) {
      throw InvalidArgument(fmt::format("{} is {}; expected a {} number", name, value,
                                        needs_positive ? "positive" : "finite, non-negative"));
    }
  };
  check_number("noise", effects.noise, false);
  check_number("drift", effects.drift, false);
  check_number("noise length", effects.noise_length, effects.noise > 0.0);
  check_number("noise time", effects.noise_time, effects.noise > 0.0);
  check_number("drift length", effects.drift_length, effects.drift > 0.0);
  check_number("drift time", effects.drift_time, effects.drift > 0.0);
}

void apply_capture_effects(MeshSequence& clip, const Positions& rest, const CaptureEffects& effects) {
  validate(effects);
  if (!effects.any()) return;
  if (effects.studio_lights && !clip.has_colors()) {
    throw InvalidArgument(fmt::format("clip '{}' has no colours to put under studio lights", clip.name()));
  }
  const Topology& topology = *clip.topology();
  const EdgeGraph surface(topology, PositionsView(rest.data(), rest.rows(), 3));
  RandomField random(effects.seed);
  for (const char c : clip.name()) random = random.branch(static_cast<unsigned char>(c));
  std::optional<SmoothField> noise;
  std::optional<SmoothField> drift;
  if (effects.noise > 0.0) {
    noise.emplace(
        surface, clip.frame_count(), clip.frames_per_second(), random.branch(1),
        SmoothFieldOptions{.length = effects.noise_length, .time = effects.noise_time, .components = 1});
  }
  if (effects.drift > 0.0) {
    drift.emplace(
        surface, clip.frame_count(), clip.frames_per_second(), random.branch(2),
        SmoothFieldOptions{.length = effects.drift_length, .time = effects.drift_time, .components = 3});
  }

  const std::size_t vertex_count = clip.vertex_count();
  std::vector<Color> lit(effects.studio_lights ? clip.frame_count() * vertex_count : 0);
  parallel_for(0, clip.frame_count(), [&](std::size_t f) {
    const PositionsRef positions = clip.frame(f);
    const auto normals = [&] {
      return vertex_normals(topology, PositionsView(positions.data(), positions.rows(), 3));
    };
    if (drift) slide(topology, positions, normals(), static_cast<float>(effects.drift) * drift->frame(f));
    if (effects.studio_lights) {
      const Positions n = normals();
      const std::span<const Color> albedo = std::as_const(clip).colors(f);
      for (std::size_t v = 0; v < vertex_count; ++v) {
        const Eigen::Vector3d light = studio_irradiance(n.row(static_cast<Eigen::Index>(v)).cast<double>());
        for (std::size_t c = 0; c < 3; ++c) {
          lit[f * vertex_count + v][c] =
              to_srgb(to_linear(albedo[v][c]) * light[static_cast<Eigen::Index>(c)]);
        }
      }
    }
    if (noise) {
      const Positions n = normals();
      const Eigen::MatrixXf amount = static_cast<float>(effects.noise) * noise->frame(f);
      PositionsRef(positions) += n.cwiseProduct(amount.col(0).replicate<1, 3>());
    }
  });
  if (effects.studio_lights) clip.set_colors(std::move(lit));
}

}  // namespace reprise
