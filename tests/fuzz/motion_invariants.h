// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What holds of every motion a parser returns, however odd its input.

#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "reprise/sequence/skeleton.h"

namespace reprise::fuzz {

inline void require(bool condition) {
  if (!condition) std::abort();
}

inline void check(const SkeletalMotion& motion) {
  validate(motion.skeleton);  // an exception of this kind is none of the parsers'
  require(!motion.frames.empty());
  require(motion.frames_per_second > 0.0 && std::isfinite(motion.frames_per_second));
  for (const SkeletonPose& pose : motion.frames) {
    require(pose.rotation.size() == motion.skeleton.joints.size());
    require(pose.position.size() == motion.skeleton.joints.size());
    for (const Eigen::Quaterniond& rotation : pose.rotation) require(std::abs(rotation.norm() - 1.0) < 1e-6);
    for (const Eigen::Vector3d& position : pose.position) require(position.allFinite());
  }
}

}  // namespace reprise::fuzz
