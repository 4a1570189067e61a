// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Shape-colour dissimilarity of frames: the earth mover's distance of their histograms, least over all turns
// about the vertical axis (HSSMG Eq. 1).

#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "reprise/similarity/dissimilarity_matrix.h"
#include "reprise/similarity/earth_movers_distance.h"
#include "reprise/similarity/shape_color_histogram.h"

namespace reprise {

// Frames [a_first, a_last) of one clip against [b_first, b_last) of the same or a later one, indices over all
// frames. Its pairs are those with a < b.
struct FrameTile {
  std::size_t a_first = 0, a_last = 0;
  std::size_t b_first = 0, b_last = 0;
  bool operator==(const FrameTile&) const = default;
};

// Transport problems solved to find the values of a matrix.
struct SearchStatistics {
  std::uint64_t exact_solves = 0;  // to the optimum
  std::uint64_t cut_solves = 0;    // left once they were proved not to matter
  SearchStatistics& operator+=(const SearchStatistics& other) {
    exact_solves += other.exact_solves;
    cut_solves += other.cut_solves;
    return *this;
  }
};

class ShapeColorMetric {
 public:
  // Cuts all frames into voxels. Throws what `ShapeColorHistograms` throws.
  ShapeColorMetric(const PerformanceDatabase& database, const HistogramOptions& options = {});

  const ShapeColorHistograms& histograms() const { return histograms_; }

  // All pairs of frames of these clips, cut into tiles.
  static std::vector<FrameTile> tiles(std::span<const std::size_t> clip_frame_counts);

  // Bounds of the pairs of a tile: the value is the exact distance at the most promising turn, the lower
  // bound holds for all turns. A few problems at the middle of the tile are solved at turns all round, then
  // every pair once; each potential bounds all pairs at turns near by. `out`: row by row; entries of a >= b
  // are left alone. Several threads may work on different tiles; the result depends on nothing but the tile.
  // What is learnt about turns is remembered for `exact` (some 60 bytes a pair, up to `max_memory` in all).
  SearchStatistics bound_tile(const FrameTile& tile, std::span<MatrixEntry> out);
  static constexpr std::size_t max_memory = std::size_t{1} << 30;

  // The exact entry (a, b): the least distance over all turns, with that turn (of several equal ones the
  // smallest). Requires a < b. Thread-safe; the result depends on nothing but the arguments.
  MatrixEntry exact(std::size_t a, std::size_t b, SearchStatistics* statistics = nullptr) const;

  // The same by brute force, every turn solved for itself: a proof for tests and benchmarks.
  MatrixEntry brute_force(std::size_t a, std::size_t b, SearchStatistics* statistics = nullptr) const;

 private:
  // What is known of the turns of one pair: the best one tried, and an arc of others that may be better.
  struct KnownTurns {
    double value = 0.0;
    std::int32_t first_bound = 0;  // of TileMemory::bounds, one a position of the arc
    std::int16_t best = 0;
    std::int16_t first = 0;
    std::int16_t count = 0;
  };
  struct TileMemory {
    std::vector<KnownTurns> pairs;      // row by row
    std::vector<std::uint16_t> bounds;  // in units of `bound_unit`, rounded down
    std::size_t columns = 0;
  };
  static constexpr double bound_unit = 4e-6;  // metres

  const TileMemory* memory_of(std::size_t a, std::size_t b) const;
  MatrixEntry entry_at(std::size_t a, std::size_t b, int turn, double lower, double value) const;
  int turn_of_most_overlap(std::size_t a, std::size_t b) const;

  ShapeColorHistograms histograms_;
  std::shared_ptr<const BinGrid> grid_;
  std::vector<std::size_t> tile_start_;  // of every frame: the first one of its row or column of tiles
  mutable std::mutex mutex_;             // of what follows
  std::map<std::pair<std::size_t, std::size_t>, TileMemory> memory_;  // by first frames
  std::size_t memory_size_ = 0;
};

}  // namespace reprise
