// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What a partial walk over the ground must still cost at least.

#pragma once

#include <cstdint>
#include <vector>

#include "reprise/path/ground_motion.h"

namespace reprise::path_detail {

// Tables over (node, steps to the end), each the best over all walks that end after exactly so many steps:
// the least and greatest distance, the farthest the centre can get (reach: the sum of the edges'
// displacements, however they turn), and, for several pairs of multipliers (l, n), the least sum of
// transition cost + l distance - n reach.
//
// Why they bound: the cost of distance is at least any tangent l (so far + to come - target) with |l| <=
// w_dist, and the cost of place at least n (gap - reach to come) with 0 <= n <= w_pos, because a walk closes
// no more of the gap than it can reach. Steps to come are gone through one by one, so time costs exactly what
// it costs; turns are free.
class GroundBounds {
 public:
  // For walks of at most `horizon` steps.
  GroundBounds(const GroundTask& task, std::int32_t horizon);

  // No walk of at most `horizon` steps that begins like this costs less; infinite if none keeps the limits,
  // or none costs less than `ceiling`.
  double operator()(const GroundLabel& label, double ceiling) const;
  // The same as if the performer had to walk the rest of the route along the line: not a bound, a guide.
  double guess(const GroundLabel& label, double ceiling) const;

  std::int32_t horizon() const { return horizon_; }
  // Farthest that a walk can get from this node within the steps left.
  double reach(std::int32_t node, std::int32_t steps) const {
    return farthest_[cell(node, horizon_ - steps)];
  }

 private:
  static constexpr int placeless_lanes = 5;  // lanes whose multiplier of reach is 0: the first ones
  struct Entry {
    Lanes cost;  // by multipliers; infinite where no walk ends after so many steps
    double least_distance = infinity;
    double greatest_distance = -infinity;
    double reach = -infinity;
  };

  std::size_t cell(std::int32_t node, std::int32_t to_go) const {
    return static_cast<std::size_t>(node) * static_cast<std::size_t>(horizon_ + 1) +
           static_cast<std::size_t>(to_go);
  }
  void choose_multipliers();
  void fill();
  double least(const GroundLabel& label, double goal_gap, double route_gap, double ceiling) const;

  const GroundTask& task_;
  std::int32_t horizon_;
  Lanes distance_multipliers_ = Lanes::Zero();
  Lanes reach_multipliers_ = Lanes::Zero();
  std::vector<Entry> entries_;
  std::vector<double> farthest_;  // greatest reach within so many steps or fewer
};

}  // namespace reprise::path_detail
