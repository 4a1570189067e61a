// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// One frame: positions on a shared topology.

#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "reprise/mesh/topology.h"

namespace reprise {

// N x 3, row-major: one vertex a row, metres.
using Positions = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
using PositionsView = Eigen::Map<const Positions>;
using PositionsRef = Eigen::Map<Positions>;

struct Mesh {
  TopologyPtr topology;
  Positions positions;        // vertex_count x 3
  Positions normals;          // empty, or vertex_count x 3 unit vectors as given by the source file
  std::vector<Color> colors;  // empty, or one per vertex
};

// The functions below throw `InvalidArgument` unless `positions` has one row per vertex of `topology`.

// Area-weighted unit vertex normals; (0, 0, 0) where no triangle of positive area meets the vertex. Shape N
// x 3.
Positions vertex_normals(const Topology& topology, const PositionsView& positions);

// Sum of triangle areas, m^2.
double surface_area(const Topology& topology, const PositionsView& positions);

// Mean length of the triangles' edges, metres, an edge counted once a triangle; 0 without triangles.
double mean_edge_length(const Topology& topology, const PositionsView& positions);

// Empty if the frame is usable; otherwise why not: NaN or infinite coordinates (names the first vertex), or
// no triangle of positive area.
std::string degeneracy(const Topology& topology, const PositionsView& positions);

}  // namespace reprise
