// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What all frames of one performer share: triangles, texture coordinates, colours of the material.

#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "reprise/mesh/image.h"

namespace reprise {

using Triangle = std::array<std::int32_t, 3>;  // vertex indices, counter-clockwise seen from outside
using Color = std::array<std::uint8_t, 3>;     // sRGB

// Immutable once shared: every mesh and sequence of a performer points at the same object.
struct Topology {
  std::int32_t vertex_count = 0;
  std::vector<Triangle> triangles;

  // Texture coordinates, bottom-left origin (OBJ convention). Either both empty, or `triangle_uvs` has one
  // entry per triangle whose corners index `uvs`.
  std::vector<std::array<float, 2>> uvs;
  std::vector<Triangle> triangle_uvs;

  // Appearance on the texture coordinates, or null. Needs texture coordinates.
  std::shared_ptr<const Image> texture;

  bool has_uvs() const { return !uvs.empty(); }
};

using TopologyPtr = std::shared_ptr<const Topology>;

// Throws `InvalidArgument` naming the first triangle with an index out of range or two equal corners, or
// arrays whose sizes do not fit together.
void validate(const Topology& topology);

// Empty if both describe the same surface (vertex count and triangles); otherwise the first difference in
// words, such as "triangle 17 is (3, 4, 5) in a and (3, 5, 4) in b". `name_a`, `name_b`: how to call the two
// in the text.
std::string first_difference(const Topology& a, const Topology& b, const std::string& name_a,
                             const std::string& name_b);

// Splits polygons into triangles as a fan from each polygon's first corner.
// `corners`: concatenated polygon corners; `sizes`: corners per polygon, at least 3 each, with a sum of all
// corners. Throws `InvalidArgument` otherwise.
std::vector<Triangle> triangulate(const std::vector<std::int32_t>& corners,
                                  const std::vector<std::int32_t>& sizes);

// Number of connected components and the component of every vertex, in order of first vertex. An unreferenced
// vertex is a component of its own.
struct ConnectedComponents {
  std::int32_t count = 0;
  std::vector<std::int32_t> of_vertex;
};
ConnectedComponents connected_components(const Topology& topology);

}  // namespace reprise
