// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Key-frame paths by integer programming: an independent solver for tests and benchmarks. Whoever includes
// this links GLPK (GPL), so nothing that is shipped may.

#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <glpk.h>

#include "reprise/path/keyframe_optimizer.h"

namespace reprise::test {

// The same optimum by integer programming: x_e >= 0 counts the uses of edge e of a graph whose nodes are
// (key-frames shown, transition just taken); flow from source to sink is balanced, both absolute values are
// epigraph variables, and loops that hang on nothing are cut off as they turn up.
class KeyframeProgram {
 public:
  // `cost_bound`: the cost of some feasible path, which bounds every x_e. Precondition: time has a weight or
  // a limit, or every transition costs something.
  KeyframeProgram(const PathMetrics& metrics, const KeyframeQuery& query, const KeyframeOptions& options,
                  double cost_bound)
      : metrics_(metrics),
        query_(query),
        options_(options),
        target_frames_(query.time * metrics.frames_per_second()) {
    add_edges();
    const double most_frames = std::min(query_.max_time * metrics_.frames_per_second(),
                                        target_frames_ + over(cost_bound, options_.time_weight));
    const double most_distance =
        std::min(query_.max_distance, query_.distance + over(cost_bound, options_.distance_weight));
    problem_ = glp_create_prob();
    glp_set_obj_dir(problem_, GLP_MIN);
    glp_add_cols(problem_, static_cast<int>(edges_.size()) + 2);
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      const int column = static_cast<int>(i) + 1;
      const Edge& edge = edges_[i];
      const double most = edge.target == sink_node
                              ? 1.0
                              : std::max(0.0, std::floor(1e-9 + std::min({over(most_frames - 1.0, edge.steps),
                                                                          over(most_distance, edge.distance),
                                                                          over(cost_bound, edge.cost)})));
      most_.push_back(most);
      glp_set_col_kind(problem_, column, GLP_IV);
      glp_set_col_bnds(problem_, column, most > 0.0 ? GLP_DB : GLP_FX, 0.0, most);
      glp_set_obj_coef(problem_, column, edges_[i].cost);
    }
    const int distance_column = static_cast<int>(edges_.size()) + 1;
    const int time_column = distance_column + 1;
    for (const int column : {distance_column, time_column})
      glp_set_col_bnds(problem_, column, GLP_LO, 0.0, 0.0);
    glp_set_obj_coef(problem_, distance_column, options_.distance_weight);
    glp_set_obj_coef(problem_, time_column, options_.time_weight);
    for (int node = 0; node < node_count_; ++node) {
      Row row;
      for (std::size_t i = 0; i < edges_.size(); ++i) {
        const double balance =
            (edges_[i].source == node ? 1.0 : 0.0) - (edges_[i].target == node ? 1.0 : 0.0);
        if (balance != 0.0) row.add(static_cast<int>(i) + 1, balance);
      }
      const double supply = node == source_node ? 1.0 : node == sink_node ? -1.0 : 0.0;
      add_row(row, GLP_FX, supply);
    }
    for (const double sign : {1.0, -1.0}) {
      Row distance, time;
      for (std::size_t i = 0; i < edges_.size(); ++i) {
        if (edges_[i].distance != 0.0) distance.add(static_cast<int>(i) + 1, -sign * edges_[i].distance);
        if (edges_[i].steps != 0) time.add(static_cast<int>(i) + 1, -sign * edges_[i].steps);
      }
      distance.add(distance_column, 1.0);
      time.add(time_column, 1.0);
      add_row(distance, GLP_LO, -sign * query_.distance);
      add_row(time, GLP_LO, -sign * (target_frames_ - 1.0));
    }
    add_limits();
  }
  ~KeyframeProgram() { glp_delete_prob(problem_); }
  KeyframeProgram(const KeyframeProgram&) = delete;
  KeyframeProgram& operator=(const KeyframeProgram&) = delete;

  // The least cost; infinite if there is no path, NaN if GLPK gives up.
  double solve() {
    glp_iocp control;
    glp_init_iocp(&control);
    control.msg_lev = GLP_MSG_OFF;
    for (;;) {
      // Without the presolver of integer programs, which takes a row missed by 0.001 for kept.
      glp_smcp relaxed;
      glp_init_smcp(&relaxed);
      relaxed.msg_lev = GLP_MSG_OFF;
      if (glp_simplex(problem_, &relaxed) != 0) return std::numeric_limits<double>::quiet_NaN();
      if (glp_get_status(problem_) == GLP_NOFEAS) return unlimited;
      const int failed = glp_intopt(problem_, &control);
      if (failed == 0 && glp_mip_status(problem_) == GLP_NOFEAS) return unlimited;
      if (failed != 0 || glp_mip_status(problem_) != GLP_OPT) return std::numeric_limits<double>::quiet_NaN();
      if (cut_loose_loops()) continue;
      double cost = 0.0, distance = 0.0, steps = 0.0;
      for (std::size_t i = 0; i < edges_.size(); ++i) {
        const double uses = std::round(glp_mip_col_val(problem_, static_cast<int>(i) + 1));
        cost += uses * edges_[i].cost;
        distance += uses * edges_[i].distance;
        steps += uses * edges_[i].steps;
      }
      return cost + options_.distance_weight * std::abs(distance - query_.distance) +
             options_.time_weight * std::abs(steps + 1.0 - target_frames_);
    }
  }

  // Constraints added against loops that hang on nothing.
  int cut_count() const { return cut_count_; }

 private:
  static constexpr int source_node = 0;
  static constexpr int sink_node = 1;

  struct Edge {
    int source = 0;
    int target = 0;
    int steps = 0;
    double distance = 0.0;
    double cost = 0.0;
    std::size_t arrives_in = std::numeric_limits<std::size_t>::max();  // clip, unless it goes to the sink
  };
  struct Row {
    std::vector<int> columns{0};  // GLPK counts from 1
    std::vector<double> values{0.0};
    void add(int column, double value) {
      columns.push_back(column);
      values.push_back(value);
    }
  };

  void add_row(const Row& row, int kind, double bound) {
    const int index = glp_add_rows(problem_, 1);
    glp_set_row_bnds(problem_, index, kind, bound, bound);
    glp_set_mat_row(problem_, index, static_cast<int>(row.columns.size()) - 1, row.columns.data(),
                    row.values.data());
  }

  // `amount / rate`, unlimited if nothing is used up.
  static double over(double amount, double rate) { return rate > 0.0 ? amount / rate : unlimited; }

  // Rows for the hard limits, and one for each compulsory clip that holds no key-frame.
  void add_limits() {
    Row distance, time;
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      if (edges_[i].distance != 0.0) distance.add(static_cast<int>(i) + 1, edges_[i].distance);
      if (edges_[i].steps != 0) time.add(static_cast<int>(i) + 1, edges_[i].steps);
    }
    const double rate = metrics_.frames_per_second();
    // Of whole numbers of frames, those within the limits.
    const double fewest = std::ceil(query_.min_time * rate - 1e-6) - 1.0;
    const double most = std::floor(query_.max_time * rate + 1e-6) - 1.0;
    if (query_.min_distance > 0.0) add_row(distance, GLP_LO, query_.min_distance);
    if (query_.max_distance < unlimited) add_row(distance, GLP_UP, query_.max_distance);
    if (query_.min_time > 0.0) add_row(time, GLP_LO, fewest);
    if (query_.max_time < unlimited) add_row(time, GLP_UP, most);
    for (const std::size_t clip_idx : query_.compulsory_clips) {
      Row arrivals;
      bool holds_keyframe = false;
      for (const FrameId& keyframe : query_.keyframes) holds_keyframe |= keyframe.clip_idx == clip_idx;
      for (std::size_t i = 0; i < edges_.size(); ++i) {
        if (edges_[i].arrives_in == clip_idx) arrivals.add(static_cast<int>(i) + 1, 1.0);
      }
      if (!holds_keyframe) add_row(arrivals, GLP_LO, 1.0);
    }
  }

  bool is_forbidden(const Transition& transition) const {
    for (const std::size_t clip_idx : query_.forbidden_clips) {
      if (transition.source_clip == clip_idx || transition.target_clip == clip_idx) return true;
    }
    return false;
  }

  void add_edges() {
    const std::vector<FrameId>& keyframes = query_.keyframes;
    std::map<std::pair<std::size_t, std::size_t>, int> nodes;
    std::vector<std::pair<std::size_t, std::size_t>> open;
    const auto node_of = [&](std::size_t shown, std::size_t transition_idx) {
      const auto [found, inserted] =
          nodes.try_emplace({shown, transition_idx}, static_cast<int>(nodes.size()) + 2);
      if (inserted) open.emplace_back(shown, transition_idx);
      return found->second;
    };
    // Key-frames shown after the pure frames first..last, of all but the last one.
    const auto shown_after = [&](std::size_t shown, std::size_t clip_idx, int first, int last) {
      for (int frame = first; frame <= last && shown + 1 < keyframes.size(); ++frame) {
        if (keyframes[shown] == FrameId{clip_idx, static_cast<std::size_t>(frame)}) ++shown;
      }
      return shown;
    };
    // `first_new`: the first frame that may show a key-frame.
    const auto expand = [&](int node, std::size_t shown, std::size_t clip_idx, int arrived, int first_new) {
      const int last_frame = static_cast<int>(keyframes.back().frame_idx);
      if (keyframes.back().clip_idx == clip_idx && last_frame >= first_new &&
          shown_after(shown, clip_idx, first_new, last_frame - 1) + 1 == keyframes.size()) {
        edges_.push_back({node, sink_node, last_frame - arrived,
                          metrics_.clip_distance(clip_idx, arrived, last_frame), 0.0,
                          std::numeric_limits<std::size_t>::max()});
      }
      for (std::size_t i = 0; i < metrics_.transitions().size(); ++i) {
        const Transition& transition = metrics_.transitions()[i];
        if (transition.source_clip != clip_idx || transition.leave() < arrived) continue;
        if (is_forbidden(transition)) continue;
        edges_.push_back(
            {node, node_of(shown_after(shown, clip_idx, first_new, transition.leave()), i),
             transition.leave() - arrived + 2 * transition.half_window,
             metrics_.clip_distance(clip_idx, arrived, transition.leave()) + metrics_.blend_distance(i),
             transition.cost, transition.target_clip});
      }
    };
    const int first_frame = static_cast<int>(keyframes.front().frame_idx);
    expand(source_node, 1, keyframes.front().clip_idx, first_frame, first_frame + 1);
    while (!open.empty()) {
      const auto [shown, transition_idx] = open.back();
      open.pop_back();
      const Transition& transition = metrics_.transitions()[transition_idx];
      expand(nodes.at({shown, transition_idx}), shown, transition.target_clip, transition.arrive(),
             transition.arrive());
    }
    node_count_ = static_cast<int>(nodes.size()) + 2;
  }

  // True if some used edges hang on nothing and a cut was added: whoever uses them must enter them.
  bool cut_loose_loops() {
    std::vector<bool> used(edges_.size());
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      used[i] = glp_mip_col_val(problem_, static_cast<int>(i) + 1) > 0.5;
    }
    std::set<int> reached{source_node};
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t i = 0; i < edges_.size(); ++i) {
        if (used[i] && reached.contains(edges_[i].source)) changed |= reached.insert(edges_[i].target).second;
      }
    }
    std::set<int> loose;
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      if (used[i] && !reached.contains(edges_[i].source)) loose.insert(edges_[i].source);
    }
    if (loose.empty()) return false;
    for (std::size_t f = 0; f < edges_.size(); ++f) {
      if (!used[f] || !loose.contains(edges_[f].source)) continue;
      Row row;
      for (std::size_t i = 0; i < edges_.size(); ++i) {
        if (!loose.contains(edges_[i].source) && loose.contains(edges_[i].target)) {
          row.add(static_cast<int>(i) + 1, most_[f]);
        }
      }
      row.add(static_cast<int>(f) + 1, -1.0);
      add_row(row, GLP_LO, 0.0);
      ++cut_count_;
    }
    return true;
  }

  const PathMetrics& metrics_;
  const KeyframeQuery& query_;
  const KeyframeOptions& options_;
  double target_frames_;
  int cut_count_ = 0;
  std::vector<Edge> edges_;
  std::vector<double> most_;
  int node_count_ = 0;
  glp_prob* problem_ = nullptr;
};

}  // namespace reprise::test
