// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Skeleton pose metric: root-mean-square distance of joints after the best alignment on the ground.

#pragma once

#include <vector>

#include "reprise/database/performance_database.h"
#include "reprise/sequence/skeleton.h"
#include "reprise/similarity/dissimilarity_matrix.h"

namespace reprise {

// All pairs of frames, exact to float32 rounding. `motions`: the poses of each clip in order, on one skeleton
// (`extract_skeleton`). Joints count equally. Throws `InvalidArgument` if the motions do not fit the clips.
DissimilarityMatrix skeleton_dissimilarity(const PerformanceDatabase& database,
                                           const std::vector<SkeletalMotion>& motions);

}  // namespace reprise
