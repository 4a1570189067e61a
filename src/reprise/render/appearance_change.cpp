// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/render/appearance_change.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

constexpr int samples = 3;  // a side of a pixel: patterns of cloth are finer than pixels
constexpr int most_pixels_a_side = 8192;

using LinearColor = std::array<float, 3>;

float linear_from_srgb(std::uint8_t value) {
  const float c = static_cast<float>(value) / 255.0F;
  return c <= 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F);
}

const std::array<float, 256>& linear_table() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> values{};
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = linear_from_srgb(static_cast<std::uint8_t>(i));
    return values;
  }();
  return table;
}

LinearColor linear(const Color& color) {
  const auto& table = linear_table();
  return {table[color[0]], table[color[1]], table[color[2]]};
}

// CIE 1976, white point D65.
std::array<float, 3> lab_from_linear(const LinearColor& c) {
  const auto f = [](float t) {
    constexpr float delta = 6.0F / 29.0F;
    return t > delta * delta * delta ? std::cbrt(t) : t / (3.0F * delta * delta) + 4.0F / 29.0F;
  };
  const float x = f((0.4124F * c[0] + 0.3576F * c[1] + 0.1805F * c[2]) / 0.9505F);
  const float y = f(0.2126F * c[0] + 0.7152F * c[1] + 0.0722F * c[2]);
  const float z = f((0.0193F * c[0] + 0.1192F * c[1] + 0.9505F * c[2]) / 1.0890F);
  return {116.0F * y - 16.0F, 500.0F * (x - y), 200.0F * (y - z)};
}

// What a sample sees: a triangle and the weights of its second and third corner.
struct Sample {
  float depth = -std::numeric_limits<float>::infinity();  // towards the eye
  std::int32_t triangle = -1;
  float w1 = 0.0F;
  float w2 = 0.0F;
};

struct Projected {
  Eigen::Vector2d at;  // samples, from the lower left of the view
  double depth = 0.0;
};

// Draws one triangle into the depth buffer. Centres of samples lie at halves.
void draw_triangle(const Projected& a, const Projected& b, const Projected& c, std::int32_t triangle,
                   int width, int height, std::vector<Sample>& buffer) {
  const Eigen::Vector2d ab = b.at - a.at;
  const Eigen::Vector2d ac = c.at - a.at;
  const double area = ab.x() * ac.y() - ab.y() * ac.x();
  if (area == 0.0) return;
  const auto low = [](double x, double y, double z) {
    return static_cast<int>(std::ceil(std::min({x, y, z}) - 0.5));
  };
  const auto high = [](double x, double y, double z) {
    return static_cast<int>(std::floor(std::max({x, y, z}) - 0.5));
  };
  const int first_row = std::max(0, low(a.at.y(), b.at.y(), c.at.y()));
  const int last_row = std::min(height - 1, high(a.at.y(), b.at.y(), c.at.y()));
  const int first_column = std::max(0, low(a.at.x(), b.at.x(), c.at.x()));
  const int last_column = std::min(width - 1, high(a.at.x(), b.at.x(), c.at.x()));
  for (int row = first_row; row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      const Eigen::Vector2d ap = Eigen::Vector2d(column + 0.5, row + 0.5) - a.at;
      const double w1 = (ap.x() * ac.y() - ap.y() * ac.x()) / area;
      const double w2 = (ab.x() * ap.y() - ab.y() * ap.x()) / area;
      if (w1 < 0.0 || w2 < 0.0 || w1 + w2 > 1.0) continue;
      const auto depth = static_cast<float>(a.depth + w1 * (b.depth - a.depth) + w2 * (c.depth - a.depth));
      Sample& sample = buffer[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(column)];
      if (depth <= sample.depth) continue;
      sample = {
          .depth = depth, .triangle = triangle, .w1 = static_cast<float>(w1), .w2 = static_cast<float>(w2)};
    }
  }
}

// The texture in linear light, each texel the mean of `step` x `step` of the picture's.
std::vector<LinearColor> reduced_texture(const Image& image, int step, int width, int height) {
  std::vector<LinearColor> texels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const auto& table = linear_table();
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      LinearColor sum = {0.0F, 0.0F, 0.0F};
      int count = 0;
      for (int y = row * step; y < std::min(image.height, (row + 1) * step); ++y) {
        for (int x = column * step; x < std::min(image.width, (column + 1) * step); ++x) {
          const std::size_t at = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                                      static_cast<std::size_t>(x));
          for (std::size_t c = 0; c < 3; ++c) sum[c] += table[image.rgb[at + c]];
          ++count;
        }
      }
      for (float& c : sum) c /= static_cast<float>(count);
      texels[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
             static_cast<std::size_t>(column)] = sum;
    }
  }
  return texels;
}

// Metres a texel covers: square root of the area of the surface over that of its texture, in texels.
double texel_size(const Topology& topology, const PositionsView& positions) {
  double texels = 0.0;
  for (const Triangle& t : topology.triangle_uvs) {
    const auto uv = [&](std::size_t corner) {
      const auto& at = topology.uvs[static_cast<std::size_t>(t[corner])];
      return Eigen::Vector2d(at[0] * topology.texture->width, at[1] * topology.texture->height);
    };
    const Eigen::Vector2d ab = uv(1) - uv(0);
    const Eigen::Vector2d ac = uv(2) - uv(0);
    texels += 0.5 * std::abs(ab.x() * ac.y() - ab.y() * ac.x());
  }
  return texels > 0.0 ? std::sqrt(surface_area(topology, positions) / texels) : 1.0;
}

}  // namespace

FrameViewer::FrameViewer(const MeshSequence& clip, const AppearanceChangeOptions& options,
                         Appearance appearance)
    : options_(options), topology_(clip.topology()), appearance_(appearance) {
  if (!(options.pixel_size >= 1e-4 && options.pixel_size <= 10.0)) {
    throw InvalidArgument(fmt::format("pixel_size: expected 0.0001 to 10 m, found {}", options.pixel_size));
  }
  if (!(options.reach >= 0.0 && options.reach <= 20.0 * options.pixel_size)) {
    throw InvalidArgument(fmt::format("reach: expected 0 to 20 pixels ({} m), found {}",
                                      20.0 * options.pixel_size, options.reach));
  }
  if (!(options.color_difference > 0.0)) {
    throw InvalidArgument(
        fmt::format("color_difference: expected a positive number, found {}", options.color_difference));
  }
  const double reach = options.reach / options.pixel_size + 1e-9;
  const int most = static_cast<int>(reach);
  for (int y = -most; y <= most; ++y) {
    for (int x = -most; x <= most; ++x) {
      if (x * x + y * y <= reach * reach) reach_.push_back({x, y});
    }
  }
  std::ranges::stable_sort(reach_, {},
                           [](const std::array<int, 2>& at) { return at[0] * at[0] + at[1] * at[1]; });

  const bool has_texture = topology_->texture != nullptr;
  if (appearance == Appearance::automatic) {
    appearance_ = has_texture         ? Appearance::texture
                  : clip.has_colors() ? Appearance::vertex_colors
                                      : Appearance::plain;
  }
  if (appearance_ == Appearance::vertex_colors && !clip.has_colors())
    throw InvalidArgument(fmt::format("clip '{}': has no vertex colours", clip.name()));
  if (appearance_ != Appearance::texture) return;
  if (!has_texture) throw InvalidArgument(fmt::format("clip '{}': has no texture", clip.name()));
  if (clip.frame_count() == 0) throw InvalidArgument(fmt::format("clip '{}': has no frame", clip.name()));
  const double sample_size = options.pixel_size / samples;
  const int step =
      std::clamp(static_cast<int>(std::lround(sample_size / texel_size(*topology_, clip.frame(0)))), 1, 64);
  texture_width_ = (topology_->texture->width + step - 1) / step;
  texture_height_ = (topology_->texture->height + step - 1) / step;
  texture_ = reduced_texture(*topology_->texture, step, texture_width_, texture_height_);
}

std::array<float, 3> FrameViewer::texel(float u, float v) const {
  const auto wrapped = [](float at, int count) {
    const float unit = at - std::floor(at);
    return std::min(count - 1, static_cast<int>(unit * static_cast<float>(count)));
  };
  const int column = wrapped(u, texture_width_);
  const int row = texture_height_ - 1 - wrapped(v, texture_height_);
  return texture_[static_cast<std::size_t>(row) * static_cast<std::size_t>(texture_width_) +
                  static_cast<std::size_t>(column)];
}

FrameViews FrameViewer::look(const MeshSequence& clip, std::size_t frame_idx,
                             const GroundTransform& placed_from_clip) const {
  if (clip.vertex_count() != static_cast<std::size_t>(topology_->vertex_count)) {
    throw InvalidArgument(fmt::format("clip '{}': expected {} vertices, found {}", clip.name(),
                                      topology_->vertex_count, clip.vertex_count()));
  }
  const PositionsView positions = clip.frame(frame_idx);
  const std::string flaw = degeneracy(*topology_, positions);
  if (!flaw.empty())
    throw InvalidArgument(fmt::format("clip '{}' frame {}: {}", clip.name(), frame_idx, flaw));
  const bool is_textured = appearance_ == Appearance::texture;
  const bool is_colored = appearance_ == Appearance::vertex_colors;
  std::vector<LinearColor> vertex_colors;
  if (is_colored) {
    for (const Color& color : clip.colors(frame_idx)) vertex_colors.push_back(linear(color));
  }

  const auto color_of = [&](const Sample& sample) -> LinearColor {
    const auto t = static_cast<std::size_t>(sample.triangle);
    const float w0 = 1.0F - sample.w1 - sample.w2;
    if (is_textured) {
      const Triangle& corners = topology_->triangle_uvs[t];
      const auto& a = topology_->uvs[static_cast<std::size_t>(corners[0])];
      const auto& b = topology_->uvs[static_cast<std::size_t>(corners[1])];
      const auto& c = topology_->uvs[static_cast<std::size_t>(corners[2])];
      return texel(w0 * a[0] + sample.w1 * b[0] + sample.w2 * c[0],
                   w0 * a[1] + sample.w1 * b[1] + sample.w2 * c[1]);
    }
    if (!is_colored) return {0.5F, 0.5F, 0.5F};
    const Triangle& corners = topology_->triangles[t];
    const LinearColor& a = vertex_colors[static_cast<std::size_t>(corners[0])];
    const LinearColor& b = vertex_colors[static_cast<std::size_t>(corners[1])];
    const LinearColor& c = vertex_colors[static_cast<std::size_t>(corners[2])];
    LinearColor color{};
    for (std::size_t i = 0; i < 3; ++i) color[i] = w0 * a[i] + sample.w1 * b[i] + sample.w2 * c[i];
    return color;
  };

  FrameViews result;
  const double per_metre = 1.0 / options_.pixel_size;
  const Eigen::Matrix3d rotation = placed_from_clip.rotation();
  const Eigen::Vector3d translation = placed_from_clip.translation3();
  // Right and towards the eye, from each side.
  const std::array<std::array<Eigen::Vector3d, 2>, 4> axes = {
      {{Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ()},
       {-Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX()},
       {-Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitZ()},
       {Eigen::Vector3d::UnitZ(), -Eigen::Vector3d::UnitX()}}};
  std::vector<Projected> projected(clip.vertex_count());
  std::vector<Sample> buffer;
  for (std::size_t side = 0; side < axes.size(); ++side) {
    Eigen::Array2d low = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Array2d high = -low;
    for (std::size_t v = 0; v < projected.size(); ++v) {
      const Eigen::Vector3d p =
          rotation * positions.row(static_cast<Eigen::Index>(v)).transpose().cast<double>() + translation;
      projected[v] = {.at = per_metre * Eigen::Vector2d(axes[side][0].dot(p), p.y()),
                      .depth = axes[side][1].dot(p)};
      low = low.min(projected[v].at.array());
      high = high.max(projected[v].at.array());
    }
    if (!((high - low) < most_pixels_a_side).all() || !(high.abs() < 1e8).all() || !(low.abs() < 1e8).all()) {
      throw InvalidArgument(
          fmt::format("clip '{}' frame {}: expected a surface of at most {} pixels, found {:.0f} x {:.0f}",
                      clip.name(), frame_idx, most_pixels_a_side, high.x() - low.x(), high.y() - low.y()));
    }
    FrameViews::View& view = result.views[side];
    const int rim = 2 * static_cast<int>(options_.reach / options_.pixel_size + 1e-9);
    view.left = static_cast<int>(std::floor(low.x())) - rim;
    view.bottom = static_cast<int>(std::floor(low.y())) - rim;
    view.width = static_cast<int>(std::floor(high.x())) + 1 + rim - view.left;
    view.height = static_cast<int>(std::floor(high.y())) + 1 + rim - view.bottom;
    const int width = samples * view.width;
    const int height = samples * view.height;
    buffer.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), Sample());
    for (Projected& p : projected) p.at = samples * (p.at - Eigen::Vector2d(view.left, view.bottom));
    for (std::size_t t = 0; t < topology_->triangles.size(); ++t) {
      const Triangle& corners = topology_->triangles[t];
      draw_triangle(projected[static_cast<std::size_t>(corners[0])],
                    projected[static_cast<std::size_t>(corners[1])],
                    projected[static_cast<std::size_t>(corners[2])], static_cast<std::int32_t>(t), width,
                    height, buffer);
    }
    const std::size_t pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
    constexpr float nothing = std::numeric_limits<float>::quiet_NaN();
    view.lab.assign(pixels, {nothing, nothing, nothing});
    for (int row = 0; row < view.height; ++row) {
      for (int column = 0; column < view.width; ++column) {
        LinearColor sum = {0.0F, 0.0F, 0.0F};
        int hits = 0;
        for (int y = 0; y < samples; ++y) {
          for (int x = 0; x < samples; ++x) {
            const Sample& sample =
                buffer[static_cast<std::size_t>(samples * row + y) * static_cast<std::size_t>(width) +
                       static_cast<std::size_t>(samples * column + x)];
            if (sample.triangle < 0) continue;
            const LinearColor color = color_of(sample);
            for (std::size_t c = 0; c < 3; ++c) sum[c] += color[c];
            ++hits;
          }
        }
        const std::size_t pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(view.width) +
                                  static_cast<std::size_t>(column);
        if (2 * hits <= samples * samples) continue;
        ++view.covered_count;
        for (float& c : sum) c /= static_cast<float>(hits);
        view.lab[pixel] = lab_from_linear(sum);
      }
    }
  }
  return result;
}

FrameViewer::Counts FrameViewer::count(const FrameViews& a, const FrameViews& b, double enough) const {
  Counts counts;
  for (std::size_t side = 0; side < a.views.size(); ++side)
    counts.seen += a.views[side].covered_count + b.views[side].covered_count;
  const auto limit = static_cast<float>(options_.color_difference * options_.color_difference);
  const int reach = static_cast<int>(options_.reach / options_.pixel_size + 1e-9);
  std::vector<std::ptrdiff_t> offsets(reach_.size());
  const auto compare = [&](const FrameViews::View& one, const FrameViews::View& other) {
    for (std::size_t i = 0; i < reach_.size(); ++i)
      offsets[i] = static_cast<std::ptrdiff_t>(reach_[i][1]) * other.width + reach_[i][0];
    for (int row = 0; row < one.height; ++row) {
      if (static_cast<double>(counts.outline + counts.color) >= enough) return;
      const std::array<float, 3>* const pixels =
          one.lab.data() + static_cast<std::ptrdiff_t>(row) * one.width;
      const int y = row + one.bottom - other.bottom;
      for (int column = 0; column < one.width; ++column) {
        const std::array<float, 3>& lab = pixels[column];
        if (std::isnan(lab[0])) continue;
        const int x = column + one.left - other.left;
        bool is_covered = false;
        bool is_like = false;
        // Nearer to the rim's edge than the reach, no character can be within reach.
        if (x >= reach && y >= reach && x < other.width - reach && y < other.height - reach) {
          const std::array<float, 3>* const there =
              other.lab.data() + static_cast<std::ptrdiff_t>(y) * other.width + x;
          for (const std::ptrdiff_t offset : offsets) {
            const std::array<float, 3>& candidate = there[offset];
            const float d0 = lab[0] - candidate[0];
            const float d1 = lab[1] - candidate[1];
            const float d2 = lab[2] - candidate[2];
            const float squared = d0 * d0 + d1 * d1 + d2 * d2;  // NaN, and thus not like, where nothing is
            is_covered = is_covered || squared >= 0.0F;
            is_like = squared <= limit;
            if (is_like) break;
          }
        }
        counts.outline += is_covered ? 0 : 1;
        counts.color += is_covered && !is_like ? 1 : 0;
      }
    }
  };
  for (std::size_t side = 0; side < a.views.size(); ++side) {
    compare(a.views[side], b.views[side]);
    compare(b.views[side], a.views[side]);
  }
  return counts;
}

AppearanceChange FrameViewer::change(const FrameViews& a, const FrameViews& b) const {
  const Counts counts = count(a, b, std::numeric_limits<double>::infinity());
  if (counts.seen == 0) return {};
  const auto seen = static_cast<double>(counts.seen);
  return {.outline = static_cast<double>(counts.outline) / seen,
          .color = static_cast<double>(counts.color) / seen};
}

bool FrameViewer::is_less(const FrameViews& a, const FrameViews& b, double share) const {
  double seen = 0.0;
  for (std::size_t side = 0; side < a.views.size(); ++side)
    seen += static_cast<double>(a.views[side].covered_count + b.views[side].covered_count);
  const double enough = share * seen;
  const Counts counts = count(a, b, enough);
  return static_cast<double>(counts.outline + counts.color) < enough;
}

}  // namespace reprise
