// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/body/long_skirt.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise::body {
namespace {

constexpr std::size_t columns_a_gore = 6;
constexpr double gutter = 0.06;  // of a gore's strip, on either side
constexpr int texture_width = 512, texture_height = 256;

using Edge = std::pair<std::int32_t, std::int32_t>;

Edge edge_of(std::int32_t a, std::int32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

}  // namespace

FittedLayer make_long_skirt(const MakehumanBody& body, const Points& points,
                            const std::vector<BoneWeights>& weights) {
  std::vector<std::size_t> quads;
  std::map<Edge, std::vector<std::size_t>> quads_of_edge;
  for (std::size_t f = 0; f < body.mesh.faces.size(); ++f) {
    const MakehumanMesh::Face& face = body.mesh.faces[f];
    if (face.material != MakehumanBody::skirt_material || face.corner_count != 4) continue;
    quads.push_back(f);
    for (std::size_t k = 0; k < 4; ++k) {
      quads_of_edge[edge_of(face.corners[k], face.corners[(k + 1) % 4])].push_back(f);
    }
  }
  const auto fail = [&](const std::string& found) {
    throw FileError(body.mesh.path, "faces of the helper skirt",
                    fmt::format("expected a tube of quads, found {}", found));
  };

  // The quads of the waist, in order around the body, each with its upper edge.
  const auto height = [&](std::int32_t v) { return points(v, 1); };
  double low = 1e9, high = -1e9;
  for (const std::size_t f : quads) {
    for (const std::int32_t v : body.mesh.faces[f].corners) {
      low = std::min(low, height(v));
      high = std::max(high, height(v));
    }
  }
  struct Top {
    double angle = 0.0;
    std::size_t quad = 0, edge = 0;
  };
  std::vector<Top> waist;
  for (const std::size_t f : quads) {
    const auto& corners = body.mesh.faces[f].corners;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::int32_t a = corners[k], b = corners[(k + 1) % 4];
      if (quads_of_edge[edge_of(a, b)].size() != 1 || height(a) < 0.5 * (low + high)) continue;
      waist.push_back({std::atan2(points(a, 0) + points(b, 0), points(a, 2) + points(b, 2)), f, k});
    }
  }
  if (waist.empty() || quads.size() % waist.size() != 0 || waist.size() % columns_a_gore != 0) {
    fail(fmt::format("{} quads, {} of them at the waist", quads.size(), waist.size()));
  }
  std::sort(waist.begin(), waist.end(), [](const Top& a, const Top& b) {
    return a.angle != b.angle ? a.angle < b.angle : a.quad < b.quad;
  });

  // Down from quad to quad.
  MakehumanMesh mesh = body.mesh;
  const std::size_t rows = quads.size() / waist.size(), gores = waist.size() / columns_a_gore;
  std::vector<bool> used(mesh.faces.size(), false);
  const auto uv_idx = [&](std::size_t gore, std::size_t column, std::size_t row) {
    return static_cast<std::int32_t>((gore * (columns_a_gore + 1) + column) * (rows + 1) + row);
  };
  mesh.uvs.clear();
  for (std::size_t gore = 0; gore < gores; ++gore) {
    for (std::size_t column = 0; column <= columns_a_gore; ++column) {
      for (std::size_t row = 0; row <= rows; ++row) {
        const double across = gutter + (1.0 - 2.0 * gutter) * static_cast<double>(column) / columns_a_gore;
        const double down = 0.01 + 0.98 * static_cast<double>(row) / static_cast<double>(rows);
        mesh.uvs.push_back(
            {static_cast<float>((static_cast<double>(gore) + across) / static_cast<double>(gores)),
             static_cast<float>(1.0 - down)});
      }
    }
  }
  for (std::size_t c = 0; c < waist.size(); ++c) {
    std::size_t quad = waist[c].quad, edge = waist[c].edge;
    const std::size_t gore = c / columns_a_gore, column = c % columns_a_gore;
    for (std::size_t row = 0; row < rows; ++row) {
      MakehumanMesh::Face& face = mesh.faces[quad];
      if (used[quad]) fail("a column that runs into another");
      used[quad] = true;
      // Seen from outside the corners go round counter-clockwise: the upper edge from left to right's
      // opposite.
      face.uvs[edge] = uv_idx(gore, column + 1, row);
      face.uvs[(edge + 1) % 4] = uv_idx(gore, column, row);
      face.uvs[(edge + 2) % 4] = uv_idx(gore, column, row + 1);
      face.uvs[(edge + 3) % 4] = uv_idx(gore, column + 1, row + 1);
      if (row + 1 == rows) break;
      const Edge next = edge_of(face.corners[(edge + 2) % 4], face.corners[(edge + 3) % 4]);
      const auto& both = quads_of_edge[next];
      if (both.size() != 2) fail("a hem of uneven length");
      quad = both[0] == quad ? both[1] : both[0];
      const auto& corners = mesh.faces[quad].corners;
      for (edge = 0; edge < 4 && edge_of(corners[edge], corners[(edge + 1) % 4]) != next;) ++edge;
    }
  }

  FittedLayer skirt = make_layer(mesh, points, weights, used);
  skirt.layer.name = CostumeGarment::long_skirt;
  skirt.layer.kind = BodyLayer::Kind::garment;
  constexpr std::uint8_t grey = 200;
  skirt.layer.texture = {texture_width, texture_height,
                         std::vector<std::uint8_t>(std::size_t{3} * texture_width * texture_height, grey)};
  return skirt;
}

}  // namespace reprise::body
