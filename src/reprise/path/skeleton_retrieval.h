// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Motion-capture retrieval: the path through the surface motion graph whose skeletons are nearest to a query
// (HSSMG 5.2, Eq. 26 to 31, Figure 8).

#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <tl/expected.hpp>

#include "reprise/path/keyframe_query.h"

namespace reprise {

// Joints of every frame of a motion, in the same order everywhere: F entries, J x 3, metres, Y up.
using JointTrack = std::vector<Eigen::MatrixX3d>;

struct RetrievalOptions {
  double retrieval_weight = 1.0;           // w_retr of Eq. 26
  std::vector<double> joint_weights = {};  // w_i of Eq. 28; empty: 1 each
  // Frames: c_skel also counts w_i |v_q - v| times this, v the velocity of the joint in metres a frame (over
  // 3 frames to each side), turned as the skeleton is. 0: Eq. 28 as it stands.
  double velocity_weight = 0.0;
  // T_skel: a frame whose c_skel is above this is no candidate; metres a joint (c_skel over the sum of
  // weights).
  double threshold = 0.35;
  int most_repeats = 4;      // times in a row a frame may be shown again; 0 (none) to 63
  bool allow_skips = true;   // i -> i + 2: a query may be faster than the capture
  double repeat_cost = 0.0;  // of each repeat and of each skip, metres; the paper's is 0
  double skip_cost = 0.0;
  std::vector<std::size_t> forbidden_clips = {};  // never shown, not inside blends either
  std::size_t count = 1;                          // answers wanted
  // Frames: further answers show, at no frame of the query, what an earlier one shows within this many
  // frames.
  int apart = 6;
};

// The best walk through the trellis. Frames of the query are k, those of `path` as it is synthesised (blends
// counted once) are i.
struct Retrieval {
  MotionPath path;              // segments; distance and bound are not filled in
  std::vector<int> path_frame;  // of each query frame; ascending by 0 (a repeat), 1 or 2 (a skip)
  double cost = 0.0;            // C'(P), Eq. 26, and what repeats and skips cost
  double transition_cost = 0.0;
  double retrieval_cost = 0.0;        // C_retr, Eq. 27, without w_retr
  std::vector<double> dissimilarity;  // c_skel of each query frame, metres a joint
  int repeats = 0, skips = 0, transitions = 0;
};

struct NoRetrieval {
  std::size_t query_frame = 0;  // the first at which no node of the trellis can be reached
  double nearest = 0.0;         // metres a joint: the least c_skel of any captured frame there
  std::string nearest_frame;    // CLIP:FRAME
  double enough = 0.0;          // least threshold that leaves a path; infinite: none does
  std::string reason;           // a sentence with all of that
};

// What all queries of a graph share: joints of all captured frames, and of all blended ones, laid out for
// fast comparison. Immutable; thread-safe.
class SkeletonRetriever {
 public:
  // `tracks`: one a clip, as many frames; joints the same in all. Blended frames have the joints of both
  // clips, aligned by the transition, mixed linearly. Throws `InvalidArgument` if shapes or transitions do
  // not fit.
  SkeletonRetriever(const std::vector<JointTrack>& tracks, std::vector<std::string> clip_names,
                    std::vector<Transition> transitions, BlendProfile profile, double frames_per_second);
  ~SkeletonRetriever();
  SkeletonRetriever(SkeletonRetriever&&) noexcept;

  // The global optimum of Eq. 29 on the trellis, then answers that differ (`apart`). c_skel (Eq. 28) is taken
  // after the yaw and ground translation that bring the captured joints nearest to the query's in the
  // least-squares sense. A transition is walked as it is shown: 2 L - 1 blended frames between leaving and
  // arriving, each with a node of its own, its cost at its first one. Repeats and skips go over blended
  // frames as over others; a path starts and ends anywhere but, at its start, inside a blend. O(query frames
  // x edges), a byte a node. Parallel, the same for any number of threads. Throws `InvalidArgument` for an
  // empty query, joints that do not fit, options out of range; `Cancelled`.
  tl::expected<std::vector<Retrieval>, NoRetrieval> retrieve(const JointTrack& query,
                                                             const RetrievalOptions& options = {}) const;

  std::size_t node_count() const;  // captured and blended frames

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace reprise
