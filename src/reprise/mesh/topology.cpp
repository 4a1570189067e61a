// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/topology.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {

void validate(const Topology& topology) {
  if (topology.vertex_count <= 0) throw InvalidArgument("a topology needs at least one vertex");
  for (std::size_t t = 0; t < topology.triangles.size(); ++t) {
    const Triangle& triangle = topology.triangles[t];
    for (const std::int32_t v : triangle) {
      if (v < 0 || v >= topology.vertex_count) {
        throw InvalidArgument(fmt::format("triangle {} refers to vertex {}, but there are {} vertices", t, v,
                                          topology.vertex_count));
      }
    }
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) {
      throw InvalidArgument(fmt::format("triangle {} uses a vertex twice: ({}, {}, {})", t, triangle[0],
                                        triangle[1], triangle[2]));
    }
  }
  if (!topology.triangle_uvs.empty() && topology.triangle_uvs.size() != topology.triangles.size()) {
    throw InvalidArgument(fmt::format("texture coordinates are given for {} of {} triangles",
                                      topology.triangle_uvs.size(), topology.triangles.size()));
  }
  if (topology.uvs.empty() != topology.triangle_uvs.empty()) {
    throw InvalidArgument(fmt::format("{} texture coordinates, but {} triangles refer to them",
                                      topology.uvs.size(), topology.triangle_uvs.size()));
  }
  for (std::size_t t = 0; t < topology.triangle_uvs.size(); ++t) {
    for (const std::int32_t uv : topology.triangle_uvs[t]) {
      if (uv < 0 || static_cast<std::size_t>(uv) >= topology.uvs.size()) {
        throw InvalidArgument(fmt::format("triangle {} refers to texture coordinate {}, but there are {}", t,
                                          uv, topology.uvs.size()));
      }
    }
  }
  if (topology.texture) {
    if (!topology.has_uvs()) throw InvalidArgument("a texture needs texture coordinates, but there are none");
    validate(*topology.texture);
  }
}

std::string first_difference(const Topology& a, const Topology& b, const std::string& name_a,
                             const std::string& name_b) {
  if (a.vertex_count != b.vertex_count) {
    return fmt::format("{} has {} vertices, {} has {}", name_a, a.vertex_count, name_b, b.vertex_count);
  }
  const std::size_t common = std::min(a.triangles.size(), b.triangles.size());
  for (std::size_t t = 0; t < common; ++t) {
    const Triangle& p = a.triangles[t];
    const Triangle& q = b.triangles[t];
    if (p != q) {
      return fmt::format("triangle {} is ({}, {}, {}) in {} and ({}, {}, {}) in {}", t, p[0], p[1], p[2],
                         name_a, q[0], q[1], q[2], name_b);
    }
  }
  if (a.triangles.size() != b.triangles.size()) {
    return fmt::format("{} has {} triangles, {} has {}", name_a, a.triangles.size(), name_b,
                       b.triangles.size());
  }
  return {};
}

std::vector<Triangle> triangulate(const std::vector<std::int32_t>& corners,
                                  const std::vector<std::int32_t>& sizes) {
  std::size_t corner_count = 0;
  for (std::size_t p = 0; p < sizes.size(); ++p) {
    if (sizes[p] < 3) {
      throw InvalidArgument(fmt::format("polygon {} has {} corners; expected at least 3", p, sizes[p]));
    }
    corner_count += static_cast<std::size_t>(sizes[p]);
  }
  if (corner_count != corners.size()) {
    throw InvalidArgument(
        fmt::format("{} polygon corners are given, but the polygons have {}", corners.size(), corner_count));
  }
  std::vector<Triangle> triangles;
  triangles.reserve(corner_count - 2 * sizes.size());
  std::size_t first = 0;
  for (const std::int32_t size : sizes) {
    for (std::int32_t k = 1; k + 1 < size; ++k) {
      const auto at = [&](std::int32_t offset) { return corners[first + static_cast<std::size_t>(offset)]; };
      triangles.push_back({at(0), at(k), at(k + 1)});
    }
    first += static_cast<std::size_t>(size);
  }
  return triangles;
}

ConnectedComponents connected_components(const Topology& topology) {
  std::vector<std::int32_t> parent(static_cast<std::size_t>(topology.vertex_count));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t v) {
    while (parent[static_cast<std::size_t>(v)] != v) {
      auto& up = parent[static_cast<std::size_t>(v)];
      up = parent[static_cast<std::size_t>(up)];  // path halving
      v = up;
    }
    return v;
  };
  for (const Triangle& triangle : topology.triangles) {
    for (const int corner : {1, 2}) {
      const std::int32_t a = root(triangle[0]);
      const std::int32_t b = root(triangle[static_cast<std::size_t>(corner)]);
      parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  }
  ConnectedComponents components;
  components.of_vertex.resize(parent.size());
  for (std::int32_t v = 0; v < topology.vertex_count; ++v) {
    const std::int32_t r = root(v);
    // The root is the smallest vertex of its component, so it has been numbered before any other.
    components.of_vertex[static_cast<std::size_t>(v)] =
        r == v ? components.count++ : components.of_vertex[static_cast<std::size_t>(r)];
  }
  return components;
}

}  // namespace reprise
