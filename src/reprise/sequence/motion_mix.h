// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Limbs of one motion on the body of another.

#pragma once

#include <string>
#include <vector>

#include "reprise/sequence/skeleton.h"

namespace reprise {

struct MotionMixOptions {
  std::vector<std::string> limbs;  // joints; all below them go with them
  double start = 0.0;              // seconds of the other motion before its first frame that is used
};

// The motion of `body` with the rotations of some limbs, against the joint they hang on, from `limbs_of`.
// Lengths, root and rate are those of `body`; the result ends where the shorter of both ends. Rest poses
// should have the same directions. Throws `InvalidArgument` for no limb, a joint that one of both does not
// have (lists what is there), a root, a motion without frames, or a start that is negative or beyond the end.
SkeletalMotion mix_motions(const SkeletalMotion& body, const SkeletalMotion& limbs_of,
                           const MotionMixOptions& options);

}  // namespace reprise
