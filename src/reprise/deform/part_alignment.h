// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A part of a frame, and the rigid motion that brings it onto the part of the reference.

#pragma once

#include "reprise/deform/surface_laplacian.h"

namespace reprise {

struct Alignment {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  // reference from frame
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();      // of the frame's part
  Eigen::Vector3d reference_centroid = Eigen::Vector3d::Zero();

  Coordinates apply(const Coordinates& positions) const;
};

// The rigid motion with the least sum of squared distances between corresponding rows (Kabsch 1976).
Alignment align(const Coordinates& positions, const Coordinates& reference);

// Rows of the given vertices.
Coordinates rows_of(const PositionsView& positions, const std::vector<std::int32_t>& vertices);

// The operator of a part; `reference`: the part's own rows.
SurfaceLaplacian part_laplacian(const PartHierarchy::Part& part, const Coordinates& reference);

}  // namespace reprise
