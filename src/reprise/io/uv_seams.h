// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// One texture coordinate a vertex, for formats that know no others.

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "reprise/mesh/topology.h"

namespace reprise {

// A surface cut along its texture seams.
struct SeamCut {
  // The vertex each new vertex is a copy of. The first `vertex_count` are the vertices themselves, in order;
  // copies for further texture coordinates follow.
  std::vector<std::int32_t> source_vertices;
  std::vector<std::array<float, 2>> uvs;  // one per new vertex; (0, 0) where no triangle gives one
  std::vector<Triangle> triangles;        // on the new vertices, in the same order as before

  bool has_copies(const Topology& topology) const {
    return source_vertices.size() > static_cast<std::size_t>(topology.vertex_count);
  }
};

// Gives every vertex as many copies as it has different texture coordinates. Without UVs nothing is cut and
// `uvs` is empty.
SeamCut cut_at_seams(const Topology& topology);

}  // namespace reprise
