// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Texture coordinates for a surface: cut into charts, flattened, packed into the unit square.

#pragma once

#include <array>
#include <vector>

#include "reprise/mesh/closest_point.h"

namespace reprise {

struct UvAtlasOptions {
  int texture_size = 2048;          // pixels, for the gutter
  int gutter = 4;                   // pixels between charts, at least
  double max_angle_degrees = 80.0;  // of a triangle to its chart's mean direction
  // Charts keep to one group each. One entry a triangle, or empty: one group.
  std::vector<int> group_of_triangle;
  // Texels along an edge relative to other groups, one positive value a group, or empty: all equal.
  std::vector<double> density;
};

struct UvAtlas {
  std::vector<std::array<float, 2>> uvs;  // bottom-left origin, in [0, 1]
  std::vector<Triangle> triangle_uvs;     // one a triangle
  std::vector<int> chart_of_triangle;
  int chart_count = 0;
};

// Charts are discs grown over triangles that look much the same way, flattened as rigidly as possible (Liu et
// al., A local/global approach to mesh parameterization, SGP 2008). All triangles are counter-clockwise and
// no two overlap. Deterministic. Throws `InvalidArgument` for options out of range or whose sizes do not fit,
// or a triangle without area.
UvAtlas make_uv_atlas(const TriangleMesh& mesh, const UvAtlasOptions& options);

}  // namespace reprise
