// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Transitions asked for by hand.

#pragma once

#include <cstddef>

#include "reprise/graph/transition.h"

namespace reprise {

// Which frames meet, and over how many the clips are blended.
struct TransitionRequest {
  std::size_t source_clip = 0;
  std::size_t target_clip = 0;
  int m = 0;
  int n = 0;
  int half_window = 0;  // 0: the window of least cost
  bool operator==(const TransitionRequest&) const = default;
};

// Throws `InvalidArgument` for a clip or frame that does not exist, a frame that is to lead to itself, and a
// window, or else the shortest of the options, that does not fit into both clips (says the longest that
// does).
void check_request(const TransitionRequest& request, const PerformanceDatabase& database,
                   const TransitionOptions& options = {});

// What the search would say of this place and window: alignment, distortion, peak acceleration and cost to
// the last bit, whether or not it is a local minimum. A window that is given may be of any length that fits
// into both clips and may pop; otherwise it is the best of those the options allow or, if all of those pop,
// the best of them. Throws `InvalidArgument` for what `find_transitions` and `check_request` refuse.
Transition measure_transition(const PerformanceDatabase& database, const DissimilarityMatrix& matrix,
                              const TransitionRequest& request, const TransitionOptions& options = {});

// The same, with the entries it depends on made exact and kept in `matrix`.
Transition measure_transition(const PerformanceDatabase& database, DissimilarityMatrix& matrix,
                              const ExactEntry& exact_entry, const TransitionRequest& request,
                              const TransitionOptions& options = {});

}  // namespace reprise
