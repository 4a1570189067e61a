// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Euclidean vertex metric: root-mean-square vertex distance after the best alignment on the ground.

#pragma once

#include <span>

#include "reprise/math/ground_transform.h"
#include "reprise/similarity/dissimilarity_matrix.h"

namespace reprise {

// Alignment on the ground and what is left after it.
struct GroundAlignment {
  GroundTransform a_from_b;
  double rms_distance = 0.0;  // metres
};

// The yaw and horizontal translation that minimise sum_v |a_v - (R b_v + t)|^2, in closed form: with
// horizontal coordinates about the centroid as complex numbers z + i x, the yaw is the argument of sum_v
// conj(b_v) a_v. Shapes N x 3, equal N > 0; throws `InvalidArgument` otherwise.
GroundAlignment align_on_ground(const PositionsView& a, const PositionsView& b);

// Sets every entry of the matrix to the distance of two frames of corresponding points after alignment on the
// ground, exact to float32 rounding of the result: sums are kept in float64 and taken as matrix products over
// blocks of points and tiles of frames, so memory beside the frames and the matrix is a few megabytes a
// thread. Parallel, with progress; the same bits for any number of threads. Throws `InvalidArgument` unless
// there are as many frames as the matrix has, with equal numbers of at least one point.
void set_aligned_distances(std::span<const PositionsView> frames, DissimilarityMatrix& matrix);

// All pairs of frames by their vertices. The key of the matrix is `database.content_hash()`. Throws
// `InvalidArgument` for a surface without vertices.
DissimilarityMatrix vertex_dissimilarity(const PerformanceDatabase& database);

}  // namespace reprise
