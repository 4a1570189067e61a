// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Overlapping body parts from joint labels (LPBM II).

#pragma once

#include <span>
#include <string>
#include <vector>

#include "reprise/database/markup.h"
#include "reprise/mesh/topology.h"

namespace reprise {

struct BodyPartOptions {
  double overlap = 0.08;       // metres a part reaches over its border along the surface
  double free_overlap = 0.30;  // the same on vertices without a label: skirts, long hair
  // 1: torso, head, arms and legs; 2: each arm as upper arm, forearm and hand, each leg as thigh, shin, foot
  int levels = 1;
};

// A part by the joints it follows: its own and what hangs on them, down to the joints of other parts.
struct JointPart {
  std::string name;
  std::string parent;               // a part before this one; empty: the root
  std::vector<std::string> joints;  // none for the root, which has all joints that no other part has
};

// Any tree of parts. Every labelled vertex belongs to the part of its joint, every other one to that of the
// nearest labelled vertex, and each part then grows over its border. A part that gets no vertex is left out,
// and its children hang on the part above. Throws `InvalidArgument`: no part, a first one with a parent or
// joints, a later one without; a name twice or empty; a parent that is not before its child; a joint that the
// skeleton lacks or that two parts name; labels that do not fit; no vertex with a label; an option out of
// range.
std::vector<BodyPart> parts_of_joints(const Topology& topology, const Positions& reference,
                                      const Skeleton& skeleton,
                                      const std::vector<std::int32_t>& joint_of_vertex,
                                      std::span<const JointPart> parts, const BodyPartOptions& options = {});

// The parts of a human body, as far as the skeleton has their joints:
//   1 level   torso (root), head (joints neck, head), left_arm (left_upper_arm), right_arm, left_leg
//             (left_thigh), right_leg
//   2 levels  torso, head, left_upper_arm > left_forearm > left_hand, ..., left_thigh > left_shin >
//             left_foot, ..., each at the joint of its name
// Throws `InvalidArgument` for another number of levels.
std::vector<JointPart> human_parts(const Skeleton& skeleton, int levels = 1);

// `parts_of_joints` of `human_parts`.
std::vector<BodyPart> body_parts(const Topology& topology, const Positions& reference,
                                 const Skeleton& skeleton, const std::vector<std::int32_t>& joint_of_vertex,
                                 const BodyPartOptions& options = {});

// All of the surface as the one part "body".
BodyPart whole_body_part(std::int32_t vertex_count);

}  // namespace reprise
