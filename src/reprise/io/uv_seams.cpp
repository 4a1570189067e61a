// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/uv_seams.h"

#include <numeric>

namespace reprise {

SeamCut cut_at_seams(const Topology& topology) {
  const auto vertex_count = static_cast<std::size_t>(topology.vertex_count);
  SeamCut cut;
  cut.source_vertices.resize(vertex_count);
  std::iota(cut.source_vertices.begin(), cut.source_vertices.end(), 0);
  cut.triangles = topology.triangles;
  if (!topology.has_uvs()) return cut;

  cut.uvs.resize(vertex_count);
  std::vector<bool> has_uv(vertex_count, false);
  std::vector<std::int32_t> next_copy(vertex_count,
                                      -1);  // the copies of a vertex are a chain that starts at itself
  for (std::size_t t = 0; t < cut.triangles.size(); ++t) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::int32_t vertex = topology.triangles[t][corner];
      const auto& uv = topology.uvs[static_cast<std::size_t>(topology.triangle_uvs[t][corner])];
      auto at = static_cast<std::size_t>(vertex);
      if (!has_uv[at]) {
        has_uv[at] = true;
        cut.uvs[at] = uv;
      }
      while (cut.uvs[at] != uv && next_copy[at] >= 0) at = static_cast<std::size_t>(next_copy[at]);
      if (cut.uvs[at] != uv) {
        next_copy[at] = static_cast<std::int32_t>(cut.uvs.size());
        at = cut.uvs.size();
        cut.uvs.push_back(uv);
        cut.source_vertices.push_back(vertex);
        next_copy.push_back(-1);
      }
      cut.triangles[t][corner] = static_cast<std::int32_t>(at);
    }
  }
  return cut;
}

}  // namespace reprise
