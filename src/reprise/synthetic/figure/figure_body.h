// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The figure at rest: its surface, colours, and how its vertices hang on the skeleton.

#pragma once

#include <array>
#include <vector>

#include "reprise/mesh/topology.h"
#include "reprise/synthetic/figure/figure_skeleton.h"

namespace reprise::figure {

constexpr int weights_per_vertex = 6;

struct VertexBinding {
  std::array<int, weights_per_vertex> joints{};
  std::array<double, weights_per_vertex> weights{};  // sum 1, largest first; unused ones are 0
};

struct Body {
  TopologyPtr topology;
  std::vector<Eigen::Vector3d> points;  // metres, rest pose, of height `design_height`
  std::vector<Color> colors;
  std::vector<VertexBinding> bindings;
  std::vector<double> hem;        // 0 where cloth is tight, 1 at the hem of the tunic
  std::vector<double> hem_angle;  // about the vertical axis, radians, 0 = +Z, towards +X
};

// `voxel_size`: metres at `design_height`. Deterministic. Throws `InvalidArgument` for too coarse voxels.
Body make_body(double voxel_size);

}  // namespace reprise::figure
