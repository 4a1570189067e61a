// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/walk_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>

#include "reprise/path/time_sweep.h"

namespace reprise::path_detail {
namespace {

// The walk along `paths`, if it is better than `best`.
void follow(const WalkProblem& problem, const ShortestPaths& paths, Walk& best) {
  if (paths.negative_cycle) return;
  std::vector<std::int32_t> edges;
  for (std::int32_t node = problem.graph.start; node != problem.graph.end();) {
    edges.push_back(paths.next[static_cast<std::size_t>(node)]);
    node = problem.graph.edges[static_cast<std::size_t>(edges.back())].target;
  }
  const double cost = problem.cost_of(edges);
  if (cost < best.cost) best = {.edges = std::move(edges), .cost = cost};
}

// Labels followed from each moment while looking for a good walk, and the share of what is between it and the
// bound that is searched first, with its growth: the number of labels grows fast with the threshold, so the
// last sweep is most of the work.
constexpr std::size_t first_beam = 4;
constexpr std::size_t second_beam = 40;
constexpr std::size_t last_beam = 1000;
constexpr double first_reach = 1.0 / 16.0;
constexpr double reach_growth = 1.5;

}  // namespace

// Bounds that were made, by what they depend on. Time without limits looks the same from the end whatever the
// target: such tables serve all targets.
class WalkFinder::Tables {
 public:
  Tables(const StateGraph& graph, double longest) : graph_(graph), longest_(longest) {
    // The cheapest, the briefest, the shortest, and one that minds all three.
    first_walks_ = {shortest_paths(graph, edge_lengths(graph, 1.0, 0.0, 0.0)),
                    shortest_paths(graph, edge_lengths(graph, 0.0, 0.0, 1.0)),
                    shortest_paths(graph, edge_lengths(graph, 0.0, 1.0, 0.0)),
                    shortest_paths(graph, edge_lengths(graph, 1.0, 3.0, 0.1))};
  }

  const std::array<ShortestPaths, 4>& first_walks() const { return first_walks_; }

  // The bound at the root is concave in the multiplier: close in on its peak, level by level, and keep both
  // ends of the range for walks that have strayed.
  std::shared_ptr<const WalkBounds> for_problem(const WalkProblem& problem, const WalkTargets& targets) {
    TimeCost time = problem.time;
    std::int64_t rows = time.origin;
    if (targets.min_frames <= 1.0 && targets.max_frames == infinity) {
      time.origin = 0;
      time.most_to_go = std::numeric_limits<std::int64_t>::max();
      if (time.weight > 0.0) rows = std::max(rows, static_cast<std::int64_t>(std::ceil(longest_)));
    }
    WalkProblem looking = problem;
    const double high = problem.distance.greatest_slope();
    const double low = least(time, problem.distance.least_slope());
    Lanes multipliers = Lanes::LinSpaced(low, high);
    std::shared_ptr<const WalkBounds> bounds;
    // A multiplier beside the peak loses the bound its distance from it times what walks differ in metres.
    const double fine = allowed_loss / (5.0 + targets.distance);
    double spacing = (high - low) / (lane_count - 1);
    for (;;) {
      bounds = made(time, rows, multipliers);
      if (spacing <= fine) return bounds;
      looking.use(*bounds);
      const Lanes root = bounds->to_come(graph_.start, problem.time.origin) - looking.conjugates;
      int peak = 0;
      root.maxCoeff(&peak);
      // Ends of the range are the first and the last lane of every level.
      const double left = multipliers[std::max(peak - 1, 0)];
      const double right = multipliers[std::min(peak + 1, lane_count - 1)];
      spacing = (right - left) / (lane_count - 3);
      for (int lane = 1; lane + 1 < lane_count; ++lane) multipliers[lane] = left + spacing * (lane - 1);
    }
  }

 private:
  static constexpr double allowed_loss = 1.0;  // metres of cost
  struct Key {
    double weight, offset, per_extra_step;
    std::int64_t origin, most_to_go, rows;
    std::array<double, lane_count> multipliers;
    auto operator<=>(const Key&) const = default;
  };
  struct Slot {
    std::once_flag once;
    std::shared_ptr<const WalkBounds> bounds;
  };

  std::shared_ptr<const WalkBounds> made(const TimeCost& time, std::int64_t rows, const Lanes& multipliers) {
    Key key{time.weight, time.offset, time.per_extra_step, time.origin, time.most_to_go, rows, {}};
    std::copy(multipliers.begin(), multipliers.end(), key.multipliers.begin());
    std::shared_ptr<Slot> slot;
    {
      const std::lock_guard lock(mutex_);
      std::shared_ptr<Slot>& there = slots_[key];
      if (!there) there = std::make_shared<Slot>();
      slot = there;
    }
    std::call_once(slot->once, [&] {
      slot->bounds = std::make_shared<const WalkBounds>(graph_, time, rows, multipliers);
    });
    return slot->bounds;
  }

  double least(const TimeCost& time, double slope) {
    if (time.per_extra_step == infinity) return slope;
    const std::lock_guard lock(mutex_);
    const auto [found, is_new] = least_.try_emplace({time.per_extra_step, slope}, 0.0);
    if (is_new) found->second = least_multiplier(graph_, time.per_extra_step, slope);
    return found->second;
  }

  const StateGraph& graph_;
  double longest_;
  std::array<ShortestPaths, 4> first_walks_;
  std::mutex mutex_;
  std::map<Key, std::shared_ptr<Slot>> slots_;
  std::map<std::pair<double, double>, double> least_;
};

WalkFinder::WalkFinder(const StateGraph& graph, double longest)
    : graph_(graph), tables_(std::make_unique<Tables>(graph, longest)) {}

WalkFinder::~WalkFinder() = default;

namespace {

// Sweeps with a rising threshold until every walk below the best one's cost was considered.
void deepen(TimeSweep& sweep, const WalkProblem& problem, std::size_t max_labels, Walk& best) {
  const auto take = [&](TimeSweep::Result&& found) {
    best.labels += found.labels;
    if (found.cost < best.cost) {
      best.cost = found.cost;
      best.edges = std::move(found.edges);
    }
    return found.complete;
  };
  const double root = problem.bound(problem.graph.start, problem.time.origin, 0.0, 0.0);
  best.lower_bound = root;
  if (root == infinity) return;
  best.exhausted = false;
  for (const std::size_t beam : {first_beam, second_beam}) {
    if (best.cost <= root + cost_tolerance) break;
    take(sweep.run(problem, infinity, best.cost, beam, max_labels));
  }
  double reach = first_reach * std::max(best.cost < infinity ? best.cost - root : root, 1e-3);
  while (best.lower_bound < best.cost - cost_tolerance) {
    const double threshold = std::min(root + reach, best.cost);
    const std::size_t left = max_labels - std::min(max_labels, best.labels);
    const bool complete = take(sweep.run(problem, threshold, best.cost, 0, left));
    if (!complete) {
      // The labels ran out before the proof: some more go to finding a better walk.
      take(sweep.run(problem, infinity, best.cost, last_beam, max_labels));
      break;
    }
    best.lower_bound = std::min(threshold, best.cost);
    reach *= reach_growth;
  }
  if (best.lower_bound > best.cost - cost_tolerance) best.lower_bound = best.cost;
}

}  // namespace

Walk WalkFinder::find(const WalkTargets& targets, std::size_t max_labels) const {
  static thread_local TimeSweep sweep;  // its memory serves all searches of a thread
  const bool limited = targets.min_distance > 0.0 || targets.max_distance < infinity;
  std::size_t labels = 0;
  // Slopes outside of the limits: none, then ever steeper ones. An optimum that keeps the limits is the
  // optimum under them, since within them nothing was added and outside of them too little.
  for (double steepness = 0.0;;
       steepness = steepness == 0.0 ? 10.0 * (1.0 + targets.distance_weight) : 100.0 * steepness) {
    WalkProblem problem(graph_, targets, steepness);
    Walk best;
    for (const ShortestPaths& paths : tables_->first_walks()) follow(problem, paths, best);
    const std::shared_ptr<const WalkBounds> bounds = tables_->for_problem(problem, targets);
    problem.use(*bounds);
    deepen(sweep, problem, max_labels, best);
    labels += best.labels;
    best.labels = labels;
    if (!limited || best.edges.empty()) return best;
    double distance = 0.0;
    for (const std::int32_t edge : best.edges) {
      distance += graph_.edges[static_cast<std::size_t>(edge)].distance;
    }
    if (distance >= targets.min_distance - cost_tolerance &&
        distance <= targets.max_distance + cost_tolerance) {
      return best;
    }
    // At the steepest slope a walk that keeps the limits costs less than any that misses them by a
    // micrometre.
    constexpr double steepest = 1e7;
    if (steepness >= steepest) {
      const bool proved = best.lower_bound == best.cost;
      return {.lower_bound = best.lower_bound, .labels = labels, .exhausted = proved};
    }
  }
}

Walk find_cheapest_walk(const StateGraph& graph, const WalkTargets& targets, std::size_t max_labels) {
  return WalkFinder(graph, targets.frames).find(targets, max_labels);
}

}  // namespace reprise::path_detail
