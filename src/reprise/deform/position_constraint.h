// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Soft constraints on places of vertices (LPBM Eq. 4, HSSMG Eq. 32): what an artist's handles and anchors or
// a motion-capture stage ask of a deformed surface.

#pragma once

#include <cstdint>
#include <span>

#include <Eigen/Core>

namespace reprise {

// One row of W_c (x - x_c): `weight` multiplies the distance of the vertex from its target, so it counts
// squared in the sum that is minimised.
struct PositionConstraint {
  std::int32_t vertex = 0;
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  // metres
  double weight = 1.0;                               // positive
};

// Throws `InvalidArgument` naming the constraint: a vertex out of range or constrained twice, a target that
// is not finite, a weight that is not positive and finite. No constraint at all is valid.
void validate(std::span<const PositionConstraint> constraints, std::int32_t vertex_count);

}  // namespace reprise
