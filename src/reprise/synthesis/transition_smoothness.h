// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The smoothness column of HSSMG Table III: Hausdorff distances of the frames that overlap at a transition.

#pragma once

#include "reprise/graph/transition.h"

namespace reprise {

// H(k): symmetric Hausdorff distance, vertices to surface, between source frame m + k and target frame n + k
// brought onto the source, k in [-L, L]. Its weights are those of Eq. 2, alpha'(k) = min(1 - alpha, alpha)
// with the linear alpha(k) = (k + L) / 2L, whatever the profile of the blend: the table is the paper's.
struct TransitionSmoothness {
  // Mean over the 2L + 1 frames of alpha'(k) H(k), metres.
  double weighted = 0.0;
  // Sum of alpha'(k) H(k) over the sum of alpha'(k), which is L / 2: a weighted mean in the strict sense,
  // metres; more than four times as large.
  double normalized = 0.0;
};

// Throws `InvalidArgument` if the transition names clips that do not exist, if its window leaves its clips or
// if the topology has no triangles.
TransitionSmoothness transition_smoothness(const PerformanceDatabase& database, const Transition& transition);

// max of both directions: the greatest distance of a vertex of one frame from the surface of the other,
// metres. Vertices that no triangle uses are no part of the surface. `target` is brought onto the source by
// `source_from_target`. Throws `InvalidArgument` if vertex counts differ or there are no triangles.
double hausdorff_distance(const PositionsView& source, const PositionsView& target,
                          const GroundTransform& source_from_target, const Topology& topology);

}  // namespace reprise
