// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Any skeletal motion on a character's skeleton.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reprise/database/markup.h"
#include "reprise/math/ground_transform.h"
#include "reprise/retarget/standing_figure.h"

namespace reprise {

struct RetargetOptions {
  double frames_per_second = 25.0;
  std::optional<JointMap> joint_map;  // none: `find_joints`
  bool plant_feet = true;             // hold feet that stand still in the source, by inverse kinematics
  bool scale_path = true;             // by leg length; else the hips go as far as the source's
};

struct RetargetedMotion {
  SkeletalMotion motion;               // of the character's own skeleton
  std::vector<FootContacts> contacts;  // one a frame of `motion`
  JointMap map;                        // of the source
  double scale = 1.0;                  // leg length of the character over that of the source
  std::size_t left_out = 0;            // frames of the source before its motion begins (a converter's T-pose)
  GroundTransform world_from_source;   // source scaled by `scale` (1 if not `scale_path`), then moved by this
  // The source itself at the frames of `motion`: joints of the character that it has (ascending), and where
  // it has them, one row each: metres in its own size, in its own place on the ground, upright, floor
  // levelled.
  std::vector<int> source_joints;
  std::vector<Eigen::MatrixX3d> source_positions;
};

// Resamples, transfers joint rotations (rest poses may differ: bones are matched by their directions), scales
// the path by leg length, and puts the first frame at the origin along +Z. Feet that are slow and low are in
// contact. A capture floor that is slightly tilted is levelled, and T-poses that a converter put before the
// motion are left out. Throws `InvalidArgument`: no joint map fits, a motion without frames or with poses
// that are not finite, a rate out of range, legs without length.
RetargetedMotion retarget_motion(const SkeletalMotion& source, const StandingFigure& character,
                                 const RetargetOptions& options = {});

}  // namespace reprise
