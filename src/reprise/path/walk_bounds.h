// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Lower bounds on what is still to come of a walk, and what its distance and time will cost.

#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "reprise/path/state_graph.h"

namespace reprise::path_detail {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

// What is asked of a walk. Frames count the first one: a walk of s steps has s + 1.
struct WalkTargets {
  double distance = 0.0;  // metres
  double frames = 0.0;
  double distance_weight = 0.0;  // >= 0
  double time_weight = 0.0;      // >= 0
  // Hard limits.
  double min_distance = 0.0;
  double max_distance = infinity;
  double min_frames = 0.0;
  double max_frames = infinity;
};

// weight |distance - target|, and `steepness` more per metre outside of the limits: convex, so that it is the
// greatest of its tangents.
class DistanceCost {
 public:
  DistanceCost(const WalkTargets& targets, double steepness);

  double operator()(double distance) const;
  // Its least and greatest slope, and the greater of their sizes: two distances differ in cost by no more
  // than that times their difference.
  double least_slope() const { return min_ > 0.0 ? -weight_ - steepness_ : -weight_; }
  double greatest_slope() const { return max_ < infinity ? weight_ + steepness_ : weight_; }
  double steepest_slope() const { return std::max(-least_slope(), greatest_slope()); }
  // The tangent of slope l, least_slope() <= l <= greatest_slope(), is l distance - conjugate(l).
  double conjugate(double slope) const;

 private:
  double weight_, target_, steepness_, min_, max_;
};

// What the time of a walk costs, seen from its end. `origin` is the number of steps from which on every
// further step costs the same (or none is allowed): walks that have taken more are counted as having
// `origin`, and pay as they go.
struct TimeCost {
  explicit TimeCost(const WalkTargets& targets);

  // Of ending with `to_go` >= 0 steps left to the origin.
  double at_end(std::int64_t to_go) const;
  // Of a walk of so many steps.
  double at(std::int64_t steps) const;

  std::int64_t origin = 0;
  double per_extra_step = 0.0;  // infinite if there is a greatest time
  double weight = 0.0;
  double offset = 0.0;          // origin + 1 - target frames
  std::int64_t most_to_go = 0;  // with more steps left than this the walk would be too short
  bool operator==(const TimeCost&) const = default;
};

// Multipliers a bound is made of: eight doubles fill one cache line.
inline constexpr int lane_count = 8;
using Lanes = Eigen::Array<double, lane_count, 1>;

// For every node and number of steps to go to the origin of time: the least sum of edge costs, time and l
// times distance over all ways to the end, one lane for each multiplier l.
//
// Why this bounds: the cost of distance is convex, so it is at least any tangent l (so far + to come) -
// conjugate(l); of that, "l to come" is in the table. The best lane counts. Because no |l| exceeds the
// steepest slope, a label that dominates another never has the greater bound.
//
// Rows are kept up to a limit of memory. Beyond it the table goes on as a line: with m no greater than the
// least mean length of a loop a step, and h the shortest ways under lengths reduced by m a step, h + m steps
// satisfies the table's own recurrence; lowered until it is below the last rows it is below all that follow.
class WalkBounds {
 public:
  // Rows for 0 .. `most_steps_to_go`.
  WalkBounds(const StateGraph& graph, const TimeCost& time, std::int64_t most_steps_to_go,
             const Lanes& multipliers);

  const Lanes& multipliers() const { return multipliers_; }
  Lanes to_come(std::int32_t node, std::int64_t steps_to_go) const {
    const auto column = static_cast<std::size_t>(node);
    if (steps_to_go < row_count_) return rows_[static_cast<std::size_t>(steps_to_go) * node_count_ + column];
    return line_[column] + slope_ * static_cast<double>(steps_to_go);
  }

 private:
  void fill_first_row(const StateGraph& graph, const TimeCost& time);
  void fill_line(const StateGraph& graph, const TimeCost& time);
  const Lanes& row(std::size_t node, std::int64_t steps_to_go) const {
    return rows_[static_cast<std::size_t>(steps_to_go) * node_count_ + node];
  }

  Lanes multipliers_;
  std::size_t node_count_;
  std::int64_t row_count_;
  std::vector<Lanes> rows_;
  Lanes slope_ = Lanes::Zero();
  std::vector<Lanes> line_;  // empty if there are rows for all
};

// Steps of the longest edge, at least 1.
std::int64_t longest_edge(const StateGraph& graph);

// Least sum of `lengths` (one an edge) from each node to the end, and the edge to take.
struct ShortestPaths {
  std::vector<double> length;
  std::vector<std::int32_t> next;
  bool negative_cycle = false;
};
ShortestPaths shortest_paths(const StateGraph& graph, const std::vector<double>& lengths);

// Edge lengths: cost_weight cost + l distance + m steps.
std::vector<double> edge_lengths(const StateGraph& graph, double cost_weight, double l, double m);

// The least multiplier in [least, 0] (to the precision of a bisection) at which no loop of the graph pays for
// itself when a step costs `per_step`.
double least_multiplier(const StateGraph& graph, double per_step, double least);

}  // namespace reprise::path_detail
