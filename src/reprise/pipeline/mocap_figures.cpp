// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/mocap_figures.h"

namespace reprise {
namespace {

constexpr double centimetres = 100.0;

nlohmann::json describe(const VelocityError& error) {
  return {{"mean", centimetres * error.mean}, {"deviation", centimetres * error.deviation}};
}

}  // namespace

MocapMeter::MocapMeter(const MocapCharacter& character, const MotionQualityScale& scale,
                       const RetargetedMotion& target)
    : character_(character), target_(target), quality_(scale, target.motion.frames_per_second) {}

void MocapMeter::add(const Mesh& frame, const FrameOrigin& origin) {
  const std::size_t f = poses_.size();
  quality_.add(frame.positions, origin.is_blend(),
               f < target_.contacts.size() ? target_.contacts[f] : FootContacts{});
  poses_.push_back(
      character_.follower().pose(PositionsView(frame.positions.data(), frame.positions.rows(), 3)));
}

MocapFigures MocapMeter::figures() const {
  return {.velocity = velocity_error(poses_, target_, VelocityScale::legs),
          .velocity_as_is = velocity_error(poses_, target_, VelocityScale::none),
          .quality = quality_.quality()};
}

nlohmann::json describe(const MocapFigures& figures, const RetargetedMotion& target) {
  nlohmann::json velocity = describe(figures.velocity);
  for (std::size_t j = 0; j < figures.velocity.per_joint.size() && j < target.source_joints.size(); ++j) {
    const auto joint = static_cast<std::size_t>(target.source_joints[j]);
    velocity["joints"][target.motion.skeleton.joints[joint].name] =
        centimetres * figures.velocity.per_joint[j];
  }
  return {{"velocity_error_cm_frame", std::move(velocity)},
          {"velocity_error_unscaled_cm_frame", describe(figures.velocity_as_is)},
          {"pop_ratio", figures.quality.pop_ratio},
          {"peak_ratio", figures.quality.peak_ratio},
          {"foot_drift_cm_s", figures.quality.foot_drift},
          {"foot_height_cm", figures.quality.foot_height},
          {"edge_stretch_p99", figures.quality.edge_stretch_p99}};
}

}  // namespace reprise
