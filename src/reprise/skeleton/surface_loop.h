// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Shortest loops around limbs: the geodesic rings at which a body is cut into bones.

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "reprise/mesh/geodesic.h"

namespace reprise::skeleton {

class LoopFinder {
 public:
  // `terminals`: the tips of the body (hands, feet), at most 32; `base`: the vertex they are told apart from
  // (top of the head). `topology` and `positions` must outlive the finder. Throws `InvalidArgument` naming
  // the index of a terminal that no path over triangles joins with the base.
  LoopFinder(const Topology& topology, const PositionsView& positions, std::int32_t base,
             std::span<const std::int32_t> terminals);

  // The shortest loop over edges through (or close by) `through` that separates exactly the terminals with a
  // bit in `separated` from the base: on a closed surface of genus 0 a loop does so if a path of triangles
  // from the base to the terminal crosses it an odd number of times. It keeps off `tip`, the end of the limb
  // that it goes around: over the half of the surface nearer to it, a way there and back could be shorter
  // than the way around. Vertices in order, each once; empty if there is no such loop.
  std::vector<std::int32_t> loop(std::int32_t through, std::uint32_t separated, std::int32_t tip) const;

  // The vertices that can be reached from `start` without crossing the loop, with the loop itself: one entry
  // a vertex.
  std::vector<bool> beyond(const std::vector<std::int32_t>& loop, std::int32_t start) const;

  // Centroid of the loop's curve.
  Eigen::Vector3d centroid(const std::vector<std::int32_t>& loop) const;

  const EdgeGraph& graph() const { return graph_; }

 private:
  struct Crossing {
    std::uint64_t edge = 0;  // the vertices of an edge, smaller first
    std::uint32_t terminals = 0;
  };
  std::uint32_t crossed(std::int32_t a, std::int32_t b) const;

  PositionsView positions_;
  EdgeGraph graph_;
  std::vector<Crossing> crossings_;  // edges that paths of triangles cross, ascending
};

}  // namespace reprise::skeleton
