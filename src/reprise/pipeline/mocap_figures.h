// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What a driven character's motion is measured by, frame by frame as it is made.

#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "reprise/mocap/mocap_character.h"
#include "reprise/mocap/motion_quality.h"
#include "reprise/mocap/velocity_error.h"

namespace reprise {

struct MocapFigures {
  VelocityError velocity;        // against the query enlarged by the ratio of leg lengths
  VelocityError velocity_as_is;  // against the query in its own size
  MotionQuality quality;
};

// Takes the frames of one animation in order. All arguments must outlive it.
class MocapMeter {
 public:
  MocapMeter(const MocapCharacter& character, const MotionQualityScale& scale,
             const RetargetedMotion& target);

  void add(const Mesh& frame, const FrameOrigin& origin);
  // After the last frame. Throws `InvalidArgument` if there were not as many as the target has.
  MocapFigures figures() const;

 private:
  const MocapCharacter& character_;
  const RetargetedMotion& target_;
  MotionQualityMeter quality_;
  std::vector<SkeletonPose> poses_;
};

// velocity_error_cm_frame and velocity_error_unscaled_cm_frame (mean, deviation, and the first also per
// joint), pop_ratio, peak_ratio, foot_drift_cm_s, foot_height_cm, edge_stretch_p99.
nlohmann::json describe(const MocapFigures& figures, const RetargetedMotion& target);

}  // namespace reprise
