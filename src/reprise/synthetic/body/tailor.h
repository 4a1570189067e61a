// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The pieces of cloth that a garment is sewn from, laid flat.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "reprise/synthetic/body/dressed_body.h"

namespace reprise::body {

// A garment's texture coordinates are cut like cloth: each connected piece of them is one piece of cloth,
// which need not be flat or of true size there. Gives for every texture coordinate of the layer its place on
// the cloth in metres: nearly as far apart as on the layer at rest (as rigid as possible, Liu et al. 2008),
// y pointing up on the body and continuous with the height above the ground, x = 0 at the piece's centre.
std::vector<Eigen::Vector2d> cloth_coordinates(const BodyLayer& layer);

}  // namespace reprise::body
