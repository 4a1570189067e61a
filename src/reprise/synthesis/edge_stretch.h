// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// How far the edges of a surface are stretched, over any number of frames.

#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "reprise/mesh/mesh.h"

namespace reprise {

// The edges of a surface with their lengths on one of its frames. Immutable; shared by those who count.
struct ReferenceEdges {
  ReferenceEdges(const Topology& topology, const PositionsView& reference);

  // Those without length are left out: a ratio to it says nothing.
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  std::vector<double> lengths;  // metres
};

// Counts edge length over reference edge length on a logarithmic scale: percentiles of any number of frames
// in constant memory, to better than 0.02 %.
class EdgeStretch {
 public:
  explicit EdgeStretch(std::shared_ptr<const ReferenceEdges> reference);

  void add(const PositionsView& frame);
  // Nearest rank; 0 before any frame.
  double percentile(double share) const;

 private:
  std::shared_ptr<const ReferenceEdges> reference_;
  std::vector<std::uint64_t> counts_;
  std::uint64_t total_ = 0;
};

}  // namespace reprise
