// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The part of the graph in which one can play for ever, and its cheapest loop.

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "reprise/path/keyframe_optimizer.h"

namespace reprise::path_detail {

// An edge plays on to the next node of the clip, or takes a transition and plays on from its arrival.
struct PlayEdge {
  std::int32_t target = 0;
  std::int32_t transition = -1;  // -1: plays on
  std::int32_t frames = 0;       // from node to node, at least 1
  double cost = 0.0;             // of the transition
};

// The nodes are the frames at which a live transition leaves, by clip and frame. A transition is live if it
// is allowed and another live one leaves its target clip at or after its arrival: whoever takes none but live
// ones never comes to an end. In a clip the live ones are a beginning: what can be reached from a later frame
// can be reached from an earlier one, by playing on.
class PlayGraph {
 public:
  // `allowed`: one mark a transition.
  PlayGraph(const PathMetrics& metrics, const std::vector<bool>& allowed);

  std::int32_t node_count() const { return static_cast<std::int32_t>(frames_.size()); }
  std::size_t clip_of(std::int32_t node) const { return clips_[static_cast<std::size_t>(node)]; }
  int frame_of(std::int32_t node) const { return frames_[static_cast<std::size_t>(node)]; }
  // The first node of a clip at or after a frame, or -1.
  std::int32_t node_at(std::size_t clip_idx, int frame) const;
  // Edges of a node: the transitions first, then (unless it is the last of its clip) playing on.
  const PlayEdge* begin(std::int32_t node) const {
    return edges_.data() + first_edge_[static_cast<std::size_t>(node)];
  }
  const PlayEdge* end(std::int32_t node) const {
    return edges_.data() + first_edge_[static_cast<std::size_t>(node) + 1];
  }

 private:
  std::vector<std::size_t> first_node_;  // of each clip, and one more
  std::vector<std::size_t> clips_;       // of each node
  std::vector<int> frames_;
  std::vector<std::size_t> first_edge_;
  std::vector<PlayEdge> edges_;
};

// A way from node to node: where it starts and the edges it takes.
struct PlayWay {
  std::int32_t start = 0;
  std::vector<PlayEdge> edges;

  double cost() const;
  std::int64_t frames() const;
};

// The cycle of least cost per frame among those that `start` leads to, to 1e-12 metres a frame. It starts
// where it is cheapest to get to.
PlayWay cheapest_loop(const PlayGraph& graph, std::int32_t start);

// The cheapest way from one node to any of those marked, the briefest of several; one exists.
PlayWay cheapest_way(const PlayGraph& graph, std::int32_t start, const std::vector<bool>& goals);

}  // namespace reprise::path_detail
