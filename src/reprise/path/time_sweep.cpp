// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/time_sweep.h"

#include <algorithm>

#include "reprise/core/interrupt.h"

namespace reprise::path_detail {
namespace {

constexpr std::int32_t none = -1;

}  // namespace

void WalkProblem::use(const WalkBounds& fitting) {
  bounds = &fitting;
  for (int lane = 0; lane < lane_count; ++lane) {
    conjugates[lane] = distance.conjugate(fitting.multipliers()[lane]);
  }
}

double WalkProblem::cost_of(const std::vector<std::int32_t>& edges) const {
  double cost = 0.0;
  double walked = 0.0;
  std::int64_t steps = 0;
  for (const std::int32_t edge_idx : edges) {
    const StateEdge& edge = graph.edges[static_cast<std::size_t>(edge_idx)];
    cost += edge.cost;
    walked += edge.distance;
    steps += edge.steps;
  }
  return cost + distance(walked) + time.at(steps);
}

void TimeSweep::stage(std::int64_t steps, std::int32_t node, const Staged& label) {
  Moment& moment = moments_[static_cast<std::size_t>(steps) % moments_.size()];
  std::int32_t& first = moment.first_of_node[static_cast<std::size_t>(node)];
  if (first == none) moment.nodes.push_back(node);
  staged_.push_back(label);
  staged_.back().next = first;
  first = static_cast<std::int32_t>(staged_.size() - 1);
  ++staged_left_;
}

// Collects the labels of a node in costs_, distances_, bounds_ and kept_ (their traces), least u first.
void TimeSweep::keep_undominated(std::int32_t node, bool late, double cut) {
  std::ranges::sort(steps_, [](const Step& a, const Step& b) { return a.u != b.u ? a.u < b.u : a.v < b.v; });
  costs_.clear();
  distances_.clear();
  kept_.clear();
  double least_v = infinity;
  for (const Step& step : steps_) {
    if (step.v >= least_v) continue;
    least_v = step.v;
    if (late && !insert_late(node, step)) continue;
    const Staged& label = staged_[static_cast<std::size_t>(step.staged)];
    if (label.bound > cut) continue;
    costs_.push_back(label.cost);
    distances_.push_back(label.distance);
    kept_.push_back(static_cast<std::int32_t>(traces_.size()));
    traces_.push_back({label.parent, label.edge});
  }
}

// Adds a label to the staircase (u rising, v falling) of a node, unless one there dominates it.
bool TimeSweep::insert_late(std::int32_t node, const Step& step) {
  std::vector<Step>& stairs = late_[static_cast<std::size_t>(node)];
  const auto later = std::ranges::upper_bound(stairs, step.u, {}, &Step::u);
  if (later != stairs.begin() && (later - 1)->v <= step.v) return false;
  const auto place = std::ranges::lower_bound(stairs, step.u, {}, &Step::u);
  auto kept = place;
  while (kept != stairs.end() && kept->v >= step.v) ++kept;
  stairs.insert(stairs.erase(place, kept), step);
  return true;
}

double TimeSweep::beam_cut(const Moment& moment, std::size_t beam) {
  bounds_.clear();
  for (const std::int32_t node : moment.nodes) {
    for (std::int32_t i = moment.first_of_node[static_cast<std::size_t>(node)]; i != none;
         i = staged_[static_cast<std::size_t>(i)].next) {
      bounds_.push_back(staged_[static_cast<std::size_t>(i)].bound);
    }
  }
  if (bounds_.size() <= beam) return infinity;
  const auto last = bounds_.begin() + static_cast<std::ptrdiff_t>(beam - 1);
  std::ranges::nth_element(bounds_, last);
  return *last;
}

void TimeSweep::finish(std::int32_t parent, std::int32_t edge) {
  result_.edges.assign(1, edge);
  for (std::int32_t i = parent; traces_[static_cast<std::size_t>(i)].edge != none;
       i = traces_[static_cast<std::size_t>(i)].parent) {
    result_.edges.push_back(traces_[static_cast<std::size_t>(i)].edge);
  }
  std::ranges::reverse(result_.edges);
}

// Follows the kept labels of a node along all its edges.
void TimeSweep::follow(std::int32_t node, std::int64_t steps, double threshold) {
  const WalkProblem& problem = *problem_;
  const StateGraph& graph = problem.graph;
  const std::size_t count = kept_.size();
  next_bounds_.resize(count);
  const auto at = static_cast<std::size_t>(node);
  for (std::int32_t edge_idx = graph.first_edge[at]; edge_idx < graph.first_edge[at + 1]; ++edge_idx) {
    const StateEdge& edge = graph.edges[static_cast<std::size_t>(edge_idx)];
    const std::int64_t then = steps + edge.steps;
    const std::int64_t to_go = problem.time.origin - then;
    double edge_cost = edge.cost;
    if (to_go < 0) {
      const auto extra = static_cast<double>(then - std::max(steps, problem.time.origin));
      if (problem.time.per_extra_step > 0.0) edge_cost += problem.time.per_extra_step * extra;
      if (edge_cost == infinity) continue;
    }
    if (edge.target == graph.end()) {
      const double time_cost = problem.time.at_end(std::max<std::int64_t>(to_go, 0));
      for (std::size_t i = 0; i < count; ++i) {
        const double cost =
            costs_[i] + edge_cost + problem.distance(distances_[i] + edge.distance) + time_cost;
        if (cost >= best_) continue;
        best_ = result_.cost = cost;
        finish(kept_[i], edge_idx);
      }
      continue;
    }
    const Lanes offsets = problem.bounds->to_come(edge.target, std::max<std::int64_t>(to_go, 0)) -
                          problem.conjugates + edge_cost;
    const Lanes& slopes = problem.bounds->multipliers();
    double* const bounds = next_bounds_.data();
    const double* const distances = distances_.data();
    const double* const costs = costs_.data();
    for (std::size_t i = 0; i < count; ++i) {
      const double walked = distances[i] + edge.distance;
      double bound = offsets[0] + slopes[0] * walked;
      for (int lane = 1; lane < lane_count; ++lane) {
        const double other = offsets[lane] + slopes[lane] * walked;
        bound = bound < other ? other : bound;
      }
      bounds[i] = costs[i] + bound;
    }
    const double limit = std::min(threshold, best_);
    for (std::size_t i = 0; i < count; ++i) {
      if (bounds[i] >= limit) continue;
      stage(then, edge.target,
            {costs[i] + edge_cost, distances[i] + edge.distance, bounds[i], kept_[i], edge_idx, none});
    }
  }
}

TimeSweep::Result TimeSweep::run(const WalkProblem& problem, double threshold, double best_known,
                                 std::size_t beam, std::size_t max_labels) {
  problem_ = &problem;
  slope_ = problem.distance.steepest_slope();
  result_ = {};
  best_ = best_known;
  const auto node_count = static_cast<std::size_t>(problem.graph.node_count());
  moments_.resize(static_cast<std::size_t>(longest_edge(problem.graph)) + 1);
  for (Moment& moment : moments_) {
    moment.first_of_node.assign(node_count, none);
    moment.nodes.clear();
  }
  late_.assign(node_count, {});
  staged_.clear();
  traces_.clear();
  staged_left_ = 0;
  stage(0, problem.graph.start, {0.0, 0.0, -infinity, none, none, none});

  std::int64_t steps = 0;
  for (; staged_left_ > 0 && traces_.size() < max_labels; ++steps) {
    if ((steps & 0xf) == 0) throw_if_interrupted();
    Moment& moment = moments_[static_cast<std::size_t>(steps) % moments_.size()];
    const double cut = beam > 0 ? beam_cut(moment, beam) : infinity;
    // Labels staged by this moment go to later ones: the list does not grow meanwhile.
    for (const std::int32_t node : moment.nodes) {
      std::int32_t& first = moment.first_of_node[static_cast<std::size_t>(node)];
      const double limit = std::min(threshold, best_);
      steps_.clear();
      for (std::int32_t i = first; i != none; i = staged_[static_cast<std::size_t>(i)].next) {
        const Staged& label = staged_[static_cast<std::size_t>(i)];
        --staged_left_;
        if (label.bound < limit) {
          steps_.push_back({label.cost + slope_ * label.distance, label.cost - slope_ * label.distance, i});
        }
      }
      first = none;
      if (steps_.empty()) continue;
      keep_undominated(node, steps >= problem.time.origin, cut);
      if (!kept_.empty()) follow(node, steps, threshold);
    }
    moment.nodes.clear();
  }
  result_.complete = staged_left_ == 0 && beam == 0;
  result_.labels = traces_.size();
  return result_;
}

}  // namespace reprise::path_detail
