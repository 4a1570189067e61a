// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What the project promises of every animation it makes from key-frames.

#pragma once

#include <gtest/gtest.h>

#include "reprise/pipeline/graph.h"
#include "reprise/pipeline/keyframes.h"
#include "reprise/pipeline/similarity.h"
#include "reprise/synthesis/naturalness.h"

namespace reprise::test {

inline SurfaceMotionGraph graph_of(const PerformanceDatabase& database) {
  return make_graph(database, compute_similarity(database, "unused", {.use_cache = false}), {}, std::nullopt);
}

// It plays what the path predicts, its joins do not pop, and its triangles are stretched no further than the
// capture's own. Returns its figures.
inline Naturalness expect_kept_promises(const KeyframesResult& result, const PerformanceDatabase& database,
                                        double stretch_bound = 1.1) {
  EXPECT_EQ(result.path.gap(), 0.0);
  EXPECT_EQ(result.animation.frame_count(), static_cast<std::size_t>(result.path.frame_count));
  EXPECT_NEAR(ground_distance(ground_trajectory(result.animation), 0, result.animation.frame_count() - 1),
              result.path.distance, 0.01);
  const Naturalness natural = evaluate_naturalness(result.animation, database);
  EXPECT_GT(natural.pop_ratio, 0.0) << "the test needs a blend";
  EXPECT_LT(natural.pop_ratio, 2.0);
  EXPECT_LT(natural.edge_stretch_p99, stretch_bound * natural.captured_edge_stretch_p99);
  return natural;
}

}  // namespace reprise::test
