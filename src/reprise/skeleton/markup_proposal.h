// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Markup from a few named landmarks, by geodesic growth over the surface.

#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "reprise/database/markup.h"
#include "reprise/mesh/mesh.h"

namespace reprise {

// Landmark name -> vertex.
using Landmarks = std::map<std::string, std::int32_t>;

// The landmarks, all of them needed: head_top, neck (anywhere around the base of the neck) and for each side
// (left_, right_) shoulder (its top), elbow, wrist, hand (tip of the longest finger), hip (its outer side,
// at the height of the joint), knee, ankle and toe (tip).
const std::vector<std::string>& landmark_names();

// Proposes joints, labels and parts on a surface that is closed and has no handles, with the trunk upright or
// bent little and the limbs away from the trunk. Each landmark of a joint is cut by the shortest loop over
// the surface that passes through it and separates the limb's tip from the rest: the centroid of the loop is
// the joint (shoulders and hips, whose loops run obliquely, lie above it), what lies between two loops is a
// bone. Spine, chest, head and toes stand at fixed shares between those joints. Parts are the limbs and head,
// grown over their borders (`body_parts`). Joints: pelvis, spine, chest, neck, head and for each side collar
// (without vertices of its own), upper_arm, forearm, hand, thigh, shin, foot, toe. Throws `InvalidArgument`
// for an unknown or missing landmark (lists what is expected), a vertex out of range or used twice, or a ring
// that separates nothing.
Markup propose_markup(const Mesh& mesh, const Landmarks& landmarks);

}  // namespace reprise
