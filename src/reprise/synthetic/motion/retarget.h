// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Any skeletal motion on the performer's skeleton.

#pragma once

#include "reprise/retarget/retarget.h"
#include "reprise/synthetic/motion/performer_motion.h"

namespace reprise {

// `retarget_motion` on the performer, whose rest pose stands on flat feet at y = 0 and looks along +Z and
// whose first joint is its pelvis, with a lead-in of 1.5 s that eases from standing into the first pose.
// Throws `InvalidArgument` as `retarget_motion` does, or if the performer does not stand so.
PerformerClip retarget(const SkeletalMotion& motion, const Skeleton& performer,
                       const RetargetOptions& options = {});

}  // namespace reprise
