// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/walk_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <Eigen/Core>

#include "reprise/core/interrupt.h"

namespace reprise::path_detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Frames after which walks are no longer followed when nothing else ends them.
constexpr std::int64_t most_steps = 1'000'000'000;

// Multipliers a bound is made of: eight doubles fill one cache line.
constexpr int lane_count = 8;
using Lanes = Eigen::Array<double, lane_count, 1>;

double cost_of(const WalkTargets& targets, double transition_cost, double distance, std::int64_t steps) {
  return transition_cost + targets.distance_weight * std::abs(distance - targets.distance) +
         targets.time_weight * std::abs(static_cast<double>(steps + 1) - targets.frames);
}

// Least sum of `lengths` (one an edge) from each node to the end, and the edge to take.
struct ShortestPaths {
  std::vector<double> length;
  std::vector<std::int32_t> next;
  bool negative_cycle = false;
};

ShortestPaths shortest_paths(const StateGraph& graph, std::span<const double> lengths) {
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

// Edge lengths: transition cost + lambda distance + mu steps.
std::vector<double> edge_lengths(const StateGraph& graph, double cost_weight, double lambda, double mu) {
  std::vector<double> lengths;
  lengths.reserve(graph.edges.size());
  for (const StateEdge& edge : graph.edges) {
    lengths.push_back(cost_weight * edge.cost + lambda * edge.distance +
                      mu * static_cast<double>(edge.steps));
  }
  return lengths;
}

// Both bounds rest on w |x| = max of l x over -w <= l <= w: for any fixed l in that range, the least sum of
// cost + l distance over all ways to go on, plus l (distance so far - target), is at most the true cost. Each
// lane is one l; the bound is the best lane's. Because every |l| <= w_dist, two labels in the same state have
// bounds that differ by no more than their costs and w_dist times their distances do: a label that dominates
// another never has the greater bound.

// One table over (frames elapsed, node): the penalty on time is met exactly, frame by frame.
class TimedBound {
 public:
  TimedBound(const StateGraph& graph, const WalkTargets& targets, std::int64_t horizon)
      : graph_(graph),
        targets_(targets),
        node_count_(static_cast<std::size_t>(graph.node_count())),
        horizon_(horizon),
        table_((static_cast<std::size_t>(horizon) + 1) * node_count_) {
    // The root's bound is concave in l: close in on its peak, then spend the lanes around it, the wider apart
    // the farther off, because what is left to do asks for other multipliers the more a walk has strayed.
    const double w = targets.distance_weight;
    double low = -w;
    double high = w;
    for (int i = 0; i < zoom_count && w > 0.0; ++i) {
      lambdas_ = Lanes::LinSpaced(low, high);
      fill();
      const Lanes& root = table_[static_cast<std::size_t>(graph.start)];
      int peak = 0;
      for (int lane = 1; lane < lane_count; ++lane) {
        if (root[lane] - lambdas_[lane] * targets.distance > root[peak] - lambdas_[peak] * targets.distance)
          peak = lane;
      }
      low = lambdas_[peak == 0 ? 0 : peak - 1];
      high = lambdas_[std::min(peak + 1, lane_count - 1)];
    }
    const double peak = 0.5 * (low + high);
    lambdas_ << -w, peak - 0.12 * w, peak - 0.03 * w, peak, peak + 0.03 * w, peak + 0.12 * w, w, 0.0;
    lambdas_ = lambdas_.max(-w).min(w);
    fill();
  }

  double operator()(std::int32_t node, std::int64_t steps, double cost, double distance) const {
    const Lanes& lanes =
        table_[static_cast<std::size_t>(steps) * node_count_ + static_cast<std::size_t>(node)];
    const double excess = distance - targets_.distance;
    return cost + (lanes + lambdas_ * excess).maxCoeff();
  }

 private:
  static constexpr int zoom_count = 4;

  void fill() {
    std::vector<Lanes> edge_lanes(graph_.edges.size());
    for (std::size_t i = 0; i < graph_.edges.size(); ++i) {
      edge_lanes[i] = graph_.edges[i].cost + lambdas_ * graph_.edges[i].distance;
    }
    for (std::int64_t steps = horizon_; steps >= 0; --steps) {
      Lanes* row = &table_[static_cast<std::size_t>(steps) * node_count_];
      row[node_count_ - 1].setConstant(targets_.time_weight *
                                       std::abs(static_cast<double>(steps + 1) - targets_.frames));
      for (std::size_t node = 0; node + 1 < node_count_; ++node) {
        Lanes best = Lanes::Constant(infinity);
        for (auto i = static_cast<std::size_t>(graph_.first_edge[node]);
             i < static_cast<std::size_t>(graph_.first_edge[node + 1]); ++i) {
          const StateEdge& edge = graph_.edges[i];
          if (steps + edge.steps > horizon_) continue;
          const Lanes& onward =
              row[static_cast<std::size_t>(edge.steps) * node_count_ + static_cast<std::size_t>(edge.target)];
          best = best.min(edge_lanes[i] + onward);
        }
        row[node] = best;
      }
    }
  }

  const StateGraph& graph_;
  const WalkTargets& targets_;
  std::size_t node_count_;
  std::int64_t horizon_;
  Lanes lambdas_ = Lanes::Zero();
  std::vector<Lanes> table_;
};

// One row a node, whatever has elapsed: for queries in which time has no weight. A negative l rewards going
// on, so it may grow only until some loop of the graph would pay for itself.
class TimelessBound {
 public:
  TimelessBound(const StateGraph& graph, const WalkTargets& targets) : target_distance_(targets.distance) {
    const double w = targets.distance_weight;
    const double reward = w * greatest_reward(graph, w);
    lambdas_ << w, w / 2, w / 4, 0.0, -reward / 4, -reward / 2, -reward * 3 / 4, -reward;
    table_.resize(static_cast<std::size_t>(graph.node_count()));
    for (int lane = 0; lane < lane_count; ++lane) {
      const ShortestPaths paths = shortest_paths(graph, edge_lengths(graph, 1.0, lambdas_[lane], 0.0));
      for (std::size_t node = 0; node < table_.size(); ++node) table_[node][lane] = paths.length[node];
    }
  }

  double operator()(std::int32_t node, std::int64_t /*steps*/, double cost, double distance) const {
    return cost +
           (table_[static_cast<std::size_t>(node)] + lambdas_ * (distance - target_distance_)).maxCoeff();
  }

 private:
  // The greatest share r <= 1 of the weight (to the precision of a bisection) that as a reward leaves every
  // loop a cost.
  static double greatest_reward(const StateGraph& graph, double weight) {
    const auto pays = [&](double r) {
      return shortest_paths(graph, edge_lengths(graph, 1.0, -r * weight, 0.0)).negative_cycle;
    };
    if (!pays(1.0)) return 1.0;
    double feasible = 0.0;
    double infeasible = 1.0;
    for (int i = 0; i < 20; ++i) {
      const double middle = 0.5 * (feasible + infeasible);
      (pays(middle) ? infeasible : feasible) = middle;
    }
    return feasible;
  }

  double target_distance_;
  Lanes lambdas_ = Lanes::Zero();
  std::vector<Lanes> table_;
};

// A partial walk. Labels meet in cells: one for each (frames elapsed, node) when there is a table over time,
// else one for each node.
constexpr std::int32_t no_label = -1;

struct Label {
  double cost = 0.0;
  double distance = 0.0;
  double u = 0.0;
  double v = 0.0;
  double bound = 0.0;
  std::int64_t steps = 0;
  std::int32_t node = 0;
  std::int32_t parent = -1;
  std::int32_t edge = -1;
  std::int32_t next_in_cell = no_label;  // in no use to labels that have left their cell
};

// Labels by bound, least first; within a bucket the newest first, which dives to the end of a walk and finds
// good ones early. Buckets in place of a heap: the order within 1/4096 of the range decides nothing.
class BucketQueue {
 public:
  BucketQueue(double least, double greatest)
      : least_(least),
        scale_(static_cast<double>(bucket_count) / std::max(greatest - least, 1e-300)),
        buckets_(bucket_count) {}

  void push(double bound, std::int32_t label) {
    const double bucket = std::clamp((bound - least_) * scale_, 0.0, static_cast<double>(bucket_count - 1));
    const auto bucket_idx = static_cast<std::size_t>(bucket);
    current_ = std::min(current_, bucket_idx);
    buckets_[bucket_idx].push_back(label);
  }

  // -1 when empty.
  std::int32_t pop() {
    while (current_ < bucket_count && buckets_[current_].empty()) ++current_;
    if (current_ == bucket_count) return -1;
    const std::int32_t label = buckets_[current_].back();
    buckets_[current_].pop_back();
    return label;
  }

 private:
  static constexpr std::size_t bucket_count = 4096;
  double least_;
  double scale_;
  std::size_t current_ = 0;
  std::vector<std::vector<std::int32_t>> buckets_;
};

template <typename Bound>
class LabelSearch {
 public:
  LabelSearch(const StateGraph& graph, const WalkTargets& targets, const Bound& bound, std::int64_t horizon)
      : graph_(graph), targets_(targets), bound_(bound), horizon_(horizon) {}

  // Follows the least bound from the start to the end: the first walk worth the name.
  void dive(Walk& best) {
    labels_.clear();
    labels_.push_back({.node = graph_.start});
    for (;;) {
      const Label label = labels_.back();
      const auto node = static_cast<std::size_t>(label.node);
      Label least{.bound = infinity};
      for (std::int32_t i = graph_.first_edge[node]; i < graph_.first_edge[node + 1]; ++i) {
        Label next = follow_edge(label, static_cast<std::int32_t>(labels_.size() - 1), i);
        if (next.steps > horizon_) continue;
        next.bound = bound_(next.node, next.steps, next.cost, next.distance);
        if (next.bound < least.bound) least = next;
      }
      if (least.bound >= best.cost) return;
      if (least.node == graph_.end()) return finish(least, best);
      labels_.push_back(least);
    }
  }

  // Improves `best` and returns a lower bound on the cost of all walks of at most `horizon` frames after the
  // first: `best.cost` itself when the search has ended within `budget` labels. With `slack` > 0 a label is
  // also dropped if another is worse by no more than the slack: fast, no certificate (the return value is
  // then of no use).
  double run(Walk& best, double slack, std::size_t budget) {
    labels_.clear();
    const double root = bound_(graph_.start, 0, 0.0, 0.0);
    if (root >= best.cost - cost_tolerance) return best.cost;
    if (budget == 0) return root;
    BucketQueue queue(root, best.cost);
    const bool timed = horizon_ < most_steps;
    cells_.assign(static_cast<std::size_t>((timed ? horizon_ + 1 : 1) * graph_.node_count()), no_label);
    labels_.push_back({.bound = root, .node = graph_.start});
    cells_[static_cast<std::size_t>(graph_.start)] = 0;
    queue.push(root, 0);
    double forgotten = infinity;  // least bound of walks too long to count
    std::size_t popped = 0;
    std::int32_t label_idx = -1;
    comparisons_ = 0;
    // Where many labels share a cell, comparing them is the work: that counts as well, so that a hopeless
    // search ends.
    while (labels_.size() + comparisons_ / comparisons_a_label < budget && (label_idx = queue.pop()) >= 0) {
      if ((++popped & 0xfff) == 0) throw_if_interrupted();
      const Label label = labels_[static_cast<std::size_t>(label_idx)];
      if (label.bound >= best.cost - cost_tolerance) continue;  // dominated labels have an infinite bound
      const auto node = static_cast<std::size_t>(label.node);
      for (std::int32_t i = graph_.first_edge[node]; i < graph_.first_edge[node + 1]; ++i) {
        Label next = follow_edge(label, label_idx, i);
        if (next.node == graph_.end()) {
          finish(next, best);
          continue;
        }
        if (next.steps > horizon_) {
          if (!timed) forgotten = std::min(forgotten, label.bound);
          continue;
        }
        // A child's walks are among its parent's, so the parent's bound holds for it too.
        next.bound = std::max(label.bound, bound_(next.node, next.steps, next.cost, next.distance));
        if (next.bound >= best.cost - cost_tolerance) continue;
        next.u = next.cost + targets_.distance_weight * next.distance;
        next.v = next.cost - targets_.distance_weight * next.distance;
        const std::int64_t cell = (timed ? next.steps * graph_.node_count() : 0) + next.node;
        std::int32_t& head = cells_[static_cast<std::size_t>(cell)];
        if (!insert(head, next, slack)) continue;
        queue.push(next.bound, static_cast<std::int32_t>(labels_.size() - 1));
      }
    }
    double lower_bound = std::min(best.cost, forgotten);
    while ((label_idx = queue.pop()) >= 0) {
      lower_bound = std::min(lower_bound, labels_[static_cast<std::size_t>(label_idx)].bound);
    }
    return lower_bound < best.cost - cost_tolerance ? lower_bound : best.cost;
  }

  std::size_t label_count() const { return labels_.size(); }

 private:
  Label follow_edge(const Label& label, std::int32_t label_idx, std::int32_t edge_idx) const {
    const StateEdge& edge = graph_.edges[static_cast<std::size_t>(edge_idx)];
    return {.cost = label.cost + edge.cost,
            .distance = label.distance + edge.distance,
            .steps = label.steps + edge.steps,
            .node = edge.target,
            .parent = label_idx,
            .edge = edge_idx};
  }

  // Adds the label to its cell and to `labels_` unless another dominates it; labels it dominates leave. With
  // u = cost + w_dist distance and v = cost - w_dist distance, label A dominates B of the same cell
  // (cost_A + w_dist |distance_A - distance_B| <= cost_B) exactly if u_A <= u_B and v_A <= v_B. The
  // undominated labels of a cell are therefore a staircase, u rising and v falling, kept as a list in that
  // order.
  bool insert(std::int32_t& head, Label& label, double slack) {
    std::int32_t* link = &head;
    std::int32_t* place = &head;
    double least_v = infinity;
    while (*link != no_label) {
      Label& other = labels_[static_cast<std::size_t>(*link)];
      ++comparisons_;
      if (other.u > label.u + slack) break;
      least_v = other.v;
      link = &other.next_in_cell;
      if (other.u < label.u) place = link;
    }
    if (least_v <= label.v + slack) return false;
    while (*place != no_label && labels_[static_cast<std::size_t>(*place)].v >= label.v) {
      Label& other = labels_[static_cast<std::size_t>(*place)];
      other.bound = infinity;
      *place = other.next_in_cell;
    }
    label.next_in_cell = *place;
    *place = static_cast<std::int32_t>(labels_.size());
    labels_.push_back(label);
    return true;
  }

  void finish(const Label& last, Walk& best) {
    const double cost = cost_of(targets_, last.cost, last.distance, last.steps);
    if (cost >= best.cost) return;
    best.cost = cost;
    best.edges.assign(1, last.edge);
    for (std::int32_t i = last.parent; labels_[static_cast<std::size_t>(i)].edge >= 0;
         i = labels_[static_cast<std::size_t>(i)].parent) {
      best.edges.push_back(labels_[static_cast<std::size_t>(i)].edge);
    }
    std::reverse(best.edges.begin(), best.edges.end());
  }

  const StateGraph& graph_;
  const WalkTargets& targets_;
  const Bound& bound_;
  std::int64_t horizon_;
  std::vector<Label> labels_;
  static constexpr std::size_t comparisons_a_label = 64;
  std::size_t comparisons_ = 0;
  std::vector<std::int32_t> cells_;  // the first label of each, or no_label
};

double cost_of(const StateGraph& graph, const WalkTargets& targets, const std::vector<std::int32_t>& edges) {
  double transition_cost = 0.0;
  double distance = 0.0;
  std::int64_t steps = 0;
  for (const std::int32_t edge_idx : edges) {
    const StateEdge& edge = graph.edges[static_cast<std::size_t>(edge_idx)];
    transition_cost += edge.cost;
    distance += edge.distance;
    steps += edge.steps;
  }
  return cost_of(targets, transition_cost, distance, steps);
}

// The walk along `paths`, if it is better than `best`.
void follow(const StateGraph& graph, const WalkTargets& targets, const ShortestPaths& paths, Walk& best) {
  std::vector<std::int32_t> edges;
  for (std::int32_t node = graph.start; node != graph.end();) {
    edges.push_back(paths.next[static_cast<std::size_t>(node)]);
    node = graph.edges[static_cast<std::size_t>(edges.back())].target;
  }
  const double cost = cost_of(graph, targets, edges);
  if (cost < best.cost) best = {.edges = std::move(edges), .cost = cost};
}

// A table of more cells than this (256 MB) is not made.
constexpr double most_table_cells = 4e6;

// How much worse a label may be and still displace another when only a good walk is wanted, not a
// certificate.
constexpr double fast_slack = 0.05;

// The search proper; when its labels run out before the proof, a last fifth of them goes to finding a better
// walk.
template <typename Bound>
void search_and_settle(LabelSearch<Bound>& search, std::size_t max_labels, Walk& best) {
  const std::size_t reserved = best.labels + max_labels / 5;
  best.lower_bound = search.run(best, 0.0, max_labels - std::min(max_labels, reserved));
  best.labels += search.label_count();
  if (best.lower_bound == best.cost) return;
  search.run(best, fast_slack, max_labels / 5);
  best.labels += search.label_count();
  if (best.lower_bound > best.cost - cost_tolerance) best.lower_bound = best.cost;
}

}  // namespace

Walk find_cheapest_walk(const StateGraph& graph, const WalkTargets& targets, std::size_t max_labels) {
  const double w_d = targets.distance_weight;
  const double w_t = targets.time_weight;

  // First walks: least cost, fewest frames, least of all three together.
  Walk best;
  best.cost = infinity;
  const ShortestPaths cheapest = shortest_paths(graph, edge_lengths(graph, 1.0, 0.0, 0.0));
  const ShortestPaths briefest = shortest_paths(graph, edge_lengths(graph, 0.0, 0.0, 1.0));
  follow(graph, targets, cheapest, best);
  follow(graph, targets, briefest, best);
  follow(graph, targets, shortest_paths(graph, edge_lengths(graph, 1.0, w_d, w_t)), best);

  // No walk longer than this costs less than `best`: its time alone costs too much. One frame more than that,
  // to cover the rounding.
  const auto longest = [&] {
    return std::max(
        0.0, targets.frames + (best.cost - cheapest.length[static_cast<std::size_t>(graph.start)]) / w_t);
  };
  // Longer walks are of use only if even the dive misses the targets by far.
  constexpr double extra_frames = 64.0;
  double horizon =
      std::max(briefest.length[static_cast<std::size_t>(graph.start)], targets.frames + extra_frames);
  if (w_t > 0.0) horizon = std::min(horizon, longest());
  while (w_t > 0.0 && (horizon + 1.0) * static_cast<double>(graph.node_count()) <= most_table_cells) {
    const auto steps = static_cast<std::int64_t>(horizon);
    const TimedBound bound(graph, targets, steps);
    LabelSearch search(graph, targets, bound, steps);
    search.dive(best);
    horizon = longest();
    if (horizon >= static_cast<double>(steps) + 1.0) continue;
    search_and_settle(search, max_labels, best);
    return best;
  }

  // Time has no weight, or so little that walks of any length compete. Then the optimum without a weight on
  // time is a lower bound, and its walk is at most the cost of its time away from it.
  WalkTargets timeless = targets;
  timeless.time_weight = 0.0;
  Walk walk = best;
  walk.cost = cost_of(graph, timeless, walk.edges);
  const TimelessBound bound(graph, timeless);
  LabelSearch search(graph, timeless, bound, most_steps);
  search.run(walk, fast_slack, max_labels / 8);
  walk.labels = search.label_count();
  search_and_settle(search, max_labels, walk);
  if (w_t == 0.0) return walk;
  walk.cost = cost_of(graph, targets, walk.edges);
  if (best.cost < walk.cost) {
    walk.cost = best.cost;
    walk.edges = best.edges;
  }
  if (walk.lower_bound > walk.cost - cost_tolerance) walk.lower_bound = walk.cost;
  return walk;
}

}  // namespace reprise::path_detail
