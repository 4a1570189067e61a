// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The two halves of making an atlas that know nothing of surfaces as a whole: one chart flattened, and flat
// charts packed.

#pragma once

#include <optional>
#include <vector>

#include "reprise/mesh/closest_point.h"

namespace reprise {

struct FlatChart {
  std::vector<Eigen::Vector2d> points;
  std::vector<Triangle> triangles;  // of `points`
};

// The given triangles of the mesh laid flat, counter-clockwise, without overlap, at about true size. Nothing
// if they are not one disc, one of them faces away from `direction`, or they overlap when flat.
std::optional<FlatChart> flatten(const TriangleMesh& mesh, const std::vector<std::int32_t>& triangles,
                                 const Eigen::Vector3d& direction);

// Turns and moves the charts and scales them all alike so that their boxes fill the unit square as far as
// possible with `gutter` of `size` pixels between them and half of it to the rim.
void pack(std::vector<FlatChart>& charts, int size, int gutter);

}  // namespace reprise
