// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// 6D shape-colour histograms of the frames of a database (HSSMG 4.1).

#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "reprise/database/performance_database.h"
#include "reprise/similarity/bin_grid.h"

namespace reprise {

// Mass per bin, ascending by bin, masses positive.
struct Signature {
  std::vector<BinId> bins;
  std::vector<std::int32_t> masses;
  std::int64_t total = 0;

  std::size_t size() const { return bins.size(); }
};

// Voxels of one frame, counted in bins that are fine about the vertical axis.
struct FineHistogram {
  struct Entry {
    std::uint16_t cell_ring = 0;  // radius * polar_bins + polar
    std::uint16_t azimuth = 0;    // fine: below BinGrid::half_turn_count
    std::uint16_t color = 0;      // of the grid's palette
    std::uint16_t count = 0;
  };
  // Ascending by (cell_ring, azimuth, color). A bin of more voxels than 16 bits count has several entries.
  std::vector<Entry> entries;
  // Yaw that the frame was turned by before it was cut into voxels, radians: onto a direction common to all
  // frames of the database, so that nothing depends on how a clip lies on the ground.
  double yaw = 0.0;
};

// The histograms of all frames, one after the other as in `PerformanceDatabase::first_frame`.
class ShapeColorHistograms {
 public:
  // Voxels are inside where the surface winds around them (averaged over rays along three axes, so that small
  // holes and self-intersections do no harm), or touched by the surface. Each takes the colour of its nearest
  // surface point: of the vertices if all clips have colours and they differ between clips or frames, which a
  // texture common to all cannot show; else of the texture; else of the vertices; else there is one colour.
  // Parallel, with progress; the same for any number of threads. Throws `InvalidArgument` naming clip and
  // frame for a surface that is empty, not finite or inside out, for a clip without colours where others have
  // them, for more voxels than memory should hold, and for options out of range.
  ShapeColorHistograms(const PerformanceDatabase& database, const HistogramOptions& options);

  const BinGrid& grid() const { return *grid_; }
  const std::shared_ptr<const BinGrid>& shared_grid() const { return grid_; }
  std::size_t frame_count() const { return frames_.size(); }
  const FineHistogram& frame(std::size_t frame_idx) const { return frames_[frame_idx]; }

  // The coarse histogram of a frame that was turned by `half_turns` fine bins (any whole number; positive as
  // a positive yaw). `signature` is overwritten.
  void signature(std::size_t frame_idx, int half_turns, Signature& signature) const;

 private:
  std::shared_ptr<const BinGrid> grid_;
  std::vector<FineHistogram> frames_;
};

}  // namespace reprise
