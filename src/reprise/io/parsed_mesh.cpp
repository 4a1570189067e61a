// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/parsed_mesh.h"

#include <algorithm>
#include <cmath>

namespace reprise {

void drop_repeated_corners(ParsedMesh& mesh) {
  std::vector<Triangle>& triangles = mesh.topology.triangles;
  std::vector<Triangle>& uvs = mesh.topology.triangle_uvs;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Triangle& corners = triangles[t];
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    triangles[kept] = corners;
    if (!uvs.empty()) uvs[kept] = uvs[t];
    ++kept;
  }
  mesh.dropped_triangles = triangles.size() - kept;
  triangles.resize(kept);
  if (!uvs.empty()) uvs.resize(kept);
  if (uvs.empty()) mesh.topology.uvs.clear();
}

std::vector<Color> colors_from_channels(std::span<const float> channels) {
  const bool in_bytes = std::any_of(channels.begin(), channels.end(), [](float c) { return c > 1.0f; });
  const float scale = in_bytes ? 1.0f : 255.0f;
  std::vector<Color> colors(channels.size() / 3);
  for (std::size_t i = 0; i < 3 * colors.size(); ++i) {
    const float level = scale * channels[i];
    colors[i / 3][i % 3] =
        level > 0.0f ? static_cast<std::uint8_t>(std::lround(std::min(level, 255.0f))) : std::uint8_t{0};
  }
  return colors;
}

std::string line_at(std::string_view bytes, std::size_t offset) {
  const std::string_view before = bytes.substr(0, std::min(offset, bytes.size()));
  return std::to_string(1 + std::count(before.begin(), before.end(), '\n'));
}

}  // namespace reprise
