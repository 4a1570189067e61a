// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// All walks whose bound is below a threshold, swept in the order of time.

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "reprise/path/walk_bounds.h"

namespace reprise::path_detail {

// Costs of distance and time, and bounds that fit them.
struct WalkProblem {
  WalkProblem(const StateGraph& state_graph, const WalkTargets& targets, double steepness)
      : graph(state_graph), distance(targets, steepness), time(targets) {}

  void use(const WalkBounds& fitting);
  // Of the whole walk, when `cost` was paid for transitions and time beyond the origin.
  double bound(std::int32_t node, std::int64_t to_go, double cost, double walked) const {
    return cost + (bounds->to_come(node, to_go) + bounds->multipliers() * walked - conjugates).maxCoeff();
  }
  double cost_of(const std::vector<std::int32_t>& edges) const;

  const StateGraph& graph;
  DistanceCost distance;
  TimeCost time;
  const WalkBounds* bounds = nullptr;
  Lanes conjugates = Lanes::Zero();
};

// Every edge takes time, so when the sweep comes to a moment all that leads there is known: the partial walks
// (labels) of a node at that moment are compared once, those that another dominates are dropped, and the
// others are followed along each edge together. What an edge leads to shares one row of bounds.
//
// With u = cost + s distance and v = cost - s distance, s the steepest slope of the cost of distance, label A
// dominates B of the same node and moment (cost_A + s |distance_A - distance_B| <= cost_B: whatever follows,
// B cannot do better) exactly if u_A <= u_B and v_A <= v_B. Beyond the origin of time a further step costs
// the same whenever it is made: there labels of different moments are compared as well.
class TimeSweep {
 public:
  struct Result {
    double cost = infinity;           // of the best walk found; infinite if none is below `best_known`
    std::vector<std::int32_t> edges;  // of that walk
    bool complete = false;            // every walk of cost below the threshold was considered
    std::size_t labels = 0;
  };

  // Considers every walk of cost below the lesser of `threshold` and `best_known`, and perhaps others; with
  // `beam` > 0 only that many labels, of least bound, are followed from each moment. Ends incomplete after
  // `max_labels`.
  Result run(const WalkProblem& problem, double threshold, double best_known, std::size_t beam,
             std::size_t max_labels);

 private:
  struct Staged {
    double cost, distance, bound;
    std::int32_t parent, edge, next;
  };
  struct Trace {
    std::int32_t parent, edge;
  };
  struct Step {
    double u, v;
    std::int32_t staged;
  };
  struct Moment {
    std::vector<std::int32_t> first_of_node;  // index into staged_, or -1
    std::vector<std::int32_t> nodes;          // those with labels
  };

  void stage(std::int64_t steps, std::int32_t node, const Staged& label);
  void keep_undominated(std::int32_t node, bool late, double cut);
  bool insert_late(std::int32_t node, const Step& step);
  double beam_cut(const Moment& moment, std::size_t beam);
  void follow(std::int32_t node, std::int64_t steps, double threshold);
  void finish(std::int32_t parent, std::int32_t edge);

  const WalkProblem* problem_ = nullptr;
  double slope_ = 0.0;
  std::size_t staged_left_ = 0;
  Result result_;
  double best_ = infinity;
  std::vector<Moment> moments_;  // a ring over time, as long as the longest edge
  std::vector<Staged> staged_;
  std::vector<Trace> traces_;
  std::vector<Step> steps_;
  std::vector<std::vector<Step>> late_;  // undominated labels of each node beyond the origin of time
  // The labels of one node and moment that are followed, and what an edge makes of them.
  std::vector<double> costs_, distances_, next_bounds_, bounds_;
  std::vector<std::int32_t> kept_;
};

}  // namespace reprise::path_detail
