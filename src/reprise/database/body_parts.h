// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Overlapping body parts from joint labels (LPBM II).

#pragma once

#include <vector>

#include "reprise/database/markup.h"
#include "reprise/mesh/topology.h"

namespace reprise {

struct BodyPartOptions {
  double overlap = 0.08;       // metres a part reaches over its border along the surface
  double free_overlap = 0.30;  // the same on vertices without a label: skirts, long hair
};

// The six parts torso (root), head, left_arm, right_arm, left_leg and right_leg, as far as the skeleton has
// their joints: every labelled vertex belongs to the part of its joint, every other one to that of the
// nearest labelled vertex, and each part then grows over its border. A joint belongs to the part of the
// nearest joint at or above it named neck or head (head), SIDE_upper_arm (arm), SIDE_thigh (leg), else to the
// torso. Throws `InvalidArgument` if no vertex has a label.
std::vector<BodyPart> body_parts(const Topology& topology, const Positions& reference,
                                 const Skeleton& skeleton, const std::vector<std::int32_t>& joint_of_vertex,
                                 const BodyPartOptions& options = {});

}  // namespace reprise
