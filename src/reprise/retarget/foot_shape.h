// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Where a foot at rest touches the ground.

#pragma once

#include <Eigen/Core>

#include "reprise/sequence/skeleton.h"

namespace reprise::retargeting {

// Points of a foot at rest, in the skeleton's coordinates.
struct FootShape {
  Eigen::Vector3d ankle;
  Eigen::Vector3d ball;     // joint of the toes
  Eigen::Vector3d heel;     // rear edge of the sole, on the ground
  Eigen::Vector3d toe_tip;  // of the sole
};

// Of a skeleton that stands at rest on flat feet at y = 0 and looks along +Z. `side`: 0 is left.
FootShape foot_shape(const Skeleton& skeleton, int side);

}  // namespace reprise::retargeting
