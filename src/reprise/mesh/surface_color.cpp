// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/surface_color.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"

namespace reprise {
namespace {

constexpr std::int32_t max_parts = 4096;
constexpr std::size_t max_patches = std::size_t{1} << 26;
// Edge of the equilateral triangle that has the area of the unit square: 2 / 3^(1/4).
constexpr double equal_area_edge = 1.5197;
// Samples along an edge of a patch: one a texel, but not more than this.
constexpr double max_samples = 64.0;

using Uv = Eigen::Vector2d;

std::array<double, 3> texel(const Image& image, const Uv& uv) {
  const double u = uv.x() - std::floor(uv.x());
  const double v = uv.y() - std::floor(uv.y());
  // The top row comes first, v counts from the bottom.
  const int x = std::min(static_cast<int>(u * image.width), image.width - 1);
  const int y = std::min(static_cast<int>((1.0 - v) * image.height), image.height - 1);
  const std::size_t at =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
  return {static_cast<double>(image.rgb[at]), static_cast<double>(image.rgb[at + 1]),
          static_cast<double>(image.rgb[at + 2])};
}

// Longest edge of a triangle.
template <typename Vector>
double longest_edge(const std::array<Vector, 3>& corner) {
  return std::max(
      {(corner[1] - corner[0]).norm(), (corner[2] - corner[1]).norm(), (corner[0] - corner[2]).norm()});
}

// Calls f(row, column, upper) for all parts^2 equal pieces of a triangle. A piece has the corners (row,
// column), (row + 1, column), (row, column + 1) of the lattice, or is the upper one of the two in its square.
template <typename F>
void for_pieces(std::int32_t parts, const F& f) {
  for (std::int32_t row = 0; row < parts; ++row) {
    for (std::int32_t column = 0; row + column < parts; ++column) {
      f(row, column, false);
      if (row + column + 1 < parts) f(row, column, true);
    }
  }
}

// Mean over the texture triangle, sampled at the centroids of equal pieces.
std::array<float, 3> mean_color(const Image& image, const Uv& corner, const Uv& along_row,
                                const Uv& along_column, std::int32_t samples) {
  std::array<double, 3> sum{};
  for_pieces(samples, [&](std::int32_t row, std::int32_t column, bool upper) {
    const double shift = upper ? 2.0 / 3.0 : 1.0 / 3.0;
    const std::array<double, 3> c = texel(
        image, corner + (row + shift) / samples * along_row + (column + shift) / samples * along_column);
    for (std::size_t k = 0; k < 3; ++k) sum[k] += c[k];
  });
  const double scale = 1.0 / (255.0 * samples * samples);
  return {static_cast<float>(sum[0] * scale), static_cast<float>(sum[1] * scale),
          static_cast<float>(sum[2] * scale)};
}

// Number of a piece in the order of `for_pieces`: the rows before it hold 2 (parts - r) - 1 pieces each.
std::size_t piece_index(std::int32_t parts, std::int32_t row, std::int32_t column, bool upper) {
  const std::int64_t before = std::int64_t{2} * parts * row - std::int64_t{row} * row;
  return static_cast<std::size_t>(before + 2 * std::int64_t{column} + (upper ? 1 : 0));
}

}  // namespace

PatchColors::PatchColors(const Topology& topology, std::span<const Eigen::Vector3d> points, double patch_size)
    : vertex_count_(topology.vertex_count), triangles_(topology.triangles) {
  if (!topology.texture || !topology.has_uvs()) {
    throw InvalidArgument("patch colours: expected a topology with a texture, found none");
  }
  if (points.size() != static_cast<std::size_t>(topology.vertex_count)) {
    throw InvalidArgument(
        fmt::format("patch colours: expected {} points, found {}", topology.vertex_count, points.size()));
  }
  for (std::size_t i = 0; i < topology.uvs.size(); ++i) {
    const std::array<float, 2>& uv = topology.uvs[i];
    if (!std::isfinite(uv[0]) || !std::isfinite(uv[1])) {
      throw InvalidArgument(
          fmt::format("texture coordinate {}: expected finite numbers, found ({}, {})", i, uv[0], uv[1]));
    }
  }
  splits_.resize(topology.triangles.size());
  double patches = 0.0;
  for (std::size_t t = 0; t < splits_.size(); ++t) {
    std::array<Eigen::Vector3d, 3> corner;
    for (std::size_t c = 0; c < 3; ++c)
      corner[c] = points[static_cast<std::size_t>(topology.triangles[t][c])];
    areas_.push_back(0.5 * (corner[1] - corner[0]).cross(corner[2] - corner[0]).norm());
    const double parts = std::round(longest_edge(corner) / (equal_area_edge * patch_size));
    splits_[t] = {.first = static_cast<std::size_t>(patches),
                  .parts = static_cast<std::int32_t>(std::clamp(parts, 1.0, double{max_parts}))};
    patches += static_cast<double>(splits_[t].parts) * splits_[t].parts;
    if (patches > static_cast<double>(max_patches)) {
      throw InvalidArgument(fmt::format("a surface needs more than {} patches of {} m: choose larger voxels",
                                        max_patches, patch_size));
    }
  }
  colors_.resize(static_cast<std::size_t>(patches));
  const Image& image = *topology.texture;
  parallel_for(0, splits_.size(), [&](std::size_t t) {
    std::array<Uv, 3> uv;
    std::array<Uv, 3> texels;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::array<float, 2>& given = topology.uvs[static_cast<std::size_t>(topology.triangle_uvs[t][c])];
      uv[c] = {given[0], given[1]};
      texels[c] = {uv[c].x() * image.width, uv[c].y() * image.height};
    }
    const std::int32_t parts = splits_[t].parts;
    const auto samples =
        static_cast<std::int32_t>(std::clamp(std::ceil(longest_edge(texels) / parts), 1.0, max_samples));
    // Rows go along corner 1, columns along corner 2.
    const Uv along_row = (uv[1] - uv[0]) / parts;
    const Uv along_column = (uv[2] - uv[0]) / parts;
    for_pieces(parts, [&](std::int32_t row, std::int32_t column, bool upper) {
      const Uv corner = uv[0] + row * along_row + column * along_column;
      colors_[splits_[t].first + piece_index(parts, row, column, upper)] =
          upper ? mean_color(image, corner + along_row + along_column, -along_row, -along_column, samples)
                : mean_color(image, corner, along_row, along_column, samples);
    });
  });
}

Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> PatchColors::vertex_means() const {
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> sums;
  sums.setZero(vertex_count_, 3);
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(vertex_count_);
  for (std::size_t t = 0; t < splits_.size(); ++t) {
    const std::int32_t parts = splits_[t].parts;
    const double area = areas_[t] / (static_cast<double>(parts) * parts);
    for_pieces(parts, [&](std::int32_t row, std::int32_t column, bool upper) {
      const double shift = upper ? 2.0 / 3.0 : 1.0 / 3.0;
      const double along_row = (row + shift) / parts;
      const double along_column = (column + shift) / parts;
      const std::array<double, 3> corner_weights = {1.0 - along_row - along_column, along_row, along_column};
      const std::array<float, 3>& color = colors_[splits_[t].first + piece_index(parts, row, column, upper)];
      for (std::size_t c = 0; c < 3; ++c) {
        const std::int32_t v = triangles_[t][c];
        const double weight = area * corner_weights[c];
        weights[v] += weight;
        for (Eigen::Index k = 0; k < 3; ++k) sums(v, k) += weight * color[static_cast<std::size_t>(k)];
      }
    });
  }
  for (std::int32_t v = 0; v < vertex_count_; ++v) {
    if (weights[v] > 0.0) sums.row(v) /= weights[v];
  }
  return sums;
}

const std::array<float, 3>& PatchColors::color(std::int32_t triangle, const Eigen::Vector3f& weights) const {
  const Split& split = splits_[static_cast<std::size_t>(triangle)];
  const auto parts = static_cast<float>(split.parts);
  const float along_row = weights[1] * parts;
  const float along_column = weights[2] * parts;
  const std::int32_t row = std::clamp(static_cast<std::int32_t>(along_row), 0, split.parts - 1);
  const std::int32_t column = std::clamp(static_cast<std::int32_t>(along_column), 0, split.parts - 1 - row);
  const float rest = along_row - static_cast<float>(row) + along_column - static_cast<float>(column);
  const bool upper = rest > 1.0F && row + column + 1 < split.parts;
  return colors_[split.first + piece_index(split.parts, row, column, upper)];
}

}  // namespace reprise
