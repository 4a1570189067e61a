// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/retrieval_walk.h"

namespace reprise::path_detail {
namespace {

// Takes the nodes of a walk in the order of the path, those that are skipped included.
class PathLayout {
 public:
  explicit PathLayout(const Trellis& trellis) : trellis_(trellis) {}

  void show(std::size_t node) {
    const Trellis::Run& run = trellis_.run_of(node);
    ++length_;
    if (run.blended) {
      if (node == run.first) enter(trellis_.transitions()[run.owner_idx]);
      in_blend_ = true;
      return;
    }
    const int frame = static_cast<int>(node - run.first);
    if (length_ == 1 || in_blend_) path_.segments.push_back({run.owner_idx, frame, frame, {}});
    path_.segments.back().last_frame = frame;
    in_blend_ = false;
  }

  int length() const { return length_; }  // nodes shown so far

  MotionPath finish(double frames_per_second) {
    if (in_blend_) {
      const Transition& transition = *path_.segments.back().transition;
      path_.segments.push_back({transition.target_clip, transition.arrive(), transition.arrive(), {}});
    }
    for (const PathSegment& segment : path_.segments) {
      path_.frame_count += segment.last_frame - segment.first_frame + 1;
      if (segment.transition) path_.frame_count += 2 * segment.transition->half_window - 1;
    }
    path_.time = path_.frame_count / frames_per_second;
    path_.cost = path_.costs.total();
    return path_;
  }

 private:
  void enter(const Transition& transition) {
    path_.segments.back().transition = transition;
    path_.costs.transitions += transition.cost;
  }

  const Trellis& trellis_;
  MotionPath path_;
  int length_ = 0;
  bool in_blend_ = false;
};

}  // namespace

Retrieval lay_out_walk(const Trellis& trellis, const std::vector<TrellisSweep::Visit>& walk,
                       double frames_per_second) {
  using Arrival = TrellisSweep::Arrival;
  Retrieval retrieval;
  PathLayout layout(trellis);
  for (const TrellisSweep::Visit& visit : walk) {
    const bool skip = visit.arrival == Arrival::skip || (visit.entry && visit.entry->is_skip());
    if (skip) layout.show(visit.entry ? static_cast<std::size_t>(visit.entry->via) : visit.node - 1);
    if (visit.arrival != Arrival::repeat) layout.show(visit.node);
    retrieval.path_frame.push_back(layout.length() - 1);
    retrieval.repeats += visit.arrival == Arrival::repeat ? 1 : 0;
    retrieval.skips += skip ? 1 : 0;
  }
  retrieval.path = layout.finish(frames_per_second);
  for (const PathSegment& segment : retrieval.path.segments) {
    retrieval.transitions += segment.transition ? 1 : 0;
  }
  retrieval.transition_cost = retrieval.path.costs.transitions;
  return retrieval;
}

}  // namespace reprise::path_detail
