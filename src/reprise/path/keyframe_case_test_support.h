// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Small graphs and queries, random or by hand, and what must hold of any answer, for the tests of paths.

#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "reprise/path/keyframe_optimizer.h"

namespace reprise::test {

using Trajectory = std::vector<Eigen::Vector2d>;

inline constexpr double fps = 25.0;

// Straight ahead at a constant speed, metres per frame.
inline Trajectory straight(int frame_count, double speed) {
  Trajectory trajectory;
  for (int i = 0; i < frame_count; ++i) trajectory.emplace_back(0.0, speed * i);
  return trajectory;
}

struct Case {
  std::vector<Trajectory> trajectories;
  std::vector<Transition> transitions;
  KeyframeQuery query;
  KeyframeOptions options;

  PathMetrics metrics() const { return {trajectories, transitions, BlendProfile::smooth, fps}; }
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < trajectories.size(); ++i) names.push_back(fmt::format("clip{}", i));
    return names;
  }
  tl::expected<MotionPath, NoPath> solve() const {
    return find_keyframe_path(metrics(), query, options, names());
  }
  double target_frames() const { return query.time * fps; }
};

inline Transition make_transition(const std::vector<Trajectory>& trajectories, std::size_t source, int m,
                                  std::size_t target, int n, int half_window, double cost) {
  Transition transition;
  transition.source_clip = source;
  transition.target_clip = target;
  transition.m = m;
  transition.n = n;
  transition.half_window = half_window;
  transition.cost = cost;
  transition.source_from_target.translation =
      trajectories[source][static_cast<std::size_t>(m)] - trajectories[target][static_cast<std::size_t>(n)];
  return transition;
}

struct Sizes {
  int clips = 2;
  int min_frames = 8;
  int max_frames = 14;
  int min_transitions = 3;
  int max_transitions = 5;
  int max_half_window = 2;
  int max_keyframes = 3;
  // Transitions leave and arrive at multiples of this, so that walks of as many frames but other distances
  // meet.
  int grid = 1;
};

inline Case random_case(const Sizes& sizes, std::mt19937& random) {
  const auto integer = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  const auto real = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Case result;
  for (int i = 0; i < sizes.clips; ++i) {
    Trajectory trajectory{Eigen::Vector2d::Zero()};
    const double speed = real(0.0, 0.08);
    for (int frame = integer(sizes.min_frames, sizes.max_frames); frame > 1; --frame) {
      trajectory.push_back(trajectory.back() + Eigen::Vector2d(real(-0.02, 0.02), speed + real(-0.02, 0.02)));
    }
    result.trajectories.push_back(std::move(trajectory));
  }
  const auto last_frame = [&](std::size_t clip_idx) {
    return static_cast<int>(result.trajectories[clip_idx].size()) - 1;
  };
  // Some graphs have transitions at no cost, and then many walks cost the same.
  const bool free_transitions = integer(0, 4) == 0;
  for (int count = integer(sizes.min_transitions, sizes.max_transitions); count > 0; --count) {
    const auto source = static_cast<std::size_t>(integer(0, sizes.clips - 1));
    const auto target = static_cast<std::size_t>(integer(0, sizes.clips - 1));
    const int L = sizes.grid == 1 ? integer(1, sizes.max_half_window) : sizes.max_half_window;
    const int m = integer(0, (last_frame(source) - 2 * L) / sizes.grid) * sizes.grid + L;
    const int n = integer(2 * L / sizes.grid + 1, last_frame(target) / sizes.grid) * sizes.grid - L;
    const double cost = free_transitions && integer(0, 1) == 0 ? 0.0 : real(0.05, 0.6);
    result.transitions.push_back(make_transition(result.trajectories, source, m, target, n, L, cost));
    result.transitions.back().source_from_target.yaw = real(-3.0, 3.0);
  }
  for (int count = integer(2, sizes.max_keyframes); count > 0; --count) {
    const auto clip_idx = static_cast<std::size_t>(integer(0, sizes.clips - 1));
    result.query.keyframes.push_back({clip_idx, static_cast<std::size_t>(integer(0, last_frame(clip_idx)))});
  }
  return result;
}

// Limits near what the path without limits does, so that some of them tell and some leave no path.
inline void limit_at_random(Case& query_case, const MotionPath& free, std::mt19937& random) {
  const auto real = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto one_in = [&](int count) { return std::uniform_int_distribution<int>(1, count)(random) == 1; };
  KeyframeQuery& query = query_case.query;
  if (one_in(2)) query.min_distance = free.distance * real(0.7, 1.4);
  if (one_in(2)) query.max_distance = std::max(query.min_distance, free.distance) * real(0.8, 1.1);
  // Whole numbers of frames, which a path may just meet, and others.
  const auto frames = [&](double factor) {
    const double count = factor * free.frame_count;
    return (one_in(2) ? std::round(count) : count) / fps;
  };
  if (one_in(2)) query.min_time = frames(real(0.7, 1.4));
  if (one_in(2)) query.max_time = std::max(query.min_time, frames(real(0.8, 1.1)));
  // Room for some sum of distances between the limits: to show that there is none is hard.
  query.max_distance = std::max(query.max_distance, 1.05 * query.min_distance);
  for (std::size_t clip_idx = 0; clip_idx < query_case.trajectories.size(); ++clip_idx) {
    const bool holds_keyframe =
        std::any_of(query.keyframes.begin(), query.keyframes.end(),
                    [&](const FrameId& keyframe) { return keyframe.clip_idx == clip_idx; });
    if (!holds_keyframe && one_in(4)) {
      query.forbidden_clips.push_back(clip_idx);
    } else if (one_in(3)) {
      query.compulsory_clips.push_back(clip_idx);
    }
  }
}

// What a path plays, told by its segments alone.
struct Replay {
  std::vector<FrameId> pure_frames;
  double transition_cost = 0.0;
  double distance = 0.0;
  int frame_count = 0;
};

// Plays every frame, blended ones too, and adds up the distances between neighbours (Eq. 10). Each segment is
// placed by the transitions before it; only distances count, so the placing itself does not.
inline Replay replay(const Case& query_case, const MotionPath& path) {
  Replay result;
  for (std::size_t i = 0; i < path.segments.size(); ++i) {
    const PathSegment& segment = path.segments[i];
    const Trajectory& source = query_case.trajectories[segment.clip_idx];
    for (int frame = segment.first_frame; frame <= segment.last_frame; ++frame) {
      result.pure_frames.push_back({segment.clip_idx, static_cast<std::size_t>(frame)});
      ++result.frame_count;
      if (frame > segment.first_frame) {
        result.distance +=
            (source[static_cast<std::size_t>(frame)] - source[static_cast<std::size_t>(frame - 1)]).norm();
      }
    }
    if (!segment.transition) continue;
    const Transition& transition = *segment.transition;
    result.transition_cost += transition.cost;
    const Trajectory& target = query_case.trajectories[transition.target_clip];
    Eigen::Vector2d previous = source[static_cast<std::size_t>(transition.leave())];
    for (int k = -transition.half_window + 1; k <= transition.half_window; ++k) {
      const double alpha = blend_weight(BlendProfile::smooth, k, transition.half_window);
      const Eigen::Vector2d target_center =
          transition.source_from_target * target[static_cast<std::size_t>(transition.n + k)];
      const Eigen::Vector2d center =
          (1.0 - alpha) * source[static_cast<std::size_t>(transition.m + k)] + alpha * target_center;
      result.distance += (center - previous).norm();
      previous = center;
      // The last frame of the window is the first pure one of the next segment.
      if (k < transition.half_window) ++result.frame_count;
    }
  }
  return result;
}

// Whether the key-frames are shown in order, from the first pure frame to the last.
inline bool shows_in_order(const std::vector<FrameId>& pure_frames, const std::vector<FrameId>& keyframes) {
  if (pure_frames.size() < 2 || !(pure_frames.front() == keyframes.front()) ||
      !(pure_frames.back() == keyframes.back())) {
    return false;
  }
  std::size_t due = 1;
  for (std::size_t i = 1; i + 1 < pure_frames.size() && due + 1 < keyframes.size(); ++i) {
    if (pure_frames[i] == keyframes[due]) ++due;
  }
  return due + 1 == keyframes.size();
}

// Whether the path keeps its hard limits and shows the clips it must and none that it must not.
inline bool keeps_limits(const Case& query_case, const std::vector<FrameId>& pure_frames, double distance,
                         int frame_count, double tolerance = 1e-9) {
  const KeyframeQuery& query = query_case.query;
  const auto shows = [&](std::size_t clip_idx) {
    return std::any_of(pure_frames.begin(), pure_frames.end(),
                       [&](const FrameId& frame) { return frame.clip_idx == clip_idx; });
  };
  return distance >= query.min_distance - tolerance && distance <= query.max_distance + tolerance &&
         frame_count >= query.min_time * fps - 1e-9 && frame_count <= query.max_time * fps + 1e-9 &&
         std::all_of(query.compulsory_clips.begin(), query.compulsory_clips.end(), shows) &&
         std::none_of(query.forbidden_clips.begin(), query.forbidden_clips.end(), shows);
}

inline double cost_of(const Case& query_case, double transition_cost, double distance, int frame_count) {
  return transition_cost +
         query_case.options.distance_weight * std::abs(distance - query_case.query.distance) +
         query_case.options.time_weight * std::abs(frame_count - query_case.target_frames());
}

// All that must hold of any answer.
inline void expect_valid(const Case& query_case, const MotionPath& path) {
  ASSERT_FALSE(path.segments.empty());
  for (std::size_t i = 0; i < path.segments.size(); ++i) {
    const PathSegment& segment = path.segments[i];
    EXPECT_LE(segment.first_frame, segment.last_frame);
    ASSERT_EQ(segment.transition.has_value(), i + 1 < path.segments.size());
    if (!segment.transition) continue;
    EXPECT_EQ(segment.transition->source_clip, segment.clip_idx);
    EXPECT_EQ(segment.transition->leave(), segment.last_frame);
    EXPECT_EQ(segment.transition->target_clip, path.segments[i + 1].clip_idx);
    EXPECT_EQ(segment.transition->arrive(), path.segments[i + 1].first_frame);
  }
  const Replay played = replay(query_case, path);
  EXPECT_TRUE(shows_in_order(played.pure_frames, query_case.query.keyframes));
  EXPECT_TRUE(keeps_limits(query_case, played.pure_frames, played.distance, played.frame_count));
  EXPECT_EQ(path.frame_count, played.frame_count);
  EXPECT_NEAR(path.time, played.frame_count / fps, 1e-12);
  EXPECT_NEAR(path.distance, played.distance, 1e-9);
  EXPECT_NEAR(path.costs.transitions, played.transition_cost, 1e-9);
  EXPECT_NEAR(path.cost, cost_of(query_case, played.transition_cost, played.distance, played.frame_count),
              1e-8);
  EXPECT_LE(path.lower_bound, path.cost);
}

// A walk that can loop (0 -> 0) and a stand that it can go to and come back from.
inline Case walk_and_stand() {
  Case result;
  result.trajectories = {straight(40, 0.04), straight(30, 0.0)};
  result.transitions = {make_transition(result.trajectories, 0, 34, 0, 5, 4, 0.2),
                        make_transition(result.trajectories, 0, 20, 1, 6, 3, 0.3),
                        make_transition(result.trajectories, 1, 22, 0, 8, 3, 0.3)};
  result.query.keyframes = {{0, 2}, {0, 36}};
  return result;
}

}  // namespace reprise::test
