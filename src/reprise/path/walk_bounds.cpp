// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/walk_bounds.h"

#include <algorithm>
#include <cmath>

namespace reprise::path_detail {
namespace {

// Frame counts are whole: a limit that rounding has moved by less than this still means the frame.
constexpr double frame_slack = 1e-6;

// A table of more cells than this (256 MB) is not made.
constexpr double most_cells = 4e6;
}  // namespace

DistanceCost::DistanceCost(const WalkTargets& targets, double steepness)
    : weight_(targets.distance_weight),
      target_(targets.distance),
      steepness_(steepness),
      min_(targets.min_distance),
      max_(targets.max_distance) {}

double DistanceCost::operator()(double distance) const {
  double cost = weight_ * std::abs(distance - target_);
  if (steepness_ > 0.0)
    cost += steepness_ * (std::max(0.0, min_ - distance) + std::max(0.0, distance - max_));
  return cost;
}

double DistanceCost::conjugate(double slope) const {
  // The greatest of slope d - cost(d) is where the cost has a corner.
  double greatest = slope * target_ - (*this)(target_);
  if (steepness_ > 0.0) {
    greatest = std::max(greatest, slope * min_ - (*this)(min_));
    if (max_ < infinity) greatest = std::max(greatest, slope * max_ - (*this)(max_));
  }
  return greatest;
}

TimeCost::TimeCost(const WalkTargets& targets) : weight(targets.time_weight) {
  const double target_steps = weight > 0.0 ? targets.frames - 1.0 : 0.0;
  const auto least = static_cast<std::int64_t>(std::ceil(targets.min_frames - 1.0 - frame_slack));
  if (targets.max_frames < infinity) {
    origin = static_cast<std::int64_t>(std::floor(targets.max_frames - 1.0 + frame_slack));
    per_extra_step = infinity;
  } else {
    origin =
        std::max<std::int64_t>({0, least, static_cast<std::int64_t>(std::ceil(target_steps - frame_slack))});
    per_extra_step = weight;
  }
  offset = static_cast<double>(origin) - target_steps;
  most_to_go = origin - std::max<std::int64_t>(least, 0);
}

double TimeCost::at_end(std::int64_t to_go) const {
  if (to_go > most_to_go) return infinity;
  return weight * std::abs(offset - static_cast<double>(to_go));
}

double TimeCost::at(std::int64_t steps) const {
  if (steps <= origin) return at_end(origin - steps);
  if (per_extra_step == 0.0) return at_end(0);
  return at_end(0) + per_extra_step * static_cast<double>(steps - origin);
}

WalkBounds::WalkBounds(const StateGraph& graph, const TimeCost& time, std::int64_t most_steps_to_go,
                       const Lanes& multipliers)
    : multipliers_(multipliers), node_count_(static_cast<std::size_t>(graph.node_count())) {
  const auto affordable = static_cast<std::int64_t>(most_cells / static_cast<double>(node_count_));
  row_count_ = std::min(most_steps_to_go + 1, std::max(affordable, 2 * longest_edge(graph)));
  rows_.resize(static_cast<std::size_t>(row_count_) * node_count_);
  fill_first_row(graph, time);
  std::vector<Lanes> edge_lanes(graph.edges.size());
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    edge_lanes[i] = graph.edges[i].cost + multipliers_ * graph.edges[i].distance;
  }
  const bool may_exceed = time.per_extra_step < infinity;
  for (std::int64_t to_go = 1; to_go < row_count_; ++to_go) {
    Lanes* filled = &rows_[static_cast<std::size_t>(to_go) * node_count_];
    filled[node_count_ - 1].setConstant(time.at_end(to_go));
    for (std::size_t node = 0; node + 1 < node_count_; ++node) {
      Lanes best = Lanes::Constant(infinity);
      for (auto i = static_cast<std::size_t>(graph.first_edge[node]);
           i < static_cast<std::size_t>(graph.first_edge[node + 1]); ++i) {
        const StateEdge& edge = graph.edges[i];
        const auto target = static_cast<std::size_t>(edge.target);
        if (edge.steps <= to_go) {
          best = best.min(edge_lanes[i] + row(target, to_go - edge.steps));
        } else if (may_exceed) {
          best = best.min(edge_lanes[i] + row(target, 0) +
                          time.per_extra_step * static_cast<double>(edge.steps - to_go));
        }
      }
      filled[node] = best;
    }
  }
  if (row_count_ <= most_steps_to_go) fill_line(graph, time);
}

void WalkBounds::fill_line(const StateGraph& graph, const TimeCost& time) {
  line_.assign(node_count_, Lanes::Constant(infinity));
  const std::int64_t first = row_count_ - longest_edge(graph);
  for (int lane = 0; lane < lane_count; ++lane) {
    const auto reduced = [&](double slope) {
      return shortest_paths(graph, edge_lengths(graph, 1.0, multipliers_[lane], -slope));
    };
    // The end itself costs no more than the weight of time a step.
    slope_[lane] = time.weight;
    ShortestPaths paths = reduced(slope_[lane]);
    if (paths.negative_cycle) {
      double high = slope_[lane];
      double low = -1.0 - std::abs(multipliers_[lane]);  // no one walks a metre a frame
      for (int i = 0; i < 30; ++i) {
        const double middle = 0.5 * (low + high);
        (reduced(middle).negative_cycle ? high : low) = middle;
      }
      slope_[lane] = low;
      paths = reduced(low);
    }
    if (paths.negative_cycle) {
      for (Lanes& column : line_) column[lane] = -infinity;
      continue;
    }
    double lowest = infinity;
    for (std::int64_t to_go = first; to_go < row_count_; ++to_go) {
      for (std::size_t node = 0; node < node_count_; ++node) {
        lowest = std::min(
            lowest, row(node, to_go)[lane] - paths.length[node] - slope_[lane] * static_cast<double>(to_go));
      }
    }
    for (std::size_t node = 0; node < node_count_; ++node) line_[node][lane] = paths.length[node] + lowest;
  }
}

void WalkBounds::fill_first_row(const StateGraph& graph, const TimeCost& time) {
  if (time.per_extra_step == infinity) {
    for (std::size_t node = 0; node + 1 < node_count_; ++node) rows_[node].setConstant(infinity);
    rows_[node_count_ - 1].setConstant(time.at_end(0));
    return;
  }
  for (int lane = 0; lane < lane_count; ++lane) {
    const ShortestPaths paths =
        shortest_paths(graph, edge_lengths(graph, 1.0, multipliers_[lane], time.per_extra_step));
    for (std::size_t node = 0; node < node_count_; ++node) {
      // A loop that pays for itself bounds nothing.
      rows_[node][lane] = paths.negative_cycle ? -infinity : paths.length[node] + time.at_end(0);
    }
  }
}

std::int64_t longest_edge(const StateGraph& graph) {
  std::int64_t longest = 1;
  for (const StateEdge& edge : graph.edges) longest = std::max<std::int64_t>(longest, edge.steps);
  return longest;
}

ShortestPaths shortest_paths(const StateGraph& graph, const std::vector<double>& lengths) {
  const auto count = static_cast<std::size_t>(graph.node_count());
  ShortestPaths paths{std::vector<double>(count, infinity), std::vector<std::int32_t>(count, -1), false};
  paths.length[static_cast<std::size_t>(graph.end())] = 0.0;
  bool changed = true;
  for (std::size_t round = 0; changed && round <= count; ++round) {
    changed = false;
    for (std::size_t node = count - 1; node-- > 0;) {
      for (auto i = static_cast<std::size_t>(graph.first_edge[node]);
           i < static_cast<std::size_t>(graph.first_edge[node + 1]); ++i) {
        const double length = lengths[i] + paths.length[static_cast<std::size_t>(graph.edges[i].target)];
        if (length < paths.length[node]) {
          paths.length[node] = length;
          paths.next[node] = static_cast<std::int32_t>(i);
          changed = true;
        }
      }
    }
  }
  paths.negative_cycle = changed;
  return paths;
}

std::vector<double> edge_lengths(const StateGraph& graph, double cost_weight, double l, double m) {
  std::vector<double> lengths;
  lengths.reserve(graph.edges.size());
  for (const StateEdge& edge : graph.edges) {
    lengths.push_back(cost_weight * edge.cost + l * edge.distance + m * static_cast<double>(edge.steps));
  }
  return lengths;
}

double least_multiplier(const StateGraph& graph, double per_step, double least) {
  const auto pays = [&](double l) {
    return shortest_paths(graph, edge_lengths(graph, 1.0, l, per_step)).negative_cycle;
  };
  if (!pays(least)) return least;
  double feasible = 0.0;
  double infeasible = least;
  for (int i = 0; i < 20; ++i) {
    const double middle = 0.5 * (feasible + infeasible);
    (pays(middle) ? infeasible : feasible) = middle;
  }
  return feasible;
}

}  // namespace reprise::path_detail
