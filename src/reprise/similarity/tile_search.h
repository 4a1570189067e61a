// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Bounds of the pairs of one tile at all turns, made tighter by every problem that is solved.

#pragma once

#include <limits>
#include <span>
#include <vector>

#include "reprise/similarity/potential_table.h"
#include "reprise/similarity/shape_color_metric.h"

namespace reprise {

// Turns are named by their position on the circle, 0 to turn_count - 1; pairs by `pair(row, column)`.
class TileSearch {
 public:
  TileSearch(const ShapeColorHistograms& histograms, const FrameTile& tile);

  struct Best {
    double value = std::numeric_limits<double>::infinity();  // metres
    int position = 0;
  };

  std::size_t pair(std::size_t row, std::size_t column) const { return row * columns_ + column; }
  int wrapped(int position) const { return ((position % turns_) + turns_) % turns_; }

  // Solves a pair at a position (any whole number); the potential tightens the bounds of all pairs of the
  // tile up to `reach` positions away. False if the search was left because the distance is above `cutoff`.
  bool solve(std::size_t row, std::size_t column, int position, const Potential* guess, int reach,
             double cutoff = std::numeric_limits<double>::infinity());
  // Of the last problem that was not left.
  const Potential& potential() const { return solver_.potential(); }

  // The least distance found so far; of several equal ones that of the smallest turn.
  const Best& best(std::size_t pair) const { return best_[pair]; }
  void set_best(std::size_t pair, double value, int position) { best_[pair] = {value, position}; }
  // Lower bounds of a pair, metres, one a position.
  std::span<double> bounds(std::size_t pair);
  const SearchStatistics& statistics() const { return statistics_; }

 private:
  void tighten(int position);

  const ShapeColorHistograms& histograms_;
  FrameTile tile_;
  int turns_;
  std::size_t rows_, columns_;
  EarthMoversSolver solver_;
  PotentialTable table_;
  std::vector<TurnedFrame> frames_a_, frames_b_;
  std::vector<double> lower_;  // pairs x turns
  std::vector<Best> best_;
  std::vector<double> means_b_;
  Signature turned_a_, turned_b_;
  SearchStatistics statistics_;
};

}  // namespace reprise
