// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Small databases of skeletons and queries, random or by hand, and Dijkstra's algorithm on the same trellis,
// made without the retriever's own, for the tests of retrieval.

#pragma once

#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <optional>
#include <queue>
#include <random>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "reprise/path/skeleton_retrieval.h"

namespace reprise::test {

// What a frame of a path shows: frame `position` of a clip, or of the 2 L - 1 blended ones of a transition.
struct ShownNode {
  bool blended = false;
  std::size_t owner = 0;
  int position = 0;
  auto operator<=>(const ShownNode&) const = default;
};

struct RetrievalCase {
  std::vector<JointTrack> tracks;
  std::vector<Transition> transitions;
  BlendProfile profile = BlendProfile::smooth;
  JointTrack query;
  RetrievalOptions options;

  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < tracks.size(); ++i) names.push_back(fmt::format("clip{}", i));
    return names;
  }
  SkeletonRetriever retriever() const { return {tracks, names(), transitions, profile, 25.0}; }
  auto retrieve() const { return retriever().retrieve(query, options); }

  double weight(std::size_t joint) const {
    return options.joint_weights.empty() ? 1.0 : options.joint_weights[joint];
  }
  double weight_sum() const {
    double sum = 0.0;
    for (Eigen::Index j = 0; j < query.front().rows(); ++j) sum += weight(static_cast<std::size_t>(j));
    return sum;
  }
};

inline Eigen::MatrixX3d moved(const GroundTransform& transform, const Eigen::MatrixX3d& points) {
  Eigen::MatrixX3d result(points.rows(), 3);
  for (Eigen::Index j = 0; j < points.rows(); ++j) {
    result.row(j) = (transform * Eigen::Vector3d(points.row(j))).transpose();
  }
  return result;
}

// Velocities by the definition in RetrievalOptions.
inline Eigen::MatrixX3d velocities(const JointTrack& track, int frame) {
  const int last = static_cast<int>(track.size()) - 1;
  const int from = std::max(frame - 3, 0);
  const int to = std::min(frame + 3, last);
  if (from == to) return Eigen::MatrixX3d::Zero(track.front().rows(), 3);
  return (track[static_cast<std::size_t>(to)] - track[static_cast<std::size_t>(from)]) / (to - from);
}

struct Pose {
  Eigen::MatrixX3d joints, velocity;
};

inline Pose pose_of(const RetrievalCase& c, const ShownNode& node) {
  const auto captured = [&](std::size_t clip, int frame) {
    return Pose{c.tracks[clip][static_cast<std::size_t>(frame)], velocities(c.tracks[clip], frame)};
  };
  if (!node.blended) return captured(node.owner, node.position);
  const Transition& t = c.transitions[node.owner];
  const int k = node.position + 1 - t.half_window;
  const double alpha = blend_weight(c.profile, k, t.half_window);
  const Pose source = captured(t.source_clip, t.m + k);
  const Pose target = captured(t.target_clip, t.n + k);
  const GroundTransform turn{.yaw = t.source_from_target.yaw};
  return {(1.0 - alpha) * source.joints + alpha * moved(t.source_from_target, target.joints),
          (1.0 - alpha) * source.velocity + alpha * moved(turn, target.velocity)};
}

// c_skel, the ground as the complex plane: the best turn is the argument of one sum of products.
inline double oracle_dissimilarity(const RetrievalCase& c, const Pose& q, const Pose& x) {
  using Complex = std::complex<double>;
  const auto ground = [](const Eigen::MatrixX3d& m, Eigen::Index j) { return Complex(m(j, 2), m(j, 0)); };
  Complex q_mean, x_mean, product;
  for (Eigen::Index j = 0; j < q.joints.rows(); ++j) {
    const double share = c.weight(static_cast<std::size_t>(j)) / c.weight_sum();
    q_mean += share * ground(q.joints, j);
    x_mean += share * ground(x.joints, j);
  }
  for (Eigen::Index j = 0; j < q.joints.rows(); ++j) {
    product += c.weight(static_cast<std::size_t>(j)) * (ground(q.joints, j) - q_mean) *
               std::conj(ground(x.joints, j) - x_mean);
  }
  const Complex turn = std::polar(1.0, std::arg(product));
  double sum = 0.0;
  for (Eigen::Index j = 0; j < q.joints.rows(); ++j) {
    const auto place = ground(q.joints, j) - q_mean - turn * (ground(x.joints, j) - x_mean);
    const auto speed = ground(q.velocity, j) - turn * ground(x.velocity, j);
    sum += c.weight(static_cast<std::size_t>(j)) *
           (std::hypot(std::abs(place), q.joints(j, 1) - x.joints(j, 1)) +
            c.options.velocity_weight * std::hypot(std::abs(speed), q.velocity(j, 1) - x.velocity(j, 1)));
  }
  return sum;
}

// Single steps of the surface motion graph by its definition.
struct GraphStep {
  ShownNode to;
  double cost = 0.0;
};
inline std::vector<GraphStep> steps_from(const RetrievalCase& c, const ShownNode& node) {
  std::vector<GraphStep> steps;
  if (node.blended) {
    const Transition& t = c.transitions[node.owner];
    if (node.position + 1 < 2 * t.half_window - 1) {
      steps.push_back({{true, node.owner, node.position + 1}});
    } else {
      steps.push_back({{false, t.target_clip, t.arrive()}});
    }
    return steps;
  }
  if (node.position + 1 < static_cast<int>(c.tracks[node.owner].size())) {
    steps.push_back({{false, node.owner, node.position + 1}});
  }
  for (std::size_t t = 0; t < c.transitions.size(); ++t) {
    if (c.transitions[t].source_clip == node.owner && c.transitions[t].leave() == node.position) {
      steps.push_back({{true, t, 0}, c.transitions[t].cost});
    }
  }
  return steps;
}

// The frames of the path in the order of its synthesis.
inline std::vector<ShownNode> shown_nodes(const RetrievalCase& c, const MotionPath& path) {
  std::vector<ShownNode> nodes;
  for (const PathSegment& segment : path.segments) {
    for (int f = segment.first_frame; f <= segment.last_frame; ++f) {
      nodes.push_back({false, segment.clip_idx, f});
    }
    if (!segment.transition) continue;
    const auto same = [&](const Transition& t) {
      return std::tie(t.source_clip, t.target_clip, t.m, t.n, t.half_window, t.cost) ==
             std::tie(segment.transition->source_clip, segment.transition->target_clip, segment.transition->m,
                      segment.transition->n, segment.transition->half_window, segment.transition->cost);
    };
    const auto found = std::find_if(c.transitions.begin(), c.transitions.end(), same);
    EXPECT_NE(found, c.transitions.end());
    for (int b = 0; b < 2 * segment.transition->half_window - 1; ++b) {
      nodes.push_back({true, static_cast<std::size_t>(found - c.transitions.begin()), b});
    }
  }
  return nodes;
}

// The nodes an answer shows, one a frame of the query.
inline std::vector<ShownNode> answer_nodes(const RetrievalCase& c, const Retrieval& answer) {
  const std::vector<ShownNode> path = shown_nodes(c, answer.path);
  std::vector<ShownNode> nodes;
  for (const int i : answer.path_frame) nodes.push_back(path.at(static_cast<std::size_t>(i)));
  return nodes;
}

// Dijkstra's algorithm over (frame of the query, node, repeats so far).
class RetrievalOracle {
 public:
  explicit RetrievalOracle(const RetrievalCase& c) : case_(c) {
    for (std::size_t clip = 0; clip < c.tracks.size(); ++clip) {
      for (int f = 0; f < static_cast<int>(c.tracks[clip].size()); ++f) nodes_.push_back({false, clip, f});
    }
    for (std::size_t t = 0; t < c.transitions.size(); ++t) {
      for (int b = 0; b < 2 * c.transitions[t].half_window - 1; ++b) nodes_.push_back({true, t, b});
    }
    for (const ShownNode& node : nodes_) poses_[node] = pose_of(c, node);
    for (std::size_t k = 0; k < c.query.size(); ++k) {
      const Pose query{c.query[k], velocities(c.query, static_cast<int>(k))};
      dissimilarity_.emplace_back();
      for (const ShownNode& node : nodes_) {
        dissimilarity_[k][node] = oracle_dissimilarity(c, query, poses_[node]);
      }
    }
  }

  double dissimilarity(std::size_t k, const ShownNode& node) const { return dissimilarity_[k].at(node); }
  const std::vector<ShownNode>& nodes() const { return nodes_; }

  bool forbidden(const ShownNode& node) const {
    const auto is = [&](std::size_t clip) {
      return std::count(case_.options.forbidden_clips.begin(), case_.options.forbidden_clips.end(), clip) > 0;
    };
    if (!node.blended) return is(node.owner);
    return is(case_.transitions[node.owner].source_clip) || is(case_.transitions[node.owner].target_clip);
  }

  // What an earlier answer shows at a frame of the query keeps its neighbours from being shown there.
  void keep_apart(const std::vector<ShownNode>& answer) { earlier_.push_back(answer); }

  struct Result {
    std::optional<double> cost;  // of the best walk
    std::size_t deepest = 0;     // the last frame of the query at which anything can be reached, plus one
  };
  // `margin`: no walk may come nearer to the threshold than this, or the test would depend on rounding.
  Result solve(double threshold) {
    using State = std::tuple<std::size_t, ShownNode, int>;
    using Item = std::pair<double, State>;
    std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
    std::map<State, double> best;
    Result result;
    const RetrievalOptions& options = case_.options;
    const auto offer = [&](std::size_t k, const ShownNode& node, int repeats, double cost) {
      if (!may_show(k, node, threshold)) return;
      const State state{k, node, repeats};
      const double total = cost + options.retrieval_weight * dissimilarity(k, node);
      const auto known = best.find(state);
      if (known != best.end() && known->second <= total) return;
      best[state] = total;
      queue.emplace(total, state);
    };
    for (const ShownNode& node : nodes_) {
      if (!node.blended) offer(0, node, 0, 0.0);
    }
    while (!queue.empty()) {
      const auto [cost, state] = queue.top();
      queue.pop();
      if (cost > best[state]) continue;
      const auto [k, node, repeats] = state;
      result.deepest = std::max(result.deepest, k + 1);
      if (k + 1 == case_.query.size()) {
        result.cost = cost;
        return result;
      }
      if (repeats < options.most_repeats) offer(k + 1, node, repeats + 1, cost + options.repeat_cost);
      for (const GraphStep& step : steps_from(case_, node)) {
        if (forbidden(step.to)) continue;
        offer(k + 1, step.to, 0, cost + step.cost);
        if (!options.allow_skips) continue;
        for (const GraphStep& next : steps_from(case_, step.to)) {
          offer(k + 1, next.to, 0, cost + step.cost + next.cost + options.skip_cost);
        }
      }
    }
    return result;
  }
  Result solve() { return solve(case_.options.threshold); }

 private:
  bool may_show(std::size_t k, const ShownNode& node, double threshold) const {
    if (forbidden(node) || dissimilarity(k, node) > threshold * case_.weight_sum()) return false;
    for (const std::vector<ShownNode>& answer : earlier_) {
      const ShownNode& shown = answer[k];
      if (shown.blended == node.blended && shown.owner == node.owner &&
          std::abs(shown.position - node.position) <= case_.options.apart) {
        return false;
      }
    }
    return true;
  }

  const RetrievalCase& case_;
  std::vector<ShownNode> nodes_;
  std::map<ShownNode, Pose> poses_;
  std::vector<std::map<ShownNode, double>> dissimilarity_;
  std::vector<std::vector<ShownNode>> earlier_;
};

// A motion of a body with this many joints: smooth, on no spot in particular.
inline JointTrack random_track(int frame_count, int joint_count, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto scattered = [&](double scale) {
    Eigen::MatrixX3d points(joint_count, 3);
    for (double& value : points.reshaped()) value = scale * normal(random);
    return points;
  };
  const Eigen::MatrixX3d rest = scattered(0.4);
  const Eigen::MatrixX3d swing = scattered(0.2);
  const Eigen::MatrixX3d sway = scattered(0.2);
  const Eigen::RowVector3d place(3.0 * normal(random), 0.0, 3.0 * normal(random));
  const double pace = 0.2 + 0.1 * std::abs(normal(random));
  JointTrack track;
  for (int f = 0; f < frame_count; ++f) {
    track.push_back((rest + swing * std::sin(pace * f) + sway * std::cos(1.7 * pace * f)).rowwise() + place +
                    scattered(0.01));
  }
  return track;
}

inline GroundTransform random_move(std::mt19937& random) {
  std::uniform_real_distribution<double> yaw(-3.0, 3.0);
  std::normal_distribution<double> place(0.0, 2.0);
  return {.yaw = yaw(random), .translation = {place(random), place(random)}};
}

inline RetrievalCase random_retrieval_case(std::mt19937& random) {
  const auto from_to = [&](int first, int last) {
    return std::uniform_int_distribution<int>(first, last)(random);
  };
  const auto real = [&](double most) { return std::uniform_real_distribution<double>(0.0, most)(random); };
  RetrievalCase c;
  const int joint_count = from_to(2, 5);
  const int clip_count = from_to(1, 3);
  for (int clip = 0; clip < clip_count; ++clip) {
    c.tracks.push_back(random_track(from_to(4, 14), joint_count, random));
  }
  for (int t = from_to(0, 7); t > 0; --t) {
    Transition transition;
    transition.source_clip = static_cast<std::size_t>(from_to(0, clip_count - 1));
    transition.target_clip = static_cast<std::size_t>(from_to(0, clip_count - 1));
    const int source_frames = static_cast<int>(c.tracks[transition.source_clip].size());
    const int target_frames = static_cast<int>(c.tracks[transition.target_clip].size());
    const int half_window = std::min({from_to(1, 3), (source_frames - 1) / 2, (target_frames - 1) / 2});
    transition.half_window = half_window;
    transition.m = from_to(half_window, source_frames - 1 - half_window);
    transition.n = from_to(half_window, target_frames - 1 - half_window);
    transition.source_from_target = random_move(random);
    transition.cost = real(0.5);
    c.transitions.push_back(transition);
  }
  c.profile = from_to(0, 1) == 0 ? BlendProfile::smooth : BlendProfile::linear;
  c.options.retrieval_weight = from_to(0, 2) == 0 ? real(2.0) : 1.0;
  if (from_to(0, 2) == 0) {
    for (int j = 0; j < joint_count; ++j) c.options.joint_weights.push_back(0.1 + real(2.0));
  }
  if (from_to(0, 2) == 0) c.options.velocity_weight = real(3.0);
  c.options.threshold = from_to(0, 3) == 0 ? 100.0 : 0.1 + real(0.8);
  c.options.most_repeats = from_to(0, 3);
  c.options.allow_skips = from_to(0, 2) > 0;
  if (from_to(0, 1) == 0) c.options.repeat_cost = real(0.4);
  if (from_to(0, 1) == 0) c.options.skip_cost = real(0.4);
  if (from_to(0, 4) == 0) {
    c.options.forbidden_clips.push_back(static_cast<std::size_t>(from_to(0, clip_count - 1)));
  }
  // Half of the queries are walked on the graph, at an uneven pace, and blurred; the others are unlike it.
  const int length = from_to(1, 14);
  if (from_to(0, 1) == 0) {
    c.query = random_track(length, joint_count, random);
    return c;
  }
  ShownNode node{false, 0, from_to(0, 2)};
  const JointTrack blur = random_track(length, joint_count, random);
  const double blurred = real(0.2);
  for (int k = 0; k < length; ++k) {
    const Eigen::MatrixX3d joints = pose_of(c, node).joints;
    c.query.push_back(moved(random_move(random), joints + blurred * blur[static_cast<std::size_t>(k)]));
    for (int steps = from_to(0, 2); steps > 0; --steps) {
      const std::vector<GraphStep> next = steps_from(c, node);
      if (!next.empty())
        node = next[static_cast<std::size_t>(from_to(0, static_cast<int>(next.size()) - 1))].to;
    }
  }
  return c;
}

}  // namespace reprise::test
