// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Triangle mesh of an implicit surface.

#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "reprise/mesh/topology.h"

namespace reprise::figure {

struct Surface {
  std::vector<Eigen::Vector3d> points;
  std::vector<Triangle> triangles;
};

// Approximate signed distance, negative inside, metres.
using DistanceFunction = std::function<double(const Eigen::Vector3d&)>;

// The zero level of `distance` inside `box`: one closed surface without handles, seen counter-clockwise from
// outside, of nearly square pairs of triangles of edge `voxel_size`. The vertex nearest to each of `pins`
// (which lie near the surface) is moved there. The same call gives the same bytes on any number of threads.
// Throws `InvalidArgument` if the voxels are too coarse to keep the surface in one piece and closed.
Surface surface_from_distance(const DistanceFunction& distance, const Eigen::AlignedBox3d& box,
                              double voxel_size, const std::vector<Eigen::Vector3d>& pins);

}  // namespace reprise::figure
