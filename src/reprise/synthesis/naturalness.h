// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// How natural a generated motion is, beside the captured clips it was made of: pops, sliding feet, stretched
// triangles.

#pragma once

#include "reprise/synthesis/edge_stretch.h"
#include "reprise/synthesis/ground_contacts.h"

namespace reprise {

struct Naturalness {
  // Largest vertex acceleration inside the blends (m/frame^2, second difference, blend ends included), and
  // the 99th percentile over the captured frames of each frame's largest; their ratio is the pop ratio (1 or
  // less: no worse than the capture). Zero if nothing is blended.
  double pop_ratio = 0.0;
  double captured_pop_ratio = 0.0;  // the captured clips' own: their largest over their 99th percentile
  double peak_acceleration = 0.0;
  double captured_acceleration_p99 = 0.0;
  // Mean horizontal speed, cm/s, of the vertices that are in contact with the ground in the captured clip the
  // frame comes from (the heavier one inside a blend).
  double foot_drift = 0.0;
  double captured_foot_drift = 0.0;  // over all frames of the database
  double shown_foot_drift = 0.0;     // the captured clips' own in the very frames that are shown
  double blend_foot_drift = 0.0;     // the same inside blends alone
  // 99th percentile of edge length over reference edge length (first frame of the database).
  double edge_stretch_p99 = 0.0;
  double captured_edge_stretch_p99 = 0.0;
};

// What the captured clips themselves are, over all of their frames.
struct CapturedNaturalness {
  double acceleration_p99 = 0.0;  // m/frame^2
  double pop_ratio = 0.0;         // their largest acceleration over that; 0 if nothing moves
  double foot_drift = 0.0;        // cm/s
  double edge_stretch_p99 = 0.0;
};
// `edges`: of the first frame of the database.
CapturedNaturalness captured_naturalness(const PerformanceDatabase& database, const GroundContacts& contacts,
                                         const std::shared_ptr<const ReferenceEdges>& edges);

// `result`: generated from `database`, with origins. Throws `InvalidArgument` if it has no origins, if its
// topology is another, or if its origins name clips or frames the database does not have.
Naturalness evaluate_naturalness(const MeshSequence& result, const PerformanceDatabase& database,
                                 const ContactOptions& options = {});

}  // namespace reprise
