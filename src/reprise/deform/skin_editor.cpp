// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/skin_editor.h"

#include <utility>

#include "reprise/core/error.h"

namespace reprise {

SkinEditor::SkinEditor(std::shared_ptr<const SkinWeights> weights, Skeleton skeleton,
                       const PoseFitOptions& options)
    : weights_(std::move(weights)), skeleton_(std::move(skeleton)), options_(options) {
  if (weights_ == nullptr) throw InvalidArgument("a skin editor needs skinning weights, found none");
  validate(*weights_, static_cast<std::int32_t>(weights_->rows()), skeleton_.size());
}

void SkinEditor::set_frame(const PositionsView& frame, const SkeletonPose* pose) {
  check_frame(frame, static_cast<std::int32_t>(weights_->rows()));
  if (pose == nullptr) throw InvalidArgument("a skinned model needs the pose of the frame, found none");
  validate(*pose, skeleton_, "the pose of the frame");
  frame_pose_ = *pose;
  pose_ = *pose;
  frame_ = frame;
  positions_ = frame.cast<double>();
}

DeformReport SkinEditor::deform(std::span<const PositionConstraint> constraints) {
  check_constraints(constraints, static_cast<std::int32_t>(weights_->rows()), positions_);

  const PositionsView frame(frame_.data(), frame_.rows(), 3);
  PoseFit fit = fit_pose(*weights_, skeleton_, frame, frame_pose_, constraints, options_);
  Positions skinned(frame_.rows(), 3);
  skin(*weights_, skeleton_, frame, frame_pose_, fit.pose, options_.skinning,
       PositionsRef(skinned.data(), skinned.rows(), 3));
  positions_ = skinned.cast<double>();
  pose_ = std::move(fit.pose);
  return {.iterations = fit.iterations,
          .solved_parts = skinned == frame_ ? 0 : 1,
          .largest_residual = largest_residual(constraints, positions_)};
}

}  // namespace reprise
