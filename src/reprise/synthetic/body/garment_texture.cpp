// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/body/garment_texture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "reprise/core/parallel.h"
#include "reprise/synthetic/body/tailor.h"

namespace reprise::body {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double darkest = 0.35, lightest = 1.7;  // of the original's mean

double luminance(const Image& image, std::size_t pixel) {
  const std::uint8_t* rgb = &image.rgb[3 * pixel];
  return (0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]) / 255.0;
}

std::size_t pixel_at(const Image& image, double u, double v) {
  const double x = (u - std::floor(u)) * image.width, y = (1.0 - (v - std::floor(v))) * image.height;
  const int column = std::clamp(static_cast<int>(x), 0, image.width - 1);
  const int line = std::clamp(static_cast<int>(y), 0, image.height - 1);
  return static_cast<std::size_t>(line) * static_cast<std::size_t>(image.width) +
         static_cast<std::size_t>(column);
}

double mean_luminance(const BodyLayer& layer) {
  double sum = 0.0, count = 0.0;
  for (const Triangle& uvs : layer.triangle_uvs) {
    double u = 0.0, v = 0.0;
    for (const std::int32_t corner : uvs) {
      u += layer.uvs[static_cast<std::size_t>(corner)][0] / 3.0;
      v += layer.uvs[static_cast<std::size_t>(corner)][1] / 3.0;
    }
    const std::size_t pixel = pixel_at(layer.texture, u, v);
    const double opaque = layer.alpha.empty() ? 1.0 : layer.alpha[pixel] / 255.0;
    sum += opaque * luminance(layer.texture, pixel);
    count += opaque;
  }
  return std::max(0.02, count > 0.0 ? sum / count : 0.5);
}

std::uint8_t byte(double value) {
  return static_cast<std::uint8_t>(std::clamp(std::round(value), 0.0, 255.0));
}

// Bilinear enlargement by a whole factor.
void enlarge(BodyLayer& layer, int factor) {
  if (factor <= 1) return;
  const auto enlarged = [&](const std::vector<std::uint8_t>& values, int channels) {
    const int width = layer.texture.width, height = layer.texture.height;
    std::vector<std::uint8_t> result(values.size() * static_cast<std::size_t>(factor) *
                                     static_cast<std::size_t>(factor));
    std::size_t out = 0;
    for (int y = 0; y < height * factor; ++y) {
      for (int x = 0; x < width * factor; ++x) {
        const double px = (x + 0.5) / factor - 0.5, py = (y + 0.5) / factor - 0.5;
        const int x0 = static_cast<int>(std::floor(px)), y0 = static_cast<int>(std::floor(py));
        const double ax = px - x0, ay = py - y0;
        for (int c = 0; c < channels; ++c) {
          const auto at = [&](int column, int line) {
            column = std::clamp(column, 0, width - 1);
            line = std::clamp(line, 0, height - 1);
            return static_cast<double>(
                values[static_cast<std::size_t>((line * width + column) * channels + c)]);
          };
          result[out++] = byte((1 - ay) * ((1 - ax) * at(x0, y0) + ax * at(x0 + 1, y0)) +
                               ay * ((1 - ax) * at(x0, y0 + 1) + ax * at(x0 + 1, y0 + 1)));
        }
      }
    }
    return result;
  };
  layer.texture.rgb = enlarged(layer.texture.rgb, 3);
  if (!layer.alpha.empty()) layer.alpha = enlarged(layer.alpha, 1);
  layer.texture.width *= factor;
  layer.texture.height *= factor;
}

double distance_from_whole(double x) {
  return std::abs(x - std::round(x));
}

}  // namespace

void tint(BodyLayer& layer, const Color& color, double contrast) {
  const double mean = mean_luminance(layer);
  Image& image = layer.texture;
  for (std::size_t pixel = 0; pixel < image.rgb.size() / 3; ++pixel) {
    const double light =
        std::clamp(1.0 + contrast * (luminance(image, pixel) / mean - 1.0), darkest, lightest);
    for (std::size_t c = 0; c < 3; ++c) image.rgb[3 * pixel + c] = byte(light * color[c]);
  }
}

Eigen::Vector3d pattern_color(const CostumePattern& pattern, const Eigen::Vector2d& place) {
  const auto color = [&](std::size_t i) {
    const Color& c = pattern.colors[i % pattern.colors.size()];
    return Vector3d(c[0], c[1], c[2]);
  };
  const auto count = static_cast<double>(pattern.colors.size());
  const Vector2d p = place / pattern.scale;
  // Colours follow each other once a repetition.
  const auto band = [&](double x) { return color(static_cast<std::size_t>((x - std::floor(x)) * count)); };
  switch (pattern.kind) {
    case CostumePattern::Kind::plain:
      return color(0);
    case CostumePattern::Kind::stripes:
      return band(p.x() + 0.5 / count);
    case CostumePattern::Kind::bands:
      return band(p.y());
    case CostumePattern::Kind::checks: {
      // As woven: bands of the second colour both ways, full where they cross; a third colour as a thin line.
      const bool across = distance_from_whole(p.x()) < 0.25, along = distance_from_whole(p.y()) < 0.25;
      if (pattern.colors.size() > 2 &&
          (distance_from_whole(p.x() + 0.5) < 0.035 || distance_from_whole(p.y() + 0.5) < 0.035)) {
        return color(2);
      }
      const double part = 0.5 * (across ? 1.0 : 0.0) + 0.5 * (along ? 1.0 : 0.0);
      return (1.0 - part) * color(0) + part * color(1);
    }
    case CostumePattern::Kind::dots: {
      // On a grid and at the centres of its squares; more colours take turns by row.
      constexpr double radius = 0.2;
      for (const double shift : {0.0, 0.5}) {
        const Vector2d q = p - Vector2d(shift, shift);
        const Vector2d centre(std::round(q.x()), std::round(q.y()));
        if ((q - centre).norm() < radius) {
          const auto turn = static_cast<std::int64_t>(2.0 * (centre.y() + shift));
          const auto others = static_cast<std::int64_t>(pattern.colors.size()) - 1;
          return color(static_cast<std::size_t>(1 + ((turn % others) + others) % others));
        }
      }
      return color(0);
    }
  }
  return color(0);
}

void draw_pattern(BodyLayer& layer, const CostumePattern& pattern, double contrast, int texture_size) {
  const double mean = mean_luminance(layer);
  enlarge(layer, (texture_size + layer.texture.width - 1) / layer.texture.width);
  const std::vector<Vector2d> cloth = cloth_coordinates(layer);
  Image& image = layer.texture;
  const int width = image.width, height = image.height;
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  struct Texel {
    float near = 0.0F;  // 1 inside of a triangle, less in the margin around it
    std::int32_t triangle = -1;
  };
  std::vector<Texel> texels(pixels);
  // Of each triangle: a place in pixels and on the cloth, and how one follows from the other.
  struct Map {
    Vector2d pixel, place;
    Eigen::Matrix2d cloth_from_pixel;
  };
  std::vector<Map> maps(layer.triangles.size());

  // Filtering reads a little beyond the pieces' rims.
  constexpr double margin = 6.0;  // pixels
  for (std::size_t t = 0; t < layer.triangles.size(); ++t) {
    std::array<Vector2d, 3> corner, place;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto uv = static_cast<std::size_t>(layer.triangle_uvs[t][k]);
      corner[k] = {layer.uvs[uv][0] * width, (1.0 - layer.uvs[uv][1]) * height};
      place[k] = cloth[uv];
    }
    Eigen::Matrix2d edges;
    edges << corner[1] - corner[0], corner[2] - corner[0];
    if (std::abs(edges.determinant()) < 1e-9) continue;
    const Eigen::Matrix2d inverse = edges.inverse();
    Eigen::Matrix2d spans;
    spans << place[1] - place[0], place[2] - place[0];
    maps[t] = {corner[0], place[0], spans * inverse};

    const Vector2d low = corner[0].cwiseMin(corner[1]).cwiseMin(corner[2]);
    const Vector2d high = corner[0].cwiseMax(corner[1]).cwiseMax(corner[2]);
    const int x0 = std::max(0, static_cast<int>(low.x() - margin));
    const int x1 = std::min(width - 1, static_cast<int>(high.x() + margin));
    const int y0 = std::max(0, static_cast<int>(low.y() - margin));
    const int y1 = std::min(height - 1, static_cast<int>(high.y() + margin));
    // Barycentric coordinates fall by one over a triangle's height.
    const std::array<double, 3> fall = {(inverse.row(0) + inverse.row(1)).norm(), inverse.row(0).norm(),
                                        inverse.row(1).norm()};
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const Vector2d centre(x + 0.5, y + 0.5);
        const Vector2d b = inverse * (centre - corner[0]);
        const double outside =
            std::max({-(1.0 - b.x() - b.y()) / fall[0], -b.x() / fall[1], -b.y() / fall[2]});
        if (outside > margin) continue;
        const auto near = outside <= 0.0 ? 1.0F : static_cast<float>(0.9 - 0.1 * outside);
        const std::size_t pixel =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
        if (near > texels[pixel].near) texels[pixel] = {near, static_cast<std::int32_t>(t)};
      }
    }
  }

  parallel_for(0, static_cast<std::size_t>(height), [&](std::size_t y) {
    for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x) {
      const std::size_t pixel = y * static_cast<std::size_t>(width) + x;
      if (texels[pixel].triangle < 0) continue;
      const Map& map = maps[static_cast<std::size_t>(texels[pixel].triangle)];
      Vector3d color = Vector3d::Zero();
      constexpr int samples = 3;
      for (int i = 0; i < samples * samples; ++i) {
        const Vector2d at(static_cast<double>(x) + (i % samples + 0.5) / samples,
                          static_cast<double>(y) + (i / samples + 0.5) / samples);
        color += pattern_color(pattern, map.place + map.cloth_from_pixel * (at - map.pixel));
      }
      color /= samples * samples;
      const double light =
          std::clamp(1.0 + contrast * (luminance(image, pixel) / mean - 1.0), darkest, lightest);
      for (std::size_t c = 0; c < 3; ++c) {
        image.rgb[3 * pixel + c] = byte(light * color[static_cast<Eigen::Index>(c)]);
      }
    }
  });
}

}  // namespace reprise::body
