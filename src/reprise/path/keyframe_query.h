// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Key-frame queries and motion paths (HSSMG 5.1).

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reprise/graph/surface_motion_graph.h"

namespace reprise {

struct KeyframeQuery {
  std::vector<FrameId> keyframes;  // at least two, shown in this order, each as a pure captured frame
  double distance = 0.0;           // d_V, metres along the ground, from first to last key-frame
  double time = 0.0;               // t_V, seconds
};

struct KeyframeOptions {
  double distance_weight =
      1.0 / 0.3;  // w_dist per metre: 0.3 m weigh as much as 10 frames or 1 m of transition cost
  double time_weight = 1.0 / 10.0;     // w_time per frame
  std::size_t max_labels = 4'000'000;  // search effort (64 comparisons count as one) after which the best
                                       // path so far is returned with its gap
};

// One stretch of a path: frames first..last of a clip shown as captured, then (unless it is the last) a
// transition.
struct PathSegment {
  std::size_t clip_idx = 0;
  int first_frame = 0;                   // the first pure frame
  int last_frame = 0;                    // the last pure frame; >= first_frame
  std::optional<Transition> transition;  // leaves from last_frame
};

// A path through the graph with its certificate.
struct MotionPath {
  std::vector<PathSegment> segments;
  double transition_cost = 0.0;  // C_tran, Eq. 8
  double distance = 0.0;         // dist(P), Eq. 10, metres over the frames as synthesised
  int frame_count = 0;           // N_f, blended frames counted once
  double time = 0.0;             // N_f / frames per second, seconds, Eq. 12
  double cost = 0.0;             // C(P), Eq. 7
  double lower_bound = 0.0;      // no path costs less; equals `cost` when the optimum is proved
  std::size_t labels = 0;        // partial paths the search looked at

  double gap() const { return cost - lower_bound; }
};

// Why there is no path.
struct NoPath {
  std::string reason;  // which key-frame cannot be reached from which, and what the graph lacks
};

}  // namespace reprise
