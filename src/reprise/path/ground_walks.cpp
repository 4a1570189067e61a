// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/ground_walks.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "reprise/core/interrupt.h"
#include "reprise/path/walk_search.h"

namespace reprise::path_detail {
namespace {

std::size_t first_edge(const StateGraph& graph, std::int32_t node) {
  return static_cast<std::size_t>(graph.first_edge[static_cast<std::size_t>(node)]);
}

// A node and a place on the ground to within `grid` metres and `angle` radians, as a hash.
std::uint64_t place_key(const GroundLabel& label, double grid, double angle) {
  std::uint64_t key = static_cast<std::uint64_t>(label.node);
  const auto add = [&](double value, double size) {
    key = (key ^ (key >> 29)) * 0xbf58476d1ce4e5b9ULL;
    key += static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(value / size)));
  };
  add(label.position.x(), grid);
  add(label.position.y(), grid);
  add(label.yaw, angle);
  return (key ^ (key >> 29)) * 0xbf58476d1ce4e5b9ULL;
}

// How far a complete walk is from keeping the limits; metres, seconds and radians alike.
double violation(const GroundTask& task, const GroundLabel& label) {
  const WalkTargets& targets = task.targets;
  const double frames = label.steps + 1;
  constexpr double seconds_a_frame = 0.04;
  double sum = seconds_a_frame *
                   (std::max(0.0, targets.min_frames - frames) + std::max(0.0, frames - targets.max_frames)) +
               std::max(0.0, targets.min_distance - label.distance) +
               std::max(0.0, label.distance - targets.max_distance);
  if (task.goal) {
    sum += std::max(0.0, task.gap_to_goal(label) - task.goal->position_tolerance);
    if (task.goal->turn) {
      sum += std::max(0.0, std::abs(wrap_angle(label.yaw - *task.goal->turn)) - task.goal->turn_tolerance);
    }
  }
  return sum;
}

// Takes a complete walk over if it is better.
void finish(const GroundTask& task, const std::vector<GroundLabel>& labels, const GroundLabel& last,
            GroundWalk& best) {
  const double cost = task.cost_at_end(last);
  if (cost == infinity) {
    if (!best.nearest || violation(task, last) < violation(task, *best.nearest)) best.nearest = last;
    return;
  }
  if (cost >= best.cost) return;
  best.cost = cost;
  best.edges.assign(1, last.edge);
  for (auto i = static_cast<std::size_t>(last.parent); labels[i].edge >= 0;
       i = static_cast<std::size_t>(labels[i].parent)) {
    best.edges.push_back(labels[i].edge);
  }
  std::reverse(best.edges.begin(), best.edges.end());
}

}  // namespace

bool beam_search(const GroundTask& task, const GroundBounds& bounds, const GroundGuide& guide,
                 std::size_t width, std::size_t max_labels, GroundWalk& best) {
  constexpr double grid = 0.2;
  constexpr double angle = 0.2;
  const StateGraph& graph = *task.graph;
  struct Candidate {
    GroundLabel label;
    double promise;
  };
  std::vector<std::vector<Candidate>> open(static_cast<std::size_t>(bounds.horizon()) + 1);
  std::vector<GroundLabel> kept;
  open[0].push_back({task.first_label(), 0.0});
  std::size_t looked_at = 0;
  for (std::vector<Candidate>& candidates : open) {
    throw_if_interrupted();
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.promise < b.promise; });
    std::unordered_set<std::uint64_t> taken;
    for (const Candidate& candidate : candidates) {
      if (taken.size() == width) break;
      if (candidate.label.bound >= best.cost - cost_tolerance) continue;
      if (!taken.insert(place_key(candidate.label, grid, angle)).second) continue;
      const auto parent = static_cast<std::int32_t>(kept.size());
      kept.push_back(candidate.label);
      for (std::size_t i = first_edge(graph, candidate.label.node);
           i < first_edge(graph, candidate.label.node + 1); ++i) {
        ++looked_at;
        GroundLabel next;
        if (candidate.label.steps + graph.edges[i].steps > bounds.horizon()) continue;
        const bool allowed = task.follow(candidate.label, i, next);
        best.farthest_marker = std::max(best.farthest_marker, next.marker);
        if (!allowed) continue;
        next.parent = parent;
        next.edge = static_cast<std::int32_t>(i);
        if (next.node == graph.end()) {
          finish(task, kept, next, best);
          continue;
        }
        next.bound = bounds(next, best.cost);
        if (next.bound >= best.cost - cost_tolerance) continue;
        const double promise = guide(bounds, next, best.cost);
        open[static_cast<std::size_t>(next.steps)].push_back({next, promise});
      }
    }
    std::vector<Candidate>().swap(candidates);
    if (looked_at > max_labels) break;
  }
  best.labels += looked_at;
  return looked_at <= max_labels;
}

namespace {

// Labels met at one node after one number of steps, those near each other together.
class DominationTable {
 public:
  DominationTable(const GroundTask& task, const GroundBounds& bounds) : task_(task), bounds_(bounds) {
    const WalkTargets& targets = task.targets;
    // What may break a limit must be the same, and so must the marker's surroundings.
    same_place_ =
        task.route ||
        (task.goal && (task.goal->position_tolerance < unlimited || task.goal->turn_tolerance < unlimited));
    same_distance_ = targets.min_distance > 0.0 || targets.max_distance < infinity;
  }

  // Whether some label met before can end no worse than this one whatever follows; if not, it is kept to be
  // compared with. Neighbouring cells and long chains are not searched: that costs labels, not truth.
  bool dominated(const std::vector<GroundLabel>& labels, const GroundLabel& label, std::int32_t label_idx) {
    const std::uint64_t key =
        place_key(label, grid, angle) * 0x9e3779b97f4a7c15ULL + static_cast<std::uint64_t>(label.steps);
    const auto [found, inserted] = heads_.try_emplace(key, -1);
    std::int32_t& head = found->second;
    int compared = 0;
    for (std::int32_t i = head; i >= 0 && compared < most_compared; ++compared) {
      const GroundLabel& other = labels[static_cast<std::size_t>(i)];
      if (other.node == label.node && other.steps == label.steps &&
          other.cost + loss(other, label) <= label.cost) {
        return true;
      }
      i = next_[static_cast<std::size_t>(i)];
    }
    next_.resize(static_cast<std::size_t>(label_idx) + 1, -1);
    next_.back() = head;
    head = label_idx;
    return false;
  }

 private:
  static constexpr double grid = 0.05;
  static constexpr double angle = 0.05;
  static constexpr int most_compared = 64;
  // Differences this small are those of rounding.
  static constexpr double same = 1e-12;

  // How much worse than b's a continuation can end with a: both walk alike from then on.
  double loss(const GroundLabel& a, const GroundLabel& b) const {
    const double moved = (a.position - b.position).norm();
    const double turned = std::abs(wrap_angle(a.yaw - b.yaw));
    const double walked = std::abs(a.distance - b.distance);
    if (same_place_ && (moved > same || turned > same || std::abs(a.marker - b.marker) > same))
      return infinity;
    if (same_distance_ && walked > same) return infinity;
    double loss = task_.targets.distance_weight * walked;
    if (task_.goal) {
      loss += task_.position_weight * (moved + 2.0 * std::sin(0.5 * turned) * bounds_.reach(a.node, a.steps));
      if (task_.goal->turn) loss += task_.turn_weight * turned;
    }
    return loss;
  }

  const GroundTask& task_;
  const GroundBounds& bounds_;
  bool same_place_ = false;
  bool same_distance_ = false;
  std::unordered_map<std::uint64_t, std::int32_t> heads_;
  std::vector<std::int32_t> next_;
};

}  // namespace

void prove(const GroundTask& task, const GroundBounds& bounds, std::size_t max_labels, GroundWalk& best) {
  const StateGraph& graph = *task.graph;
  using Entry = std::pair<double, std::int32_t>;  // least bound first, of equal ones the newest
  const auto later = [](const Entry& a, const Entry& b) {
    return a.first > b.first || (a.first == b.first && a.second < b.second);
  };
  std::priority_queue<Entry, std::vector<Entry>, decltype(later)> open(later);
  std::vector<GroundLabel> labels{task.first_label()};
  labels[0].bound = bounds(labels[0], best.cost);
  open.emplace(labels[0].bound, 0);
  DominationTable table(task, bounds);
  std::size_t looked_at = 0;
  while (!open.empty() && looked_at < max_labels) {
    const auto [bound, parent] = open.top();
    if (bound >= best.cost - cost_tolerance) break;
    open.pop();
    if ((looked_at & 0xff) == 0) throw_if_interrupted();
    const GroundLabel label = labels[static_cast<std::size_t>(parent)];
    for (std::size_t i = first_edge(graph, label.node); i < first_edge(graph, label.node + 1); ++i) {
      ++looked_at;
      if (label.steps + graph.edges[i].steps > bounds.horizon()) continue;
      GroundLabel next;
      const bool allowed = task.follow(label, i, next);
      best.farthest_marker = std::max(best.farthest_marker, next.marker);
      if (!allowed) continue;
      next.parent = parent;
      next.edge = static_cast<std::int32_t>(i);
      if (next.node == graph.end()) {
        finish(task, labels, next, best);
        continue;
      }
      // What begins like the child begins like its parent too.
      next.bound = std::max(label.bound, bounds(next, best.cost));
      if (next.bound >= best.cost - cost_tolerance) continue;
      const auto label_idx = static_cast<std::int32_t>(labels.size());
      if (table.dominated(labels, next, label_idx)) continue;
      labels.push_back(next);
      open.emplace(next.bound, label_idx);
    }
  }
  best.labels += looked_at;
  best.lower_bound = open.empty() ? best.cost : std::min(best.cost, open.top().first);
  if (best.lower_bound > best.cost - cost_tolerance) best.lower_bound = best.cost;
}

namespace {

// How long walks may be, in steps.
class Horizon {
 public:
  Horizon(const GroundTask& task, double most_steps) : targets_(task.targets), most_steps_(most_steps) {
    const StateGraph& graph = *task.graph;
    const auto from_start = [&](double cost_weight, double step_weight) {
      return shortest_paths(graph, edge_lengths(graph, cost_weight, 0.0, step_weight));
    };
    const auto start = static_cast<std::size_t>(graph.start);
    least_cost_ = from_start(1.0, 0.0).length[start];
    const double least_steps = from_start(0.0, 1.0).length[start];
    const ShortestPaths longest = from_start(0.0, -1.0);
    if (!longest.negative_cycle) longest_of_graph_ = -longest.length[start];

    // Steps that the way asked for takes at an amble, and some to turn in.
    double way = std::max(targets_.distance, targets_.min_distance);
    if (task.goal) way = std::max(way, task.goal->position.norm());
    if (task.route) way = std::max(way, task.route->length());
    double fastest = 0.0;
    for (const StateEdge& edge : graph.edges) fastest = std::max(fastest, edge.distance / edge.steps);
    const double amble = fastest > 0.0 ? 3.0 * way / fastest : 0.0;
    constexpr double extra_steps = 100.0;
    ample_ = std::max({least_steps, targets_.frames, targets_.min_frames, amble}) + extra_steps;
    if (targets_.max_frames < infinity) ample_ = std::max(ample_, targets_.max_frames);
  }

  // No walk longer than this is allowed and costs less than `cost`.
  double longest(double cost) const {
    double steps = std::min(longest_of_graph_, targets_.max_frames + limit_slack - 1.0);
    if (targets_.time_weight > 0.0 && cost < infinity) {
      steps = std::min(steps, targets_.frames + (cost - least_cost_) / targets_.time_weight);
    }
    return std::max(0.0, std::floor(steps));
  }
  // Where to look first, and where next once a walk of that cost is known. Far longer walks than the way asks
  // for are left to `beyond`, all of them if time costs nothing.
  double first() const { return std::min({ample_, longest(infinity), most_steps_}); }
  double next(double cost) const {
    if (targets_.time_weight == 0.0) return first();
    return std::min({longest(cost), most_steps_, 4.0 * ample_});
  }
  // What walks longer than `steps` cost at least.
  double beyond(double steps) const {
    return least_cost_ + targets_.time_weight * std::max(0.0, steps + 2.0 - targets_.frames);
  }

 private:
  const WalkTargets& targets_;
  double most_steps_;
  double least_cost_ = 0.0;
  double longest_of_graph_ = infinity;
  double ample_ = 0.0;
};

// Beams of growing width.
class WideningBeam {
 public:
  // Goes on until the labels are spent, or beams hold all there is.
  void run(const GroundTask& task, const GroundBounds& bounds, const GroundGuide& guide,
           std::size_t max_labels, GroundWalk& best) {
    const std::size_t last_label = best.labels + max_labels;
    while (best.labels < last_label && !complete_) {
      const std::size_t labels = best.labels;
      if (!beam_search(task, bounds, guide, width_, last_label - labels, best)) return;
      // Nearly as many labels as in a narrower beam: nearly all there are.
      complete_ = 2 * (best.labels - labels) <= 3 * labels_of_last_;
      labels_of_last_ = best.labels - labels;
      width_ *= growth;
    }
  }

 private:
  static constexpr std::size_t first_width = 32;
  static constexpr std::size_t growth = 3;
  std::size_t width_ = first_width;
  std::size_t labels_of_last_ = 0;
  bool complete_ = false;
};

}  // namespace

GroundWalk find_ground_walk(const GroundTask& task, const GroundGuide& guide, std::size_t max_labels) {
  // Tables of more cells than this (some 150 MB) are not made.
  constexpr double most_cells = 1.2e6;
  const Horizon horizon(task, std::floor(most_cells / task.graph->node_count()) - 1.0);
  GroundWalk best;
  double steps = horizon.first();
  constexpr int most_rounds = 3;
  for (int round = 1;; ++round) {
    const GroundBounds bounds(task, static_cast<std::int32_t>(steps));
    WideningBeam beam;
    beam.run(task, bounds, guide, max_labels / 8, best);
    const double next_steps = horizon.next(best.cost);
    if (best.found() && next_steps > steps && round < most_rounds) {
      steps = next_steps;
      continue;
    }
    const auto left = [&] { return max_labels - std::min(max_labels, best.labels); };
    prove(task, bounds, left() / 2, best);
    if (best.lower_bound < best.cost) beam.run(task, bounds, guide, left(), best);
    break;
  }
  if (horizon.longest(best.cost) > steps)
    best.lower_bound = std::min(best.lower_bound, horizon.beyond(steps));
  if (best.lower_bound > best.cost - cost_tolerance) best.lower_bound = best.cost;
  return best;
}

}  // namespace reprise::path_detail
