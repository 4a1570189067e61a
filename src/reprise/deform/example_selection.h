// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Automatic choice of the frames a part learns from: extreme poses of the part, which HSSMG 5.2.3 names as
// the alternative to choosing by hand.

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reprise/database/performance_database.h"

namespace reprise {

struct ExampleOptions {
  std::size_t count = 100;  // most examples to choose
  double smallest_radius =
      0.003;                      // metres: enough once every frame is this near to an example; 0: all differ
  std::size_t stride = 1;         // looks at every stride-th frame of a clip, from its first
  std::vector<FrameId> excluded;  // frames that are not looked at: broken ones, or held out for a test
};

struct ExampleSelection {
  std::vector<FrameId> frames;  // in the order chosen: any first few of them are a choice of that size
  // Covering radius after each choice, metres, descending: every frame looked at is within this distance of
  // one of the examples so far. No choice of as many examples has less than half of it.
  std::vector<double> radii;
  std::size_t candidate_count = 0;  // frames looked at
};

// Farthest-point sampling (Gonzalez 1985) in the part's own shape space: the first example is the frame
// nearest to the mean shape, each next one the frame farthest from the examples so far (of equals the first
// in the database). The distance of two frames is the root of the mean squared distance of the part's
// vertices, in metres, each frame moved rigidly onto `reference` with the least squared error. Rigid motions
// of frames change nothing.
//
// `reference`: N x 3, finite; `vertices`: of the part, ascending, not all on a line. Holds 12 bytes a frame
// and vertex of the part. Throws `InvalidArgument` for vertices that are out of range, unsorted or on a line,
// a frame with a vertex of the part that is not finite (names it), an excluded frame that does not exist, no
// frame left, and count or stride 0. The same for any number of threads.
ExampleSelection select_examples(const PerformanceDatabase& database, const Positions& reference,
                                 std::span<const std::int32_t> vertices, const ExampleOptions& options = {});

// Covering radii of somebody's own list, after each of its frames, to be compared with those above. `count`
// and `smallest_radius` do not matter. Throws also for a frame of the list that does not exist.
std::vector<double> covering_radii(const PerformanceDatabase& database, const Positions& reference,
                                   std::span<const std::int32_t> vertices, std::span<const FrameId> examples,
                                   const ExampleOptions& options = {});

}  // namespace reprise
