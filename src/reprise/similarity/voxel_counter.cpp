// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/voxel_counter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/similarity/vertex_metric.h"

namespace reprise {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
// Voxels wound around the wrong way, of those wound around the right way, that are worth a warning: folds of
// captured surfaces have under 1 %.
constexpr double partly_reversed_share = 0.05;

// Whether the colours of vertices say what a texture, the same for all clips, cannot: that clips or frames
// differ.
bool colors_differ(const PerformanceDatabase& database) {
  const std::span<const Color> first = database.clip(0).colors(0);
  for (const MeshSequence& clip : database.clips()) {
    const std::size_t sets = clip.has_colors_per_frame() ? clip.frame_count() : 1;
    for (std::size_t f = 0; f < sets; ++f) {
      if (!std::ranges::equal(clip.colors(f), first)) return true;
    }
  }
  return false;
}

void sort_unique(std::vector<ColorCode>& codes) {
  std::ranges::sort(codes);
  const auto rest = std::ranges::unique(codes);
  codes.erase(rest.begin(), rest.end());
}

// The vertices about their centroid, turned.
std::vector<Eigen::Vector3d> turned(const PositionsView& positions, double yaw) {
  const Eigen::Vector3d middle = centroid(positions);
  const Eigen::Matrix3d R = GroundTransform{.yaw = yaw}.rotation();
  std::vector<Eigen::Vector3d> points(static_cast<std::size_t>(positions.rows()));
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    points[static_cast<std::size_t>(v)] = R * (positions.row(v).transpose().cast<double>() - middle);
  }
  return points;
}

}  // namespace

VoxelCounter::ColorSource VoxelCounter::color_source(const PerformanceDatabase& database,
                                                     const HistogramOptions& options) {
  if (!options.use_color) return ColorSource::none;
  std::vector<std::string> with, without;
  for (const MeshSequence& clip : database.clips()) {
    (clip.has_colors() ? with : without).push_back(clip.name());
  }
  const bool has_texture = database.topology()->texture != nullptr;
  if (without.empty() && (!has_texture || colors_differ(database))) return ColorSource::vertices;
  if (has_texture) return ColorSource::texture;
  if (with.empty()) return ColorSource::none;
  throw InvalidArgument(
      fmt::format("colours of vertices: expected all clips to have them or none, found them in '{}' but not "
                  "in '{}': leave the clips without colours out, or compare by shape alone",
                  fmt::join(with, "', '"), fmt::join(without, "', '")));
}

VoxelCounter::VoxelCounter(const PerformanceDatabase& database, const HistogramOptions& options)
    : database_(database), options_(options), source_(color_source(database, options)) {
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    for (std::size_t f = 0; f < database.clip(c).frame_count(); ++f) ids_.push_back({c, f});
  }
  const PositionsView reference = database.clip(0).frame(0);
  const std::string wrong = degeneracy(*database.topology(), reference);
  if (!wrong.empty()) throw InvalidArgument(fmt::format("{}: {}", name(0), wrong));
  // The reference looks where its horizontally farthest vertex lies.
  const Eigen::Vector3d middle = centroid(reference);
  double farthest = -1.0;
  for (Eigen::Index v = 0; v < reference.rows(); ++v) {
    const Eigen::Vector3d p = reference.row(v).transpose().cast<double>() - middle;
    const double distance = p.x() * p.x() + p.z() * p.z();
    if (distance > farthest) {
      farthest = distance;
      reference_yaw_ = -std::atan2(p.x(), p.z());
    }
  }
  if (source_ == ColorSource::none) return;
  const std::vector<Eigen::Vector3d> points = turned(reference, 0.0);
  nearest_.emplace(database.topology()->triangles, points);
  if (options.color_footprint > 0.0) smoother_.emplace(*database.topology(), points, options.color_footprint);
  if (source_ == ColorSource::texture) {
    PatchColors patches(*database.topology(), points, options.voxel_size);
    if (smoother_) {
      smoother_->smooth(shared_colors_.emplace_back(patches.vertex_means()));
    } else {
      patches_.emplace(std::move(patches));
    }
    return;
  }
  for (const MeshSequence& clip : database.clips()) {
    shared_colors_.push_back(clip.has_colors_per_frame() ? SurfaceSmoother::Values()
                                                         : vertex_colors(clip.colors(0)));
  }
}

FrameMeasure VoxelCounter::measure(std::size_t frame_idx) const {
  const PositionsView positions = frame(frame_idx);
  const std::string wrong = degeneracy(*database_.topology(), positions);
  if (!wrong.empty()) throw InvalidArgument(wrong);
  FrameMeasure measure;
  const GroundAlignment alignment = align_on_ground(database_.clip(0).frame(0), positions);
  measure.yaw = wrap_angle(reference_yaw_ + alignment.a_from_b.yaw);
  const VoxelSolid solid = cut(turned(positions, measure.yaw));
  if (solid.reversed_count() > solid.inside_count()) {
    throw InvalidArgument(fmt::format(
        "the surface is inside out: it winds the wrong way around {} voxels and the right way around {}; "
        "expected corners of triangles counter-clockwise seen from outside; swap two corners of every "
        "triangle",
        solid.reversed_count(), solid.inside_count()));
  }
  measure.partly_reversed = static_cast<double>(solid.reversed_count()) >
                            partly_reversed_share * static_cast<double>(solid.inside_count());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::int32_t cell : solid.voxels()) sum += solid.center(static_cast<std::size_t>(cell));
  measure.center_of_mass = sum / static_cast<double>(solid.voxels().size());
  double farthest = 0.0;
  for (const std::int32_t cell : solid.voxels()) {
    const Eigen::Vector3d p = solid.center(static_cast<std::size_t>(cell)) - measure.center_of_mass;
    farthest = std::max(farthest, (p.cwiseAbs().array() + 0.5 * options_.voxel_size).matrix().squaredNorm());
  }
  measure.radius = std::sqrt(farthest);
  return measure;
}

FrameCount VoxelCounter::count(std::size_t frame_idx, const FrameMeasure& measure, double max_radius) const {
  const std::vector<Eigen::Vector3d> points = turned(frame(frame_idx), measure.yaw);
  const VoxelSolid solid = cut(points);
  std::vector<ColorCode> colors(solid.voxels().size(), 0);
  if (nearest_) colors = colors_of(frame_idx, nearest_->find(solid, points));
  std::vector<std::uint64_t> keys(solid.voxels().size());
  const double rings = options_.radius_bins / max_radius;
  const double polars = options_.polar_bins / std::numbers::pi;
  const int azimuth_count = 2 * options_.azimuth_bins * options_.azimuth_refinement;
  const double azimuths = azimuth_count / two_pi;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const Eigen::Vector3d p =
        solid.center(static_cast<std::size_t>(solid.voxels()[i])) - measure.center_of_mass;
    const double horizontal = std::hypot(p.x(), p.z());
    const int ring = std::min(static_cast<int>(p.norm() * rings), options_.radius_bins - 1);
    const int polar =
        std::min(static_cast<int>(std::atan2(horizontal, p.y()) * polars), options_.polar_bins - 1);
    double phi = std::atan2(p.x(), p.z());
    if (phi < 0.0) phi += two_pi;
    const int azimuth = std::min(static_cast<int>(phi * azimuths), azimuth_count - 1);
    keys[i] = static_cast<std::uint64_t>(ring * options_.polar_bins + polar) << 48 |
              static_cast<std::uint64_t>(azimuth) << 32 | static_cast<std::uint64_t>(colors[i]);
  }
  std::sort(keys.begin(), keys.end());
  FrameCount count;
  for (const std::uint64_t key : keys) count.colors.push_back(static_cast<ColorCode>(key));
  sort_unique(count.colors);
  constexpr std::size_t max_colors = std::numeric_limits<std::uint16_t>::max();
  if (count.colors.size() > max_colors) {
    throw InvalidArgument(fmt::format("{} colours occur, expected at most {}: take fewer colour bins",
                                      count.colors.size(), max_colors));
  }
  for (std::size_t i = 0; i < keys.size(); ++i) {
    // What 16 bits cannot count goes on in an entry of the same bin.
    if (i > 0 && keys[i] == keys[i - 1] &&
        count.entries.back().count < std::numeric_limits<std::uint16_t>::max()) {
      ++count.entries.back().count;
      continue;
    }
    const auto color = std::ranges::lower_bound(count.colors, static_cast<ColorCode>(keys[i]));
    count.entries.push_back({.cell_ring = static_cast<std::uint16_t>(keys[i] >> 48),
                             .azimuth = static_cast<std::uint16_t>(keys[i] >> 32),
                             .color = static_cast<std::uint16_t>(color - count.colors.begin()),
                             .count = 1});
  }
  return count;
}

BinGrid::ColorBin VoxelCounter::color_bin(ColorCode code) const {
  const auto green = static_cast<ColorCode>(options_.color_bins[1]);
  const auto blue = static_cast<ColorCode>(options_.color_bins[2]);
  return {static_cast<std::uint16_t>(code / (green * blue)), static_cast<std::uint16_t>(code / blue % green),
          static_cast<std::uint16_t>(code % blue)};
}

PositionsView VoxelCounter::frame(std::size_t frame_idx) const {
  return database_.clip(ids_[frame_idx].clip_idx).frame(ids_[frame_idx].frame_idx);
}

VoxelSolid VoxelCounter::cut(const std::vector<Eigen::Vector3d>& points) const {
  return {points, database_.topology()->triangles, Eigen::Vector3d::Zero(), options_.voxel_size};
}

SurfaceSmoother::Values VoxelCounter::vertex_colors(std::span<const Color> colors) const {
  SurfaceSmoother::Values values(static_cast<Eigen::Index>(colors.size()), 3);
  for (std::size_t v = 0; v < colors.size(); ++v) {
    for (std::size_t k = 0; k < 3; ++k) {
      values(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(k)) = colors[v][k] / 255.0;
    }
  }
  if (smoother_) smoother_->smooth(values);
  return values;
}

std::vector<ColorCode> VoxelCounter::colors_of(std::size_t frame_idx,
                                               std::span<const TrianglePoint> places) const {
  std::vector<ColorCode> codes(places.size());
  if (patches_) {
    std::ranges::transform(places, codes.begin(), [&](const TrianglePoint& place) {
      return color_code(patches_->color(place.triangle, place.weights));
    });
    return codes;
  }
  const FrameId id = ids_[frame_idx];
  const MeshSequence& clip = database_.clip(id.clip_idx);
  const bool of_frame = source_ == ColorSource::vertices && clip.has_colors_per_frame();
  const SurfaceSmoother::Values own =
      of_frame ? vertex_colors(clip.colors(id.frame_idx)) : SurfaceSmoother::Values();
  const SurfaceSmoother::Values& values =
      of_frame ? own : shared_colors_[source_ == ColorSource::vertices ? id.clip_idx : 0];
  std::ranges::transform(places, codes.begin(), [&](const TrianglePoint& place) {
    const Triangle& triangle = database_.topology()->triangles[static_cast<std::size_t>(place.triangle)];
    std::array<float, 3> color{};
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t k = 0; k < 3; ++k) {
        color[k] += place.weights[static_cast<Eigen::Index>(c)] *
                    static_cast<float>(values(triangle[c], static_cast<Eigen::Index>(k)));
      }
    }
    return color_code(color);
  });
  return codes;
}

ColorCode VoxelCounter::color_code(const std::array<float, 3>& color) const {
  ColorCode code = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const int bins = options_.color_bins[k];
    const int bin = std::clamp(static_cast<int>(color[k] * static_cast<float>(bins)), 0, bins - 1);
    code = code * static_cast<ColorCode>(bins) + static_cast<ColorCode>(bin);
  }
  return code;
}

}  // namespace reprise
