// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// How far the parts of a tree reach, as distances along the surface. Internal.

#pragma once

#include <cstdint>
#include <vector>

#include "reprise/mesh/geodesic.h"

namespace reprise {

using VertexMask = std::vector<std::uint8_t>;  // one entry a vertex, 0 or 1

struct PartTerritory {
  int parent = -1;
  VertexMask holds;
};

struct PartDistances {
  // D_p of `PartHierarchy`; `EdgeGraph::unreached` where the part has no border, 0 where it does not hold the
  // vertex or has handed over to its children.
  std::vector<float> to_outside;
  // The parent's share in [0, 1], for every vertex (meant where both hold it); empty for the root.
  std::vector<float> parent_share;
};

// `parts`: parents before children.
std::vector<PartDistances> part_distances(const EdgeGraph& graph, const std::vector<PartTerritory>& parts,
                                          double takeover);

}  // namespace reprise
