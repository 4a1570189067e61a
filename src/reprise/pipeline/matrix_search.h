// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// All pairs of frames by a metric whose entries can be bounded before they are computed: shared over threads
// and MPI ranks, kept while it goes on.

#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "reprise/graph/measure_transition.h"
#include "reprise/pipeline/matrix_store.h"
#include "reprise/similarity/shape_color_metric.h"

namespace reprise {

// A metric as the search asks it: `ShapeColorMetric`. Both functions are called from several threads, and
// their results depend on their arguments alone.
struct BoundedMetric {
  // Bounds of the pairs of a tile, row by row; entries of a >= b are left alone. May help `exact` to be fast.
  std::function<SearchStatistics(const FrameTile& tile, std::span<MatrixEntry>)> bound_tile;
  // The exact entry (a, b), a < b.
  std::function<MatrixEntry(std::size_t a, std::size_t b, SearchStatistics&)> exact;
};

// Fills a matrix. What comes out does not depend on the numbers of threads and ranks, nor on how often a run
// was stopped and continued. All ranks call the same functions in the same order. Everything may throw
// `Cancelled`, after keeping what is done, and what the metric throws.
class MatrixSearch {
 public:
  // `matrix`: unknown, or as an earlier run left it; on all ranks the same. Both must outlive the search.
  MatrixSearch(BoundedMetric metric, DissimilarityMatrix& matrix, MatrixStore& store);

  // Bounds of every pair that is unknown.
  void bound_all();
  // Every entry exact. `found`: exact entries of an earlier run.
  void make_all_exact(std::span<const PairEntry> found);
  // Transitions, with the entries they depend on made exact. `found`: exact entries that an earlier search
  // from the same matrix was given before it was stopped.
  std::vector<Transition> find(const PerformanceDatabase& database, const TransitionOptions& options,
                               std::span<const PairEntry> found);

  // Makes exact what transitions asked for by hand depend on. Every rank does it alone.
  void decide(const PerformanceDatabase& database, const TransitionOptions& options,
              std::span<const TransitionRequest> requests);

  // Of all ranks together. All ranks must call it.
  SearchStatistics statistics() const;

 private:
  using IsMissing = std::function<bool(const MatrixEntry&)>;
  using ComputeTile = std::function<SearchStatistics(const FrameTile&, std::span<MatrixEntry>)>;
  using ComputedTile = std::function<void(const FrameTile&, std::span<const MatrixEntry>)>;
  std::vector<FrameTile> missing_tiles(const IsMissing& is_missing) const;
  void fill(const std::string& label, const IsMissing& is_missing, const ComputeTile& compute);
  // Works on tiles until all or, of several ranks, the time is up.
  void work(std::span<const FrameTile> tiles, std::span<std::uint8_t> is_done, const ComputeTile& compute,
            const ComputedTile& computed);
  void exchange(std::span<const FrameTile> tiles, std::span<std::uint8_t> is_done,
                const ComputedTile& computed) const;
  std::vector<Transition> find_share(const PerformanceDatabase& database, const TransitionOptions& options,
                                     const ClipPairFilter& share, std::vector<PairEntry>& found);

  BoundedMetric metric_;
  DissimilarityMatrix& matrix_;
  MatrixStore& store_;
  SearchStatistics statistics_;
};

}  // namespace reprise
