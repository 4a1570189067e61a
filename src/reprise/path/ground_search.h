// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Key-frame paths that must also arrive somewhere, facing somewhere, or follow a line drawn on the ground.

#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <tl/expected.hpp>

#include "reprise/path/keyframe_optimizer.h"

namespace reprise {

// `find_keyframe_path` for queries with a goal or a route: the least C(P) plus the terms `position`, `turn`
// and `route` of PathCosts. Where a path has come to and which way it faces depends on every transition it
// took, so partial paths hold a place on the ground and few of them can replace each other: beams of growing
// width find good paths, then a best-first search with admissible bounds proves what it can. It may end with
// a gap, after `max_labels` / 4 of them (they are larger); what it returns keeps all hard limits. `NoPath`
// says whether that is proved and how near the nearest path found comes. One thread; the same query gives the
// same path.
//
// Precondition: the query is what `find_keyframe_path` accepts, which comes here by itself. Throws
// `InvalidArgument` for a goal, route, tolerance or weight that is not a number, negative, or too few points,
// and for limits that contradict each other; `Cancelled` if the user asks to stop.
tl::expected<MotionPath, NoPath> find_ground_path(const PathMetrics& metrics, const KeyframeQuery& query,
                                                  const KeyframeOptions& options,
                                                  const std::vector<std::string>& clip_names);

// A path seen from above, in the frame of GroundGoal.
struct GroundTrack {
  std::vector<Eigen::Vector2d> centers;  // (x, z), metres, one a frame as synthesised; the first is zero
  double turn = 0.0;                     // yaw of world_from_clip at the end, radians in (-pi, pi]
};
// Throws `InvalidArgument` if the path takes a transition that `metrics` does not have.
GroundTrack ground_track(const PathMetrics& metrics, const MotionPath& path);

}  // namespace reprise
