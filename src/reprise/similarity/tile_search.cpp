// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/tile_search.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace reprise {
namespace {

// Bounds are differences of rounded means: more than they can be wrong by, metres.
constexpr double rounding = 1e-12;

}  // namespace

TileSearch::TileSearch(const ShapeColorHistograms& histograms, const FrameTile& tile)
    : histograms_(histograms),
      tile_(tile),
      turns_(histograms.grid().turn_count()),
      rows_(tile.a_last - tile.a_first),
      columns_(tile.b_last - tile.b_first),
      solver_(histograms.shared_grid()),
      table_(histograms.shared_grid()),
      lower_(rows_ * columns_ * static_cast<std::size_t>(turns_), 0.0),
      best_(rows_ * columns_) {
  for (std::size_t a = tile.a_first; a < tile.a_last; ++a) frames_a_.emplace_back(histograms, a);
  for (std::size_t b = tile.b_first; b < tile.b_last; ++b) frames_b_.emplace_back(histograms, b);
}

std::span<double> TileSearch::bounds(std::size_t pair) {
  return std::span(lower_).subspan(pair * static_cast<std::size_t>(turns_), static_cast<std::size_t>(turns_));
}

bool TileSearch::solve(std::size_t row, std::size_t column, int position, const Potential* guess, int reach,
                       double cutoff) {
  const int place = wrapped(position);
  const int turn = histograms_.grid().turn_at(place);
  histograms_.signature(tile_.a_first + row, -turn, turned_a_);
  histograms_.signature(tile_.b_first + column, turn, turned_b_);
  const EarthMoversDistance result = solver_.solve(turned_a_, turned_b_, guess, cutoff);
  if (!result.exact) {
    ++statistics_.cut_solves;
    return false;
  }
  ++statistics_.exact_solves;
  Best& best = best_[pair(row, column)];
  const auto size_of = [&](int p) {
    return std::pair(std::abs(histograms_.grid().turn_at(p)), histograms_.grid().turn_at(p));
  };
  if (result.distance < best.value ||
      (result.distance == best.value && size_of(place) < size_of(best.position))) {
    best = {result.distance, place};
  }
  table_.set(solver_.potential());
  for (int near = position - reach; near <= position + reach; ++near) tighten(wrapped(near));
  bounds(pair(row, column))[static_cast<std::size_t>(place)] = result.distance;
  return true;
}

void TileSearch::tighten(int position) {
  const int turn = histograms_.grid().turn_at(position);
  means_b_.clear();
  for (const TurnedFrame& frame : frames_b_) means_b_.push_back(table_.mean(frame, turn));
  for (std::size_t row = 0; row < rows_; ++row) {
    const double mean_a = table_.mean(frames_a_[row], -turn);
    for (std::size_t column = 0; column < columns_; ++column) {
      double& bound = bounds(pair(row, column))[static_cast<std::size_t>(position)];
      bound = std::max(bound, mean_a - means_b_[column] - rounding);
    }
  }
}

}  // namespace reprise
