// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What the frames of a database look like beside each other: for `evaluate_similarity`.

#pragma once

#include <optional>
#include <vector>

#include "reprise/database/performance_database.h"
#include "reprise/graph/transition.h"
#include "reprise/render/appearance_change.h"
#include "reprise/similarity/dissimilarity_matrix.h"

namespace reprise {

// How clips are to be shown so that they can be told apart: by the colours of their vertices where all have
// them and clips or frames differ, which a texture, the same for all, cannot show; otherwise as ever.
Appearance distinguishing_appearance(const PerformanceDatabase& database);

// Brings every frame to one place, facing one way: onto the first frame of the database.
std::vector<GroundTransform> common_placement(const PerformanceDatabase& database);

// What changes where a transition cuts from frame m of the source to frame n of the target, one each.
std::vector<AppearanceChange> appearance_changes(const PerformanceDatabase& database,
                                                 const std::vector<Transition>& transitions,
                                                 const FrameViewer& viewer);

// From each frame of each clip to the next.
std::vector<AppearanceChange> neighbor_changes(const PerformanceDatabase& database,
                                               const FrameViewer& viewer);

// Which frames look alike: every `step`-th frame is compared with every other in a common placement.
class LookAlikes {
 public:
  // Alike: less than `share` of the picture changes. Parallel, with progress. Memory: some 0.4 MB a frame
  // looked at while it works, then a bit a pair.
  LookAlikes(const PerformanceDatabase& database, const FrameViewer& viewer, double share, std::size_t step);

  // Nothing if one of the frames was not looked at.
  std::optional<bool> operator()(std::size_t a, std::size_t b) const;

 private:
  std::size_t step_;
  std::vector<std::vector<bool>> alike_;  // [a][b - a - 1], in steps
};

// The transitions to be pictured, at most `count`, cheapest first: those of the named pairs (SOURCE:TARGET),
// or the best between every two different clips. Throws `InvalidArgument` for a pair that is none.
std::vector<Transition> pictured_transitions(const PerformanceDatabase& database,
                                             const std::vector<Transition>& transitions,
                                             const std::vector<std::string>& pairs, std::size_t count);

// Both frames of each transition side by side, the target turned onto the source.
void draw_transitions(const PerformanceDatabase& database, const DissimilarityMatrix& matrix,
                      const std::vector<Transition>& transitions, const FrameViewer& viewer,
                      const std::filesystem::path& png);

}  // namespace reprise
