// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Cuts single frames of a database into coloured voxels and counts them; `ShapeColorHistograms` puts them
// together.

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "reprise/mesh/surface_color.h"
#include "reprise/mesh/surface_smoothing.h"
#include "reprise/mesh/voxel_nearest.h"
#include "reprise/mesh/voxel_solid.h"
#include "reprise/similarity/shape_color_histogram.h"

namespace reprise {

// A colour bin as one number: (R * bins of G + G) * bins of B + B.
using ColorCode = std::uint32_t;

// What can be known of a frame by itself.
struct FrameMeasure {
  double yaw = 0.0;                                          // see FineHistogram
  Eigen::Vector3d center_of_mass = Eigen::Vector3d::Zero();  // of the turned frame about its vertex centroid
  double radius = 0.0;                                       // from there to the farthest corner of a voxel
  bool partly_reversed = false;                              // part of the surface is inside out
};

// A histogram before the palette of the database is known: its entries number the colours of the frame.
struct FrameCount {
  std::vector<FineHistogram::Entry> entries;
  std::vector<ColorCode> colors;  // ascending
};

class VoxelCounter {
 public:
  // Both are referred to afterwards. Throws `InvalidArgument` if some clips have colours and others have not,
  // and what `PatchColors` throws.
  VoxelCounter(const PerformanceDatabase& database, const HistogramOptions& options);

  std::size_t frame_count() const { return ids_.size(); }
  std::string name(std::size_t frame_idx) const { return database_.to_string(ids_[frame_idx]); }

  // Throw `InvalidArgument` for a frame that is not finite, has no area or is inside out, for more voxels
  // than memory should hold, and for too many colours. Const and thread-safe.
  FrameMeasure measure(std::size_t frame_idx) const;
  FrameCount count(std::size_t frame_idx, const FrameMeasure& measure, double max_radius) const;

  BinGrid::ColorBin color_bin(ColorCode code) const;

 private:
  // Where the colours of a database come from.
  enum class ColorSource { none, texture, vertices };

  static ColorSource color_source(const PerformanceDatabase& database, const HistogramOptions& options);
  PositionsView frame(std::size_t frame_idx) const;
  VoxelSolid cut(const std::vector<Eigen::Vector3d>& points) const;
  // Colours of the vertices of a frame, averaged, from 0 to 1.
  SurfaceSmoother::Values vertex_colors(std::span<const Color> colors) const;
  std::vector<ColorCode> colors_of(std::size_t frame_idx, std::span<const TrianglePoint> places) const;
  ColorCode color_code(const std::array<float, 3>& color) const;

  const PerformanceDatabase& database_;
  const HistogramOptions& options_;
  ColorSource source_;
  std::vector<FrameId> ids_;  // of all frames
  double reference_yaw_ = 0.0;
  std::optional<NearestSurface> nearest_;  // nothing where there is one colour
  std::optional<SurfaceSmoother> smoother_;
  std::optional<PatchColors> patches_;                  // of the texture as it is
  std::vector<SurfaceSmoother::Values> shared_colors_;  // of vertices: one for all clips, or one a clip
};

}  // namespace reprise
