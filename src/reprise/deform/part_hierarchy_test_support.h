// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Tubes in parts, and the laws of every hierarchy of parts.

#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "reprise/deform/part_hierarchy.h"
#include "reprise/mesh/geodesic.h"
#include "support/shapes.h"

namespace reprise::part_test {

inline constexpr int around = 12;

// An open tube along +Y, its rings a centimetre apart.
inline test::Shape tube(int rings) {
  const auto topology = std::make_shared<Topology>();
  topology->vertex_count = around * rings;
  Positions positions(around * rings, 3);
  for (int ring = 0; ring < rings; ++ring) {
    for (int k = 0; k < around; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / around;
      const int v = ring * around + k;
      positions.row(v) << static_cast<float>(0.05 * std::cos(angle)), static_cast<float>(0.01 * ring),
          static_cast<float>(0.05 * std::sin(angle));
      if (ring + 1 == rings) continue;
      const int next = ring * around + (k + 1) % around;
      topology->triangles.push_back({v, v + around, next});
      topology->triangles.push_back({next, v + around, next + around});
    }
  }
  return {.topology = topology, .positions = positions};
}

// The vertices of rings `first` to `last`.
inline BodyPart rings(const std::string& name, int parent, int first, int last) {
  BodyPart part{.name = name, .parent = parent, .vertices = {}};
  for (int v = first * around; v < (last + 1) * around; ++v) part.vertices.push_back(v);
  return part;
}

inline PositionsView view(const Positions& positions) {
  return {positions.data(), positions.rows(), 3};
}

inline PartHierarchy hierarchy(const test::Shape& shape, const std::vector<BodyPart>& parts,
                               const PartHierarchyOptions& options = {}) {
  return {shape.topology, view(shape.positions), parts, options};
}

inline double weight(const PartHierarchy& parts, std::int32_t vertex, int part_idx) {
  for (const PartHierarchy::Share& share : parts.shares(vertex)) {
    if (share.part_idx == part_idx) return share.weight;
  }
  return 0.0;
}

// The positions of every part, as rows of the whole.
inline std::vector<Coordinates> split(const PartHierarchy& parts, const Coordinates& whole) {
  std::vector<Coordinates> positions;
  for (const PartHierarchy::Part& part : parts.parts())
    positions.emplace_back(whole(part.vertices, Eigen::all));
  return positions;
}

// What holds for every hierarchy.
inline void expect_laws(const test::Shape& shape, const PartHierarchy& parts) {
  const auto part_count = static_cast<int>(parts.parts().size());
  for (std::int32_t v = 0; v < parts.vertex_count(); ++v) {
    double sum = 0.0;
    int before = -1;
    for (const PartHierarchy::Share& share : parts.shares(v)) {
      EXPECT_GT(share.part_idx, before);
      before = share.part_idx;
      EXPECT_GT(share.weight, 0.0);
      EXPECT_EQ(parts.part(share.part_idx).vertices.at(static_cast<std::size_t>(share.local)), v);
      sum += share.weight;
    }
    EXPECT_NEAR(sum, 1.0, 1e-15 * part_count) << v;
  }
  // Parts are their triangles, in the indices of the whole.
  std::set<Triangle> covered;
  for (const PartHierarchy::Part& part : parts.parts()) {
    EXPECT_TRUE(std::ranges::is_sorted(part.vertices));
    EXPECT_EQ(part.topology->vertex_count, static_cast<int>(part.vertices.size()));
    EXPECT_NO_THROW(validate(*part.topology));
    for (Triangle triangle : part.topology->triangles) {
      for (std::int32_t& v : triangle) v = part.vertices.at(static_cast<std::size_t>(v));
      covered.insert(triangle);
    }
    for (const PartHierarchy::FrontierVertex& shared : part.frontier) {
      EXPECT_EQ(part.vertices.at(static_cast<std::size_t>(shared.local)), shared.vertex);
      EXPECT_EQ(parts.part(part.parent).vertices.at(static_cast<std::size_t>(shared.parent_local)),
                shared.vertex);
      EXPECT_GE(shared.parent_share, 0.0);
      EXPECT_LE(shared.parent_share, 1.0);
    }
  }
  EXPECT_EQ(covered, std::set<Triangle>(shape.topology->triangles.begin(), shape.topology->triangles.end()));
  // Equal parts make the whole, to the last bit.
  const Coordinates whole = Coordinates::Random(parts.vertex_count(), 3) * 1e3;
  Coordinates out;
  parts.recombine(split(parts, whole), out);
  EXPECT_EQ(out, whole);
}

// The largest change of a weight across an edge, over the edge's length.
inline double steepest(const test::Shape& shape, const PartHierarchy& parts) {
  const EdgeGraph graph(*shape.topology, view(shape.positions));
  double steepest = 0.0;
  for (std::int32_t v = 0; v < parts.vertex_count(); ++v) {
    for (const EdgeGraph::Neighbour& next : graph.neighbours(v)) {
      for (int p = 0; p < static_cast<int>(parts.parts().size()); ++p) {
        const double change = std::abs(weight(parts, v, p) - weight(parts, next.vertex, p));
        steepest = std::max(steepest, change / double{next.length});
      }
    }
  }
  return steepest;
}

}  // namespace reprise::part_test
