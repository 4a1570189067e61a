// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Any skeletal motion on the performer's skeleton.

#pragma once

#include <map>
#include <string>

#include "reprise/synthetic/motion/performer_motion.h"

namespace reprise {

struct RetargetOptions {
  double frames_per_second = 25.0;
  // Performer's joint -> joint of the motion. Empty: the built-in map that fits the motion's names best (CMU
  // ASF/AMC, CMU and Daz style BVH, Mixamo).
  std::map<std::string, std::string> joint_map;
  bool plant_feet = true;  // hold feet that stand still in the source, by inverse kinematics
};

// Resamples, transfers joint rotations (rest poses may differ: bones are matched by their directions), scales
// the path by leg length, puts the first frame at the origin along +Z, and adds a lead-in of 1.5 s that eases
// from standing into the first pose. Feet that are slow and low are in contact. A capture floor that is
// slightly tilted is levelled, and T-poses that a converter put before the motion are left out. The
// performer's first joint is its pelvis; it stands at rest on flat feet at y = 0 and looks along +Z. Throws
// `InvalidArgument` for a joint that the map names and the motion does not have (lists what is there), or if
// no built-in map fits.
PerformerClip retarget(const SkeletalMotion& motion, const Skeleton& performer,
                       const RetargetOptions& options = {});

}  // namespace reprise
