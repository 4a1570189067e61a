// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mocap/velocity_error.h"

#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/mocap/surface_driver.h"

namespace reprise {
namespace {

void check(const std::vector<SkeletonPose>& result, const RetargetedMotion& target) {
  const std::size_t frames = target.motion.frames.size();
  if (result.size() != frames || target.source_positions.size() != frames) {
    throw InvalidArgument(fmt::format("velocities: the result has {} frames, the target {}, its source {}",
                                      result.size(), frames, target.source_positions.size()));
  }
  const std::size_t joints = target.motion.skeleton.joints.size();
  for (std::size_t f = 0; f < frames; ++f) {
    if (result[f].position.size() != joints) {
      throw InvalidArgument(fmt::format("velocities: frame {} has {} joints; expected {}", f,
                                        result[f].position.size(), joints));
    }
  }
}

}  // namespace

VelocityError velocity_error(const std::vector<SkeletonPose>& result, const RetargetedMotion& target,
                             VelocityScale scale) {
  check(result, target);
  const std::size_t joints = target.source_joints.size();
  VelocityError error{.per_joint = std::vector(joints, 0.0)};
  if (result.size() < 2 || joints == 0) return error;
  const double size = scale == VelocityScale::legs ? target.scale : 1.0;
  const Eigen::Matrix3d turn = target.world_from_source.rotation();
  std::vector<double> of_frame;
  for (std::size_t f = 1; f < result.size(); ++f) {
    const Eigen::Matrix3d own_turn = nearest_upright(result[f], target.motion.frames[f]).ground.rotation();
    double sum = 0.0;
    for (std::size_t i = 0; i < joints; ++i) {
      const auto joint = static_cast<std::size_t>(target.source_joints[i]);
      const auto row = static_cast<Eigen::Index>(i);
      const Eigen::Vector3d wanted =
          size * turn *
          (target.source_positions[f].row(row) - target.source_positions[f - 1].row(row)).transpose();
      const Eigen::Vector3d found = own_turn * (result[f].position[joint] - result[f - 1].position[joint]);
      const double difference = (found - wanted).norm();
      sum += difference;
      error.per_joint[i] += difference / static_cast<double>(result.size() - 1);
    }
    of_frame.push_back(sum / static_cast<double>(joints));
  }
  const double count = static_cast<double>(of_frame.size());
  for (const double value : of_frame) error.mean += value / count;
  double variance = 0.0;
  for (const double value : of_frame) variance += (value - error.mean) * (value - error.mean) / count;
  error.deviation = std::sqrt(variance);
  return error;
}

}  // namespace reprise
