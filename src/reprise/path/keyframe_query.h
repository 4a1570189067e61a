// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Key-frame queries and motion paths (HSSMG 5.1).

#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "reprise/graph/surface_motion_graph.h"

namespace reprise {

inline constexpr double unlimited = std::numeric_limits<double>::infinity();

// Where the last key-frame is to stand, seen from the first: the ground centre (Eq. 10) of the first
// key-frame is the origin, the axes are those of its clip, (x, z) in metres. Where clips were captured does
// not matter, which way they lie does: they are taken to face the same way, as captured on one stage.
struct GroundGoal {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  // How far the performer has turned by then against the way the last key-frame was captured, radians about
  // +Y (left is positive): the yaw of world_from_clip of its clip, where the world is the first key-frame's
  // clip. A whole turn counts as none.
  std::optional<double> turn;
  double position_tolerance = unlimited;  // metres: a hard limit on the distance from `position`
  double turn_tolerance = unlimited;      // radians: a hard limit on the difference from `turn`
};

// A line drawn on the ground for the performer to follow from its first point to its last, in the frame of
// GroundGoal: at least two different points. It may cross itself. A marker walks along with the performer: in
// each frame it moves to the point of the line nearest to the centre, never back and never more than 2 m
// ahead; the distance from centre to marker is the frame's deviation.
struct GroundRoute {
  std::vector<Eigen::Vector2d> points;
  double max_deviation = unlimited;  // metres: a hard limit on the deviation of every frame
};

struct KeyframeQuery {
  std::vector<FrameId> keyframes;  // at least two, shown in this order, each as a pure captured frame
  double distance = 0.0;           // d_V, metres along the ground, from first to last key-frame
  double time = 0.0;               // t_V, seconds
  // Hard limits on dist(P), metres, and time(P), seconds.
  double min_distance = 0.0;
  double max_distance = unlimited;
  double min_time = 0.0;
  double max_time = unlimited;
  std::vector<std::size_t> forbidden_clips;   // never shown, not inside blends either
  std::vector<std::size_t> compulsory_clips;  // each shown as captured in at least one frame
  std::optional<GroundGoal> goal;
  std::optional<GroundRoute> route;
};

struct KeyframeOptions {
  double distance_weight =
      1.0 / 0.3;  // w_dist per metre: 0.3 m weigh as much as 10 frames or 1 m of transition cost
  double time_weight = 1.0 / 10.0;     // w_time per frame
  double position_weight = 1.0 / 0.3;  // per metre between GroundGoal::position and where the path ends
  double turn_weight = 1.0;            // per radian between GroundGoal::turn and that of the path
  double route_weight = 1.0;  // per metre-second of deviation from GroundRoute (summed over frames); what
                              // is left of the line at the end costs position_weight per metre
  std::size_t max_labels = 4'000'000;  // search effort after which the best path so far is returned with its
                                       // gap
};

// One stretch of a path: frames first..last of a clip shown as captured, then (unless it is the last) a
// transition.
struct PathSegment {
  std::size_t clip_idx = 0;
  int first_frame = 0;                   // the first pure frame
  int last_frame = 0;                    // the last pure frame; >= first_frame
  std::optional<Transition> transition;  // leaves from last_frame
};

// The terms of a path's cost, weights included; what was not asked for is zero.
struct PathCosts {
  double transitions = 0.0;  // C_tran, Eq. 8
  double distance = 0.0;     // w_dist |dist(P) - d_V|
  double time = 0.0;         // w_time |time(P) - t_V|
  double position = 0.0;     // end position on the ground
  double turn = 0.0;         // end facing
  double route = 0.0;        // deviation from the drawn line, and what is left of it at the end

  double total() const { return transitions + distance + time + position + turn + route; }
};

// A path through the graph with its certificate.
struct MotionPath {
  std::vector<PathSegment> segments;
  PathCosts costs;
  double distance = 0.0;     // dist(P), Eq. 10, metres over the frames as synthesised
  int frame_count = 0;       // N_f, blended frames counted once
  double time = 0.0;         // N_f / frames per second, seconds, Eq. 12
  double cost = 0.0;         // C(P), Eq. 7: costs.total()
  double lower_bound = 0.0;  // no path costs less; equals `cost` when the optimum is proved
  std::size_t labels = 0;    // partial paths the search looked at

  double gap() const { return cost - lower_bound; }
};

// Why there is no path.
struct NoPath {
  std::string reason;  // which key-frame cannot be reached from which, and what the graph lacks
};

}  // namespace reprise
