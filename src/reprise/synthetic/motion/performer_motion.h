// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The clips a performer plays: foot-planted motion on the performer's skeleton, made from gait data and key
// poses.

#pragma once

#include <string>
#include <vector>

#include "reprise/database/markup.h"
#include "reprise/sequence/skeleton.h"

namespace reprise {

// A clip with a lead-in: frames before its first one, in which cloth and hair come to rest in motion.
struct PerformerClip {
  SkeletalMotion motion;               // lead-in frames, then the clip's frames
  int lead_in = 0;                     // frames
  std::vector<FootContacts> contacts;  // one a frame of `motion`
};

// Clips of a set: "character" (10 clips, 442 frames: stand, walk, jog, stagger, hit, tense, stand_walk,
// walk_stand, walk_jog, jog_walk) or "fashion1" (6 clips, 491 frames: pose, walk, twirl, pose_walk,
// walk_pose, pose_twirl) or "fashion2" (the same names, 435 frames, a livelier performance). At
// `frames_per_second`; the counts hold at 25. Every clip begins at the origin along +Z. `skeleton`: the
// performer's own, see `DressedBody`; lengths and speeds scale with its legs. Deterministic. Throws
// `InvalidArgument` for an unknown set.
std::vector<PerformerClip> performer_clips(const std::string& set, const Skeleton& skeleton,
                                           double frames_per_second = 25.0);

}  // namespace reprise
