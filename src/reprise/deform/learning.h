// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Learning the deformation spaces of a performer's parts from captured frames (LPBM IV.A, HSSMG 5.2.3).

#pragma once

#include <span>
#include <vector>

#include "reprise/database/learnt_model.h"
#include "reprise/database/performance_database.h"

namespace reprise {

struct LearningOptions {
  double kept_variance = 0.99;  // the papers keep 0.95; see docs/learning.md
  int most_components = 0;      // of a part; 0: no limit
};

// `parts`: a tree, root first (`body_parts`, `whole_body_part`, a markup's own). `examples`: the frames each
// part learns from, one list a part, none empty. `reference`: N x 3. Parallel over parts and frames, the same
// bits for any number of threads. Throws `InvalidArgument` naming the part or frame.
LearntModel learn_model(const PerformanceDatabase& database, const Positions& reference,
                        const std::vector<BodyPart>& parts, std::span<const std::vector<FrameId>> examples,
                        const LearningOptions& options = {});

}  // namespace reprise
