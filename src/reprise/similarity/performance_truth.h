// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// How much frames of a synthetic performance truly differ: what metrics are measured against.

#pragma once

#include <cstddef>

#include "reprise/database/performance_database.h"
#include "reprise/similarity/dissimilarity_matrix.h"

namespace reprise {

// Metres, all pairs exact.
struct PerformanceTruth {
  // sqrt((s^2 + j^2) / 2): s is the root-mean-square distance of corresponding points of the surface after
  // the best alignment on the ground, j that of the joints after theirs.
  DissimilarityMatrix pose_and_shape;
  DissimilarityMatrix pose;  // j alone
  // Root-mean-square distance of corresponding points of cloth and hair that hang free (the markup's vertices
  // without a joint), each as seen from the bone that it follows best: the pose is taken away, the state of
  // the clothes is left.
  DissimilarityMatrix clothing;
  std::size_t free_vertices = 0;  // 0: `clothing` is zero throughout
};

// Every clip carries its true poses.
bool has_truth(const PerformanceDatabase& database);

// `database`: performed without noise and drift, or its surface is not the truth. Parallel; deterministic.
// Throws `InvalidArgument` if a clip has no truth (names it).
PerformanceTruth performance_truth(const PerformanceDatabase& database);

}  // namespace reprise
