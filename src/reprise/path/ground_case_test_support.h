// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Every path of a small query with places, one after the other: the oracle of the search over the ground.

#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "reprise/math/ground_transform.h"
#include "reprise/path/keyframe_case_test_support.h"
#include "reprise/path/route_line.h"

namespace reprise::test {

// A path played frame by frame.
struct PlayedWalk {
  std::vector<Eigen::Vector2d> centers;  // in the frame of GroundGoal
  double turn = 0.0;
  double transition_cost = 0.0;

  double distance() const {
    double sum = 0.0;
    for (std::size_t i = 1; i < centers.size(); ++i) sum += (centers[i] - centers[i - 1]).norm();
    return sum;
  }
};

// What the walk costs the query; infinite if it breaks a limit. By the definitions of KeyframeQuery.
inline double ground_cost(const Case& query_case, const PlayedWalk& walk) {
  const KeyframeQuery& query = query_case.query;
  const KeyframeOptions& options = query_case.options;
  constexpr double broken = std::numeric_limits<double>::infinity();
  const double distance = walk.distance();
  const auto frames = static_cast<double>(walk.centers.size());
  if (distance < query.min_distance - 1e-9 || distance > query.max_distance + 1e-9) return broken;
  if (frames < query.min_time * fps - 1e-9 || frames > query.max_time * fps + 1e-9) return broken;
  double cost = walk.transition_cost + options.distance_weight * std::abs(distance - query.distance) +
                options.time_weight * std::abs(frames - query.time * fps);
  if (query.goal) {
    const double gap = (walk.centers.back() - query.goal->position).norm();
    if (gap > query.goal->position_tolerance + 1e-9) return broken;
    cost += options.position_weight * gap;
    if (query.goal->turn) {
      const double turn = std::abs(wrap_angle(walk.turn - *query.goal->turn));
      if (turn > query.goal->turn_tolerance + 1e-9) return broken;
      cost += options.turn_weight * turn;
    }
  }
  if (query.route) {
    const path_detail::RouteLine line(query.route->points);
    path_detail::RouteLine::Match match;
    for (const Eigen::Vector2d& center : walk.centers) {
      match = line.follow(match.marker, center);
      if (match.deviation > query.route->max_deviation + 1e-9) return broken;
      cost += options.route_weight * match.deviation / fps;
    }
    cost += options.position_weight * (match.deviation + line.length() - match.marker);
  }
  return cost;
}

// Calls `visit` with every path through the key-frames of at most `query.max_time`, which must be finite.
template <typename Visit>
class EveryPath {
 public:
  EveryPath(const Case& query_case, Visit visit)
      : case_(query_case),
        visit_(visit),
        most_frames_(static_cast<std::size_t>(std::floor(query_case.query.max_time * fps + 1e-9))) {
    const FrameId first = case_.query.keyframes.front();
    GroundTransform world_from_clip;
    world_from_clip.translation = -case_.trajectories[first.clip_idx][first.frame_idx];
    show(first.clip_idx, static_cast<int>(first.frame_idx), world_from_clip, 0);
  }

 private:
  // A pure frame, once `shown` key-frames are behind.
  void show(std::size_t clip_idx, int frame, const GroundTransform& world_from_clip, std::size_t shown) {
    if (walk_.centers.size() >= most_frames_) return;
    const Trajectory& clip = case_.trajectories[clip_idx];
    walk_.centers.push_back(world_from_clip * clip[static_cast<std::size_t>(frame)]);
    const std::vector<FrameId>& keyframes = case_.query.keyframes;
    if (keyframes[shown] == FrameId{clip_idx, static_cast<std::size_t>(frame)}) {
      if (shown + 1 == keyframes.size()) {
        walk_.turn = world_from_clip.yaw;
        visit_(walk_);
      } else {
        ++shown;
      }
    }
    if (frame + 1 < static_cast<int>(clip.size())) show(clip_idx, frame + 1, world_from_clip, shown);
    for (const Transition& transition : case_.transitions) {
      if (transition.source_clip != clip_idx || transition.leave() != frame) continue;
      const std::size_t length = walk_.centers.size();
      const double cost = walk_.transition_cost;
      const Trajectory& target = case_.trajectories[transition.target_clip];
      for (int k = 1 - transition.half_window; k < transition.half_window; ++k) {
        const double alpha = blend_weight(BlendProfile::smooth, k, transition.half_window);
        walk_.centers.push_back(
            world_from_clip *
            Eigen::Vector2d((1.0 - alpha) * clip[static_cast<std::size_t>(transition.m + k)] +
                            alpha * (transition.source_from_target *
                                     target[static_cast<std::size_t>(transition.n + k)])));
      }
      walk_.transition_cost += transition.cost;
      show(transition.target_clip, transition.arrive(), world_from_clip * transition.source_from_target,
           shown);
      walk_.transition_cost = cost;
      walk_.centers.resize(length);
    }
    walk_.centers.pop_back();
  }

  const Case& case_;
  Visit visit_;
  std::size_t most_frames_;
  PlayedWalk walk_;
};

struct Exhausted {
  double least_cost = std::numeric_limits<double>::infinity();  // infinite: no path keeps the limits
  std::size_t paths = 0;
};
inline Exhausted exhaust(const Case& query_case) {
  Exhausted result;
  EveryPath(query_case, [&](const PlayedWalk& walk) {
    ++result.paths;
    result.least_cost = std::min(result.least_cost, ground_cost(query_case, walk));
  });
  return result;
}

// A small graph whose transitions turn, with key-frames that can be shown.
inline Case turning_case(std::mt19937& random) {
  const auto real = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (;;) {
    Case result = random_case({.clips = 2, .min_frames = 9, .max_frames = 14, .max_keyframes = 3}, random);
    result.query.max_time = 34.0 / fps;
    result.query.time = real(0.3, 1.3);
    result.query.distance = real(0.0, 1.5);
    std::size_t paths = 0;
    EveryPath(result, [&](const PlayedWalk& /*walk*/) { ++paths; });
    if (paths > 3) return result;
  }
}

inline GroundGoal random_goal(std::mt19937& random) {
  const auto real = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  GroundGoal goal{.position = {real(-0.6, 0.6), real(-0.6, 0.6)}, .turn = {}};
  if (real(0.0, 1.0) < 0.7) goal.turn = real(-3.0, 3.0);
  return goal;
}

}  // namespace reprise::test
