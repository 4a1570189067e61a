// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "paper_decomposition.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <glpk.h>

namespace reprise::benchmark {
namespace {

struct Edge {
  int target = 0;
  int steps = 0;
  double distance = 0.0;
  double cost = 0.0;
};

struct Graph {
  std::vector<std::vector<Edge>> edges;  // of each node
  int first = 0;
  int last = 0;
};

Graph make_graph(const PathMetrics& metrics, const KeyframeQuery& query) {
  std::map<std::pair<std::size_t, int>, int> nodes;  // clip and frame, in order
  for (const Transition& transition : metrics.transitions()) {
    nodes[{transition.source_clip, transition.leave()}] = 0;
  }
  const auto key = [](const FrameId& frame) {
    return std::pair(frame.clip_idx, static_cast<int>(frame.frame_idx));
  };
  for (const FrameId& keyframe : query.keyframes) nodes[key(keyframe)] = 0;
  int count = 0;
  for (auto& [state, node] : nodes) node = count++;
  Graph graph{.edges = std::vector<std::vector<Edge>>(nodes.size())};
  for (auto here = nodes.begin(); here != nodes.end(); ++here) {
    const auto next = std::next(here);
    const auto [clip_idx, frame] = here->first;
    if (next == nodes.end() || next->first.first != clip_idx) continue;
    graph.edges[static_cast<std::size_t>(here->second)].push_back(
        {next->second, next->first.second - frame, metrics.clip_distance(clip_idx, frame, next->first.second),
         0.0});
  }
  for (std::size_t i = 0; i < metrics.transitions().size(); ++i) {
    const Transition& transition = metrics.transitions()[i];
    const auto next = nodes.lower_bound({transition.target_clip, transition.arrive()});
    if (next == nodes.end() || next->first.first != transition.target_clip) continue;
    const int frame = next->first.second;
    graph.edges[static_cast<std::size_t>(nodes.at({transition.source_clip, transition.leave()}))].push_back(
        {next->second, 2 * transition.half_window + frame - transition.arrive(),
         metrics.blend_distance(i) +
             metrics.clip_distance(transition.target_clip, transition.arrive(), frame),
         transition.cost});
  }
  graph.first = nodes.at(key(query.keyframes.front()));
  graph.last = nodes.at(key(query.keyframes.back()));
  return graph;
}

// A walk without loops, or a loop.
struct Piece {
  std::vector<bool> nodes;  // on it
  int steps = 0;
  double distance = 0.0;
  double cost = 0.0;
};

bool meet(const Piece& a, const Piece& b) {
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    if (a.nodes[i] && b.nodes[i]) return true;
  }
  return false;
}

// All ways from one node to another that visit no node twice; with the same node twice, all loops through it.
// Only nodes from `least` on.
class DepthFirstSearch {
 public:
  DepthFirstSearch(const Graph& graph, int to, int least, std::size_t limit, std::vector<Piece>& found)
      : graph_(graph), to_(to), least_(least), limit_(limit), found_(found) {
    piece_.nodes.assign(graph.edges.size(), false);
    leads_there_ = nodes_leading_there();
  }

  // False if there are more than the limit.
  bool run(int from) {
    piece_.nodes[static_cast<std::size_t>(from)] = true;
    return follow(from);
  }

 private:
  bool follow(int node) {
    for (const Edge& edge : graph_.edges[static_cast<std::size_t>(node)]) {
      const auto target = static_cast<std::size_t>(edge.target);
      if (edge.target != to_ && (edge.target < least_ || piece_.nodes[target] || !leads_there_[target])) {
        continue;
      }
      const Piece before = piece_;
      piece_.nodes[target] = true;
      piece_.steps += edge.steps;
      piece_.distance += edge.distance;
      piece_.cost += edge.cost;
      if (edge.target == to_) {
        if (found_.size() >= limit_) return false;
        found_.push_back(piece_);
      } else if (!follow(edge.target)) {
        return false;
      }
      piece_ = before;
    }
    return true;
  }

  std::vector<bool> nodes_leading_there() const {
    std::vector<bool> leads(graph_.edges.size(), false);
    leads[static_cast<std::size_t>(to_)] = true;
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t node = static_cast<std::size_t>(least_); node < leads.size(); ++node) {
        if (leads[node]) continue;
        for (const Edge& edge : graph_.edges[node]) {
          if (edge.target < least_ || !leads[static_cast<std::size_t>(edge.target)]) continue;
          leads[node] = changed = true;
          break;
        }
      }
    }
    return leads;
  }

  const Graph& graph_;
  int to_;
  int least_;
  std::size_t limit_;
  std::vector<Piece>& found_;
  Piece piece_;
  std::vector<bool> leads_there_;
};

// The best repetitions of loops for one walk.
class WalkProgram {
 public:
  WalkProgram(const Piece& walk, std::vector<const Piece*> loops, const KeyframeQuery& query,
              const KeyframeOptions& options, double target_frames, LoopAttachment attachment)
      : walk_(walk),
        loops_(std::move(loops)),
        attachment_(attachment),
        target_distance_(query.distance),
        target_frames_(target_frames),
        distance_weight_(options.distance_weight),
        time_weight_(options.time_weight) {}

  // Of the four programs; `programs` counts those solved.
  double best_cost(int seconds, std::size_t& programs) {
    double best = unlimited;
    for (const double distance_sign : {1.0, -1.0}) {
      for (const double time_sign : {1.0, -1.0}) {
        const double cost = solve(distance_sign, time_sign, seconds, programs);
        if (std::isnan(cost)) return cost;
        best = std::min(best, cost);
      }
    }
    return best;
  }

 private:
  double excess_distance() const { return walk_.distance - target_distance_; }
  double excess_frames() const { return walk_.steps + 1 - target_frames_; }

  // More repetitions than this cost more than none do.
  double most_uses(const Piece& loop) const {
    const double without = walk_.cost + distance_weight_ * std::abs(excess_distance()) +
                           time_weight_ * std::abs(excess_frames());
    return std::max(0.0, std::floor((without / time_weight_ - excess_frames()) / loop.steps + 1e-9));
  }

  double solve(double distance_sign, double time_sign, int seconds, std::size_t& programs) {
    glp_prob* problem = glp_create_prob();
    glp_set_obj_dir(problem, GLP_MIN);
    const int count = static_cast<int>(loops_.size());
    if (count > 0) glp_add_cols(problem, count);
    glp_add_rows(problem, 2);
    // Eq. 23: both signs hold for the whole path. The walk (n_0 = 1) and the targets are constants.
    glp_set_row_bnds(problem, 1, GLP_LO, -distance_sign * excess_distance(), 0.0);
    glp_set_row_bnds(problem, 2, GLP_LO, -time_sign * excess_frames(), 0.0);
    double constant = walk_.cost + distance_weight_ * distance_sign * excess_distance() +
                      time_weight_ * time_sign * excess_frames();
    glp_set_obj_coef(problem, 0, constant);
    for (int i = 1; i <= count; ++i) {
      const Piece& loop = *loops_[static_cast<std::size_t>(i) - 1];
      glp_set_col_kind(problem, i, GLP_IV);
      if (attachment_ == LoopAttachment::to_loops) {
        const double most = most_uses(loop);
        glp_set_col_bnds(problem, i, most > 0.0 ? GLP_DB : GLP_FX, 0.0, most);
      } else {
        glp_set_col_bnds(problem, i, GLP_LO, 0.0, 0.0);
      }
      glp_set_obj_coef(problem, i,
                       loop.cost + distance_weight_ * distance_sign * loop.distance +
                           time_weight_ * time_sign * loop.steps);
      const std::array<int, 3> rows{0, 1, 2};
      const std::array<double, 3> values{0.0, distance_sign * loop.distance, time_sign * loop.steps};
      glp_set_mat_col(problem, i, 2, rows.data(), values.data());
    }
    glp_iocp control;
    glp_init_iocp(&control);
    control.msg_lev = GLP_MSG_OFF;
    control.presolve = GLP_ON;
    control.tm_lim = 1000 * seconds;
    double cost = unlimited;
    for (;;) {
      const int failed = glp_intopt(problem, &control);
      ++programs;
      const int status = glp_mip_status(problem);
      if (failed == GLP_ENOPFS || (failed == 0 && status == GLP_NOFEAS)) break;
      if (failed != 0 || status != GLP_OPT) {
        cost = std::numeric_limits<double>::quiet_NaN();
        break;
      }
      if (attachment_ == LoopAttachment::to_loops && cut_loose_loops(problem)) continue;
      cost = glp_mip_obj_val(problem);
      break;
    }
    glp_delete_prob(problem);
    return cost;
  }

  // True if loops in use hang on nothing and rows were added: to use one of them, use a loop that leads
  // there.
  bool cut_loose_loops(glp_prob* problem) const {
    std::vector<bool> used(loops_.size()), reached(loops_.size());
    for (std::size_t i = 0; i < loops_.size(); ++i) {
      used[i] = glp_mip_col_val(problem, static_cast<int>(i) + 1) > 0.5;
      reached[i] = used[i] && meet(walk_, *loops_[i]);
    }
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t i = 0; i < loops_.size(); ++i) {
        if (!used[i] || reached[i]) continue;
        for (std::size_t j = 0; j < loops_.size(); ++j) {
          if (!reached[j] || !meet(*loops_[i], *loops_[j])) continue;
          reached[i] = changed = true;
          break;
        }
      }
    }
    // All loose ones together: who meets one of them and is not loose leads there.
    std::vector<std::size_t> loose;
    for (std::size_t i = 0; i < loops_.size(); ++i) {
      if (used[i] && !reached[i]) loose.push_back(i);
    }
    if (loose.empty()) return false;
    std::vector<int> columns{0};
    for (std::size_t j = 0; j < loops_.size(); ++j) {
      if (std::find(loose.begin(), loose.end(), j) != loose.end()) continue;
      if (std::any_of(loose.begin(), loose.end(),
                      [&](std::size_t i) { return meet(*loops_[i], *loops_[j]); })) {
        columns.push_back(static_cast<int>(j) + 1);
      }
    }
    for (const std::size_t i : loose) {
      std::vector<int> row_columns = columns;
      std::vector<double> values(columns.size(), most_uses(*loops_[i]));
      row_columns.push_back(static_cast<int>(i) + 1);
      values.push_back(-1.0);
      const int row = glp_add_rows(problem, 1);
      glp_set_row_bnds(problem, row, GLP_LO, 0.0, 0.0);
      glp_set_mat_row(problem, row, static_cast<int>(row_columns.size()) - 1, row_columns.data(),
                      values.data());
    }
    return true;
  }

  const Piece& walk_;
  std::vector<const Piece*> loops_;
  LoopAttachment attachment_;
  double target_distance_, target_frames_, distance_weight_, time_weight_;
};

// The loops that meet the walk, and then those that meet such loops, and so on.
std::vector<const Piece*> attached_loops(const Piece& walk, const std::vector<Piece>& loops,
                                         LoopAttachment attachment) {
  std::vector<const Piece*> attached;
  std::vector<bool> taken(loops.size());
  const auto take_those_that_meet = [&](const Piece& piece) {
    for (std::size_t i = 0; i < loops.size(); ++i) {
      if (taken[i] || !meet(piece, loops[i])) continue;
      taken[i] = true;
      attached.push_back(&loops[i]);
    }
  };
  take_those_that_meet(walk);
  if (attachment == LoopAttachment::to_loops) {
    for (std::size_t i = 0; i < attached.size(); ++i) take_those_that_meet(*attached[i]);
  }
  return attached;
}

}  // namespace

DecompositionResult solve_by_decomposition(const PathMetrics& metrics, const KeyframeQuery& query,
                                           const KeyframeOptions& options, LoopAttachment attachment,
                                           const DecompositionLimits& limits) {
  const Graph graph = make_graph(metrics, query);
  DecompositionResult result;
  std::vector<Piece> walks, loops;
  result.is_complete = DepthFirstSearch(graph, graph.last, 0, limits.walks, walks).run(graph.first);
  // Each loop once: from its first node, through later ones.
  for (int node = 0; result.is_complete && node < static_cast<int>(graph.edges.size()); ++node) {
    result.is_complete = DepthFirstSearch(graph, node, node, limits.loops, loops).run(node);
  }
  result.walks = walks.size();
  result.loops = loops.size();
  if (!result.is_complete) return result;
  for (const Piece& walk : walks) {
    WalkProgram program(walk, attached_loops(walk, loops, attachment), query, options,
                        query.time * metrics.frames_per_second(), attachment);
    const double cost = program.best_cost(limits.seconds, result.programs);
    if (std::isnan(cost)) {
      result.cost = cost;
      return result;
    }
    result.cost = std::min(result.cost, cost);
  }
  return result;
}

}  // namespace reprise::benchmark
