// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Key-frame paths as the paper finds them (HSSMG 5.1.1, 5.1.2): a peer to measure against. Whoever links this
// links GLPK (GPL), so nothing that is shipped may.

#pragma once

#include <cstddef>
#include <vector>

#include "reprise/path/keyframe_optimizer.h"

namespace reprise::benchmark {

// Which loops a walk may repeat.
enum class LoopAttachment {
  to_walk,   // those that meet the walk itself: Eq. 14 as printed
  to_loops,  // also those that hang on loops in use; rows against loose ones are added as they turn up
};

struct DecompositionLimits {
  std::size_t walks = 1000;
  std::size_t loops = 400;
  int seconds = 5;  // for one integer program
};

struct DecompositionResult {
  double cost = unlimited;   // of the best path; a NaN if an integer program was not solved in time
  std::size_t walks = 0;     // without loops, from key-frame to key-frame
  std::size_t loops = 0;     // of the whole graph
  std::size_t programs = 0;  // integer programs solved
  bool is_complete = false;  // false: more walks or loops than the limits
};

// Depth-first search lists all walks without loops from the first key-frame to the second and all loops; for
// each walk, four integer programs (rho = 0..3, Eq. 23 to 25), one for each pair of signs of dist - d_V and
// time - t_V, find how often each loop is repeated. Two things are mended: Eq. 24 takes d_V and t_V off every
// loop's distance and time, but they belong in the sum once; and loops may hang on loops, if asked for.
// A node is a frame of a clip at which a transition leaves, or a key-frame. Preconditions: two different
// key-frames, no limits.
DecompositionResult solve_by_decomposition(const PathMetrics& metrics, const KeyframeQuery& query,
                                           const KeyframeOptions& options, LoopAttachment attachment,
                                           const DecompositionLimits& limits = {});

}  // namespace reprise::benchmark
