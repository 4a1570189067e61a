// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Exact earth mover's distance of two sparse histograms on one grid (Rubner et al. 1998), with the dual
// solution that proves it.

#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "reprise/similarity/bin_grid.h"
#include "reprise/similarity/shape_color_histogram.h"

namespace reprise {

// A function on bins that never changes faster than the ground distance (Kantorovich). For any two
// histograms, (mean of it over one) - (mean over the other) is at most their earth mover's distance. Given at
// some bins, in `BinGrid::distance_unit`; elsewhere it is the largest such function, the minimum of
// (value + distance) over the `anchors`.
struct Potential {
  std::vector<BinId> bins;  // ascending
  std::vector<std::int32_t> values;
  std::vector<std::int32_t> anchors;  // indices of the bins that determine the function elsewhere

  bool empty() const { return bins.empty(); }
};

// A potential at any bin.
class PotentialFunction {
 public:
  explicit PotentialFunction(std::shared_ptr<const BinGrid> grid) : grid_(std::move(grid)) {}
  // `potential` not empty.
  void set(const Potential& potential);
  // In `BinGrid::distance_unit`: the minimum of (value + distance) over the anchors, which at the bins where
  // the potential is given is what is given.
  std::int64_t operator()(BinId bin);

 private:
  std::shared_ptr<const BinGrid> grid_;
  std::vector<BinGrid::Place> anchors_;
  std::vector<std::int64_t> values_;
  std::vector<std::int32_t> distances_;
};

struct EarthMoversDistance {
  double distance = 0.0;     // metres: the cost of the best transport found
  double lower_bound = 0.0;  // proved by the dual; equal to `distance` unless the search was cut short
  bool exact = true;
};

// Solves problems one after the other in memory that is kept between them; one a thread.
class EarthMoversSolver {
 public:
  explicit EarthMoversSolver(std::shared_ptr<const BinGrid> grid);
  ~EarthMoversSolver();
  EarthMoversSolver(EarthMoversSolver&&) noexcept;
  EarthMoversSolver& operator=(EarthMoversSolver&&) noexcept;

  // Distance of two histograms, each normalised to mass 1. `guess`: the potential of a similar problem, from
  // which the search starts; may be null, and changes nothing but the time (and which of several optimal
  // potentials is found). The search may end once the distance is proved to be above `cutoff` (metres).
  // Throws `InvalidArgument` if a histogram is empty.
  EarthMoversDistance solve(const Signature& a, const Signature& b, const Potential* guess = nullptr,
                            double cutoff = std::numeric_limits<double>::infinity());

  // The potential of the last problem, on the bins of both of its histograms; empty if it was left early.
  const Potential& potential() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace reprise
