// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// How far each vertex goes along when a foot is moved.

#pragma once

#include "reprise/synthesis/ground_contacts.h"

namespace reprise {

inline constexpr double hip_share = 0.5;  // of the performer's stature

// N x feet, in [0, 1], rows sum to at most 1: 1 on the foot, exactly 0 on the other feet and on everything
// that is on average higher than `hip_share`, smooth between. The harmonic function with these values
// (cotangent Laplacian of the database's first frame, edge weights held positive so that it has no extremum
// in between) goes through a smoothstep, which takes the corners off both ends. A surface in several pieces
// is joined where a piece comes close to another one, so that a shoe and the leg in it go together.
Eigen::MatrixXd leg_weights(const PerformanceDatabase& database, const GroundContacts& contacts);

}  // namespace reprise
