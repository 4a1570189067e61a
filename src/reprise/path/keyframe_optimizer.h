// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The exact optimiser of key-frame paths.

#pragma once

#include <memory>

#include <Eigen/Core>
#include <tl/expected.hpp>

#include "reprise/path/keyframe_query.h"

namespace reprise {

// Ground motion of a graph's clips and blends: all that the optimiser needs to know of the database.
class PathMetrics {
 public:
  // `trajectories`: for each clip its ground trajectory, (x, z) in metres per frame. `transitions`: those in
  // force. Distances inside a blend are those of the blended trajectory (1 - alpha) c_s(m + k) + alpha
  // source_from_target c_t(n + k), which is what synthesis plays. Throws `InvalidArgument` for a transition
  // between clips that do not exist, whose window leaves its clip or whose cost is negative or not finite,
  // and for a rate that is not positive.
  PathMetrics(std::vector<std::vector<Eigen::Vector2d>> trajectories, std::vector<Transition> transitions,
              BlendProfile profile, double frames_per_second);

  const std::vector<Transition>& transitions() const { return transitions_; }
  std::size_t clip_count() const { return cumulative_.size(); }
  int frame_count(std::size_t clip_idx) const { return static_cast<int>(cumulative_[clip_idx].size()); }
  double frames_per_second() const { return frames_per_second_; }
  // Metres along the ground from one frame of a clip to a later one.
  double clip_distance(std::size_t clip_idx, int first, int last) const {
    return cumulative_[clip_idx][static_cast<std::size_t>(last)] -
           cumulative_[clip_idx][static_cast<std::size_t>(first)];
  }
  // Metres along the ground through the blend of a transition, from its leave() to its arrive().
  double blend_distance(std::size_t transition_idx) const { return blend_distances_[transition_idx]; }
  // Ground centres of a clip, (x, z) in metres per frame.
  const std::vector<Eigen::Vector2d>& trajectory(std::size_t clip_idx) const {
    return trajectories_[clip_idx];
  }
  // Ground centre at frame k in [-L, L] of a transition's blend, in the source clip's coordinates.
  Eigen::Vector2d blend_center(std::size_t transition_idx, int k) const;
  // The same without the transitions marked. Throws `InvalidArgument` unless there is one mark a transition.
  PathMetrics without(const std::vector<bool>& transitions) const;

 private:
  std::vector<std::vector<Eigen::Vector2d>> trajectories_;
  std::vector<std::vector<double>> cumulative_;
  std::vector<Transition> transitions_;
  BlendProfile profile_;
  std::vector<double> blend_distances_;
  double frames_per_second_;
};

// The path that minimises C(P) = C_tran + w_dist |dist(P) - d_V| + w_time |time(P) - t_V| (Eq. 7) over all
// walks on the graph that show the key-frames in order, loops any number of times, with a certificate.
//
// Method: partial paths (decision frame, key-frames shown, frames elapsed, distance, cost) are swept in the
// order of time, those whose lower bound is below a rising threshold. One is dropped if another with the same
// first three has cost lower by at least w_dist times their difference in distance: whatever follows, it
// cannot do worse. What follows is bounded by tables, over frames to go, of the least transition cost plus
// multiplier times distance, for several multipliers between -w_dist and w_dist. A consecutive pair of equal
// key-frames asks for a loop: a key-frame must be shown strictly later than the one before it.
//
// Hard limits on distance are met by steeper slopes outside of them: an optimum of that problem that keeps
// the limits is the optimum of the limited one. A query with a goal or a route goes to `find_ground_path`
// (ground_search.h), whose gap may be greater than zero.
//
// Costs that differ by less than 1e-9 count as equal; then the gap is exactly 0. The gap is greater only if
// the search ended at `max_labels`. With w_time = 0 time is ignored. One thread; the same query gives the
// same path.
//
// Throws `InvalidArgument` for fewer than two key-frames, a frame out of range, a target, limit or weight
// that is negative or not a number, limits that contradict each other, a clip that is both compulsory and
// forbidden, a key-frame in a forbidden clip, or names that are not one a clip; `Cancelled` if the user asks
// to stop.
tl::expected<MotionPath, NoPath> find_keyframe_path(const PathMetrics& metrics, const KeyframeQuery& query,
                                                    const KeyframeOptions& options,
                                                    const std::vector<std::string>& clip_names);

// The same for many targets of one query: what targets share is made once. Thread-safe.
class KeyframeOptimizer {
 public:
  // `query`: its targets are ignored; a goal or a route is refused. `longest_time`: the greatest target that
  // will be asked for, seconds (others take longer to find). Keeps a reference to `metrics`. Throws what
  // `find_keyframe_path` throws, and `InvalidArgument` for a goal, a route or a time that is negative.
  KeyframeOptimizer(const PathMetrics& metrics, KeyframeQuery query, const KeyframeOptions& options,
                    const std::vector<std::string>& clip_names, double longest_time);
  ~KeyframeOptimizer();
  KeyframeOptimizer(KeyframeOptimizer&&) noexcept;

  // `find_keyframe_path` with these targets (metres, seconds): an optimum of the same cost.
  tl::expected<MotionPath, NoPath> find(double distance, double time) const;

 private:
  struct Shared;
  std::unique_ptr<const Shared> shared_;
};

}  // namespace reprise
