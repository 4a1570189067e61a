// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/ground_bounds.h"

#include <algorithm>
#include <cmath>

#include "reprise/core/interrupt.h"

namespace reprise::path_detail {

GroundBounds::GroundBounds(const GroundTask& task, std::int32_t horizon) : task_(task), horizon_(horizon) {
  choose_multipliers();
  fill();
  farthest_.resize(entries_.size());
  for (std::int32_t node = 0; node < task.graph->node_count(); ++node) {
    double farthest = 0.0;
    for (std::int32_t to_go = 0; to_go <= horizon_; ++to_go) {
      farthest = std::max(farthest, entries_[cell(node, to_go)].reach);
      farthest_[cell(node, to_go)] = farthest;
    }
  }
}

// The root's bound is concave in the multiplier of distance: close in on its peak, then spend the lanes
// around it, and some on reach.
void GroundBounds::choose_multipliers() {
  const double w = task_.targets.distance_weight;
  double low = -w;
  double high = w;
  constexpr int zoom_count = 3;
  for (int round = 0; round < zoom_count && w > 0.0; ++round) {
    distance_multipliers_ = Lanes::LinSpaced(low, high);
    fill();
    Lanes root = Lanes::Constant(infinity);
    for (std::int32_t to_go = 0; to_go <= horizon_; ++to_go) {
      root = root.min(entries_[cell(task_.graph->start, to_go)].cost +
                      task_.targets.time_weight * std::abs(to_go + 1.0 - task_.targets.frames));
    }
    root -= distance_multipliers_ * task_.targets.distance;
    int peak = 0;
    root.maxCoeff(&peak);
    low = distance_multipliers_[std::max(peak - 1, 0)];
    high = distance_multipliers_[std::min(peak + 1, lane_count - 1)];
  }
  const double peak = 0.5 * (low + high);
  static_assert(placeless_lanes == 5 && lane_count == 8);
  distance_multipliers_ << -w, peak - 0.05 * w, peak, peak + 0.05 * w, w, peak, peak, peak;
  distance_multipliers_ = distance_multipliers_.max(-w).min(w);
  const bool has_place = task_.goal.has_value() || task_.route.has_value();
  const double n = has_place ? task_.position_weight : 0.0;
  reach_multipliers_ << 0.0, 0.0, 0.0, 0.0, 0.0, 0.1 * n, 0.3 * n, n;
}

void GroundBounds::fill() {
  const StateGraph& graph = *task_.graph;
  Entry none;
  none.cost = Lanes::Constant(infinity);
  entries_.assign(cell(graph.node_count(), 0), none);
  entries_[cell(graph.end(), 0)] = {Lanes::Zero(), 0.0, 0.0, 0.0};
  std::vector<Lanes> edge_costs(graph.edges.size());
  std::vector<double> edge_reaches(graph.edges.size());
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    edge_reaches[i] = task_.motion.steps[i].displacement.norm();
    edge_costs[i] = graph.edges[i].cost + distance_multipliers_ * graph.edges[i].distance -
                    reach_multipliers_ * edge_reaches[i];
  }
  for (std::int32_t to_go = 1; to_go <= horizon_; ++to_go) {
    throw_if_interrupted();
    for (std::int32_t node = 0; node < graph.end(); ++node) {
      Entry& entry = entries_[cell(node, to_go)];
      for (auto i = static_cast<std::size_t>(graph.first_edge[static_cast<std::size_t>(node)]);
           i < static_cast<std::size_t>(graph.first_edge[static_cast<std::size_t>(node) + 1]); ++i) {
        const StateEdge& edge = graph.edges[i];
        if (edge.steps > to_go) continue;
        const Entry& onward = entries_[cell(edge.target, to_go - edge.steps)];
        if (onward.reach < 0.0) continue;
        entry.cost = entry.cost.min(edge_costs[i] + onward.cost);
        entry.least_distance = std::min(entry.least_distance, edge.distance + onward.least_distance);
        entry.greatest_distance = std::max(entry.greatest_distance, edge.distance + onward.greatest_distance);
        entry.reach = std::max(entry.reach, edge_reaches[i] + onward.reach);
      }
    }
  }
}

double GroundBounds::operator()(const GroundLabel& label, double ceiling) const {
  return least(label, task_.gap_to_goal(label), task_.gap_to_route_end(label), ceiling);
}

double GroundBounds::guess(const GroundLabel& label, double ceiling) const {
  return least(label, task_.gap_to_goal(label), task_.rest_of_route(label), ceiling);
}

double GroundBounds::least(const GroundLabel& label, double goal_gap, double route_gap,
                           double ceiling) const {
  const WalkTargets& targets = task_.targets;
  const double frames = label.steps + 1;
  double first = std::max(0.0, std::ceil(targets.min_frames - frames - limit_slack));
  double last = std::min(static_cast<double>(horizon_ - label.steps),
                         std::floor(targets.max_frames - frames + limit_slack));
  if (targets.time_weight > 0.0) {
    const double affordable = (ceiling - label.cost) / targets.time_weight;
    first = std::max(first, std::ceil(targets.frames - frames - affordable));
    last = std::min(last, std::floor(targets.frames - frames + affordable));
  }
  if (!(first <= last)) return infinity;
  const double tolerance = task_.goal ? task_.goal->position_tolerance + limit_slack : unlimited;
  const Lanes fixed = distance_multipliers_ * (label.distance - targets.distance) +
                      reach_multipliers_ * std::max(goal_gap, route_gap);
  double best = infinity;
  // False where the time alone costs no less than the best: farther from the target it costs more.
  const auto try_ending_after = [&](std::int32_t to_go) {
    const double time = targets.time_weight * std::abs(frames + to_go - targets.frames);
    if (time >= best) return false;
    const Entry& entry = entries_[cell(label.node, to_go)];
    if (entry.reach < 0.0 || goal_gap - entry.reach > tolerance ||
        label.distance + entry.least_distance > targets.max_distance + limit_slack ||
        label.distance + entry.greatest_distance < targets.min_distance - limit_slack) {
      return true;
    }
    const Lanes sums = entry.cost + fixed;
    // The first lanes leave the places out, so what these cost comes on top. Nothing costs less than nothing.
    const double places = task_.position_weight *
                          (std::max(0.0, goal_gap - entry.reach) + std::max(0.0, route_gap - entry.reach));
    const double rest = std::max(sums.head<placeless_lanes>().maxCoeff() + places, sums.maxCoeff());
    best = std::min(best, time + std::max(0.0, rest));
    return true;
  };
  const auto least_to_go = static_cast<std::int32_t>(first);
  const auto most_to_go = static_cast<std::int32_t>(last);
  const auto on_time = static_cast<std::int32_t>(std::clamp(targets.frames - frames, first, last));
  for (std::int32_t i = on_time; i <= most_to_go && try_ending_after(i);) ++i;
  for (std::int32_t i = on_time - 1; i >= least_to_go && try_ending_after(i);) --i;
  return label.cost + best;
}

}  // namespace reprise::path_detail
