// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/program_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/path/leg_graph.h"
#include "reprise/path/linear_program.h"

namespace reprise {
namespace {

using path_detail::EdgeLength;
using path_detail::LegGraph;
using path_detail::LinearProgram;
using path_detail::Relation;

double steps_of(const LegGraph::Edge& edge) {
  return edge.steps;
}
double distance_of(const LegGraph::Edge& edge) {
  return edge.distance;
}
double cost_of(const LegGraph::Edge& edge) {
  return edge.cost;
}

// What a whole path may spend of something that every edge adds to.
struct Budget {
  EdgeLength length = nullptr;
  double most = unlimited;
};

// Solvers take a count within about 1e-5 of a whole number for one. A column that such an error lets in may
// carry this much and no more, lest it feed a loop that hangs on nothing.
constexpr double greatest_factor = 2e4;

// Room for roundings in budgets, which are there to shorten the search, not to decide.
constexpr double budget_slack = 1e-6;

std::vector<std::string> make_clip_labels(const std::vector<std::string>& clip_names) {
  std::vector<std::string> labels;
  std::set<std::string> taken;
  for (const std::string& name : clip_names) {
    std::string label = path_detail::lp_label(name);
    while (!taken.insert(label).second) label += "_";
    labels.push_back(label);
  }
  return labels;
}

class ProgramMaker {
 public:
  ProgramMaker(const PathMetrics& metrics, const KeyframeQuery& query, const KeyframeOptions& options,
               const std::vector<std::string>& clip_names, double cost_bound)
      : metrics_(metrics),
        query_(query),
        options_(options),
        clip_names_(clip_names),
        labels_(make_clip_labels(clip_names)),
        cost_bound_(cost_bound),
        target_frames_(query.time * metrics.frames_per_second()) {
    make_legs();
    make_budgets();
    for (std::size_t leg_idx = 0; leg_idx < legs_.size(); ++leg_idx) add_leg(leg_idx);
    add_targets();
    add_compulsory_clips();
  }

  std::string text() const { return to_lp_text(program_, heading()); }

 private:
  using Terms = std::vector<std::pair<std::size_t, double>>;

  void make_legs() {
    std::vector<bool> forbidden;
    for (const Transition& transition : metrics_.transitions()) {
      forbidden.push_back(std::any_of(
          query_.forbidden_clips.begin(), query_.forbidden_clips.end(), [&](std::size_t clip_idx) {
            return clip_idx == transition.source_clip || clip_idx == transition.target_clip;
          }));
    }
    for (std::size_t i = 0; i + 1 < query_.keyframes.size(); ++i) {
      legs_.push_back(
          path_detail::make_leg_graph(metrics_, query_.keyframes[i], query_.keyframes[i + 1], forbidden));
    }
  }

  // The sum over all legs but one, or over all.
  double least_of_others(EdgeLength length, std::size_t leg_idx) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < legs_.size(); ++i) {
      if (i != leg_idx) sum += path_detail::least_length(legs_[i], length);
    }
    return sum;
  }

  // A path that costs no more than the bound spends its cost on transitions, distance and time.
  void make_budgets() {
    const double spare = cost_bound_ - least_of_others(cost_of, legs_.size());
    double frames = query_.max_time * metrics_.frames_per_second();
    if (options_.time_weight > 0.0) {
      frames = std::min(frames, target_frames_ + spare / options_.time_weight);
    }
    double distance = query_.max_distance;
    if (options_.distance_weight > 0.0) {
      distance = std::min(distance, query_.distance + spare / options_.distance_weight);
    }
    steps_ = {steps_of, frames - 1.0 + budget_slack};
    distance_ = {distance_of, distance + budget_slack};
    cost_ = {cost_of, cost_bound_ + budget_slack};

    double least_cost = unlimited;  // of a loop: each has a transition
    for (const LegGraph& leg : legs_) {
      for (const LegGraph::Edge& edge : leg.edges) {
        if (edge.transition >= 0) least_cost = std::min(least_cost, edge.cost);
      }
    }
    if (steps_.most <= greatest_factor) {
      remaining_ = steps_;
    } else if (cost_.most <= greatest_factor * least_cost) {
      remaining_ = cost_;
    } else {
      throw InvalidArgument(fmt::format(
          "integer program: expected paths of at most {:.0f} frames, or transitions that all cost something; "
          "by its time weight {} and greatest time {} s a path may have {} frames, and a transition costs {}",
          greatest_factor, options_.time_weight, query_.max_time, steps_.most, least_cost));
    }
  }

  std::string node_label(std::size_t leg_idx, const LegGraph::Node& node) const {
    return fmt::format("{}.{}.{}", leg_idx + 1, labels_[node.clip_idx], node.frame);
  }
  std::string edge_label(std::size_t leg_idx, const LegGraph::Edge& edge) const {
    const LegGraph::Node& source = legs_[leg_idx].nodes[edge.source];
    const LegGraph::Node& target = legs_[leg_idx].nodes[edge.target];
    if (edge.transition < 0) return fmt::format("play.{}.{}", node_label(leg_idx, source), target.frame);
    return fmt::format("take.{}.t{}.{}.{}.{}.{}", leg_idx + 1, edge.transition, labels_[source.clip_idx],
                       source.frame, labels_[target.clip_idx], target.frame);
  }

  void add_leg(std::size_t leg_idx) {
    LegGraph& leg = legs_[leg_idx];
    std::vector<double> most(leg.edges.size(), unlimited);
    for (const Budget& budget : {steps_, distance_, cost_}) {
      if (!std::isfinite(budget.most)) continue;
      const std::vector<double> of_budget =
          path_detail::most_uses(leg, budget.length, budget.most - least_of_others(budget.length, leg_idx));
      for (std::size_t i = 0; i < most.size(); ++i) most[i] = std::min(most[i], of_budget[i]);
    }
    // An edge may fit each of them on other walks, all of which are dropped: such an edge goes as well.
    std::vector<bool> fits;
    for (const double uses : most) fits.push_back(uses > 0.0);
    const std::vector<std::size_t> former = path_detail::keep_edges(leg, fits);

    // Uses of the edges: a flow of one unit from the first key-frame to the last, loops besides.
    std::vector<Terms> balance(leg.nodes.size());
    Terms departures;
    std::vector<std::size_t> uses;
    for (std::size_t i = 0; i < leg.edges.size(); ++i) {
      const LegGraph::Edge& edge = leg.edges[i];
      const std::size_t column = program_.add_column({.name = edge_label(leg_idx, edge),
                                                      .objective = edge.cost,
                                                      .most = most[former[i]],
                                                      .is_integer = true});
      uses.push_back(column);
      balance[edge.source].emplace_back(column, 1.0);
      balance[edge.target].emplace_back(column, -1.0);
      if (edge.source == leg.first) departures.emplace_back(column, 1.0);
      all_distances_.emplace_back(column, -edge.distance);
      all_steps_.emplace_back(column, -static_cast<double>(edge.steps));
      if (edge.transition >= 0) arrivals_.emplace_back(leg.nodes[edge.target].clip_idx, column);
    }
    for (std::size_t node = 0; node < leg.nodes.size(); ++node) {
      if (balance[node].empty()) continue;
      const double supply = (node == leg.first ? 1.0 : 0.0) - (node == leg.last ? 1.0 : 0.0);
      program_.rows.push_back({"balance." + node_label(leg_idx, leg.nodes[node]), std::move(balance[node]),
                               Relation::equal, supply});
    }
    if (leg.first == leg.last) {  // a loop must be played
      program_.rows.push_back(
          {fmt::format("leave.{}", leg_idx + 1), std::move(departures), Relation::at_least, 1.0});
    }
    add_remaining(leg_idx, uses);
  }

  // Connectivity. `left` of an edge is what remains of its leg after the edge (frames, or cost), summed over
  // its uses. What arrives at a node with so much left departs with as much: a loop that nothing enters would
  // have to get what it spends from nowhere. Between the first and the last use there is a least and a most
  // that can be left.
  void add_remaining(std::size_t leg_idx, const std::vector<std::size_t>& uses) {
    const LegGraph& leg = legs_[leg_idx];
    const double budget = remaining_.most - least_of_others(remaining_.length, leg_idx);
    const std::vector<double> before = path_detail::lengths_from(leg, remaining_.length, leg.first);
    const std::vector<double> after = path_detail::lengths_to(leg, remaining_.length, leg.last);
    std::vector<Terms> balance(leg.nodes.size());
    for (std::size_t i = 0; i < leg.edges.size(); ++i) {
      const LegGraph::Edge& edge = leg.edges[i];
      const std::string label = edge_label(leg_idx, edge);
      const double spent = remaining_.length(edge);
      const std::size_t left = program_.add_column({.name = "left." + label});
      balance[edge.target].emplace_back(left, 1.0);
      balance[edge.source].emplace_back(left, -1.0);
      balance[edge.source].emplace_back(uses[i], -spent);
      program_.rows.push_back(
          {"least." + label, {{left, 1.0}, {uses[i], -after[edge.target]}}, Relation::at_least, 0.0});
      program_.rows.push_back({"most." + label,
                               {{left, 1.0}, {uses[i], -(budget - before[edge.source] - spent)}},
                               Relation::at_most,
                               0.0});
    }
    for (std::size_t node = 0; node < leg.nodes.size(); ++node) {
      if (balance[node].empty() || node == leg.first) continue;
      program_.rows.push_back(
          {"left." + node_label(leg_idx, leg.nodes[node]), std::move(balance[node]), Relation::equal, 0.0});
    }
  }

  // Both absolute values: over - under = sum - target, and the least of over + under is its size.
  void add_targets() {
    const std::size_t distance =
        program_.add_column({.name = "distance", .least = query_.min_distance, .most = query_.max_distance});
    const double fps = metrics_.frames_per_second();
    const double longest = std::floor(query_.max_time * fps + budget_slack);
    const std::size_t frames =
        program_.add_column({.name = "frames",
                             .least = std::max(0.0, std::ceil(query_.min_time * fps - budget_slack)),
                             .most = longest});
    add_target("distance", distance, std::move(all_distances_), 0.0, query_.distance,
               options_.distance_weight);
    // The first frame is shown before any step.
    add_target("frames", frames, std::move(all_steps_), 1.0, target_frames_, options_.time_weight);
  }

  void add_target(const std::string& name, std::size_t sum, Terms terms, double start, double target,
                  double weight) {
    const std::size_t over = program_.add_column({.name = name + "_over", .objective = weight});
    const std::size_t under = program_.add_column({.name = name + "_under", .objective = weight});
    terms.emplace_back(sum, 1.0);
    program_.rows.push_back({name + "_sum", std::move(terms), Relation::equal, start});
    program_.rows.push_back(
        {name + "_target", {{sum, 1.0}, {over, -1.0}, {under, 1.0}}, Relation::equal, target});
  }

  // A clip is shown if it holds a key-frame or a transition arrives in it.
  void add_compulsory_clips() {
    for (const std::size_t clip_idx : query_.compulsory_clips) {
      if (std::any_of(query_.keyframes.begin(), query_.keyframes.end(),
                      [&](const FrameId& keyframe) { return keyframe.clip_idx == clip_idx; })) {
        continue;
      }
      LinearProgram::Row row{"show." + labels_[clip_idx], {}, Relation::at_least, 1.0};
      for (const auto& [target, column] : arrivals_) {
        if (target == clip_idx) row.terms.emplace_back(column, 1.0);
      }
      program_.rows.push_back(std::move(row));
    }
  }

  std::string frame_name(std::size_t clip_idx, int frame) const {
    return fmt::format("{}:{}", clip_names_[clip_idx], frame);
  }

  std::vector<std::string> heading() const {
    std::vector<std::string> lines{
        "A key-frame query as an integer linear program. Its optimum is the cost of the best path:",
        "transitions + distance weight x |distance - target| + time weight x |frames - target|.", "",
        "Key-frames, in order:"};
    for (const FrameId& keyframe : query_.keyframes) {
      lines.push_back("  " + frame_name(keyframe.clip_idx, static_cast<int>(keyframe.frame_idx)));
    }
    lines.push_back(fmt::format("Targets: {} m and {} frames ({} s at {} frames per second).",
                                query_.distance, target_frames_, query_.time, metrics_.frames_per_second()));
    lines.push_back(
        fmt::format("Weights: {} per metre, {} per frame.", options_.distance_weight, options_.time_weight));
    for (const char* line :
         {"", "Columns (whole numbers): how often the path plays on between two frames of a clip,",
          "  play.LEG.CLIP.FROM.TO, or leaves a clip by a transition and plays on from its arrival,",
          "  take.LEG.tTRANSITION.CLIP.FRAME.CLIP.FRAME. Leg 1 leads from key-frame 1 to 2, and so on.",
          "  distance: metres along the ground; frames: their number, blended ones counted once;",
          "  ..._over, ..._under: what they are above or below their targets;"}) {
      lines.emplace_back(line);
    }
    lines.push_back(fmt::format("  left.EDGE: {} after the edge to the end of its leg, summed over its uses.",
                                remaining_.length == steps_of ? "frames" : "transition cost"));
    for (const char* line :
         {"Rows: balance.NODE (what arrives departs), left.NODE, least.EDGE and most.EDGE (no loop without",
          "  a way to it), and what the targets, limits and compulsory clips ask for.",
          "To read a solution: start each leg at its key-frame and follow the columns, each as often as its",
          "  value says. Every order that uses them up is a path, and all of them cost the same.",
          "What only paths that cost more than this need is left out:"}) {
      lines.emplace_back(line);
    }
    lines.push_back(fmt::format("  {}", cost_bound_));
    lines.emplace_back("");
    lines.emplace_back("Transitions: centre frames, half window, cost:");
    std::set<int> shown;
    for (const LegGraph& leg : legs_) {
      for (const LegGraph::Edge& edge : leg.edges) {
        if (edge.transition >= 0) shown.insert(edge.transition);
      }
    }
    for (const int idx : shown) {
      const Transition& transition = metrics_.transitions()[static_cast<std::size_t>(idx)];
      lines.push_back(fmt::format(
          "  t{}: {}->{}, {}, {}", idx, frame_name(transition.source_clip, transition.m),
          frame_name(transition.target_clip, transition.n), transition.half_window, transition.cost));
    }
    return lines;
  }

  const PathMetrics& metrics_;
  const KeyframeQuery& query_;
  const KeyframeOptions& options_;
  const std::vector<std::string>& clip_names_;
  std::vector<std::string> labels_;
  double cost_bound_;
  double target_frames_;
  std::vector<LegGraph> legs_;
  Budget steps_, distance_, cost_;
  Budget remaining_;  // the one that keeps loops connected
  LinearProgram program_;
  Terms all_distances_, all_steps_;
  std::vector<std::pair<std::size_t, std::size_t>> arrivals_;  // clip, column
};

}  // namespace

std::string write_keyframe_program(const PathMetrics& metrics, const KeyframeQuery& query,
                                   const KeyframeOptions& options, const std::vector<std::string>& clip_names,
                                   double cost_bound) {
  if (query.goal || query.route) {
    throw InvalidArgument("integer program: expected a query without a goal or a route on the ground");
  }
  const auto path = find_keyframe_path(metrics, query, options, clip_names);
  if (!path) throw InvalidArgument("integer program: there is no path; " + path.error().reason);
  if (!(std::isfinite(cost_bound) && cost_bound >= path->lower_bound - 1e-9)) {
    throw InvalidArgument(
        fmt::format("cost bound: expected a number of at least {} (no path costs less), found {}",
                    path->lower_bound, cost_bound));
  }
  return ProgramMaker(metrics, query, options, clip_names, cost_bound).text();
}

}  // namespace reprise
