// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Editing by skinning alone: the comparison of HSSMG Figure 10.

#pragma once

#include <memory>

#include "reprise/deform/pose_fit.h"
#include "reprise/deform/surface_editor.h"

namespace reprise {

// Finds the pose whose skinned frame meets the constraints (`fit_pose`) and skins the frame to it. Knows
// nothing of surfaces: folds stay as they are and go with the bones.
class SkinEditor final : public SurfaceEditor {
 public:
  // `weights` may be shared by any number of editors. Throws `InvalidArgument` if they do not fit the
  // skeleton.
  SkinEditor(std::shared_ptr<const SkinWeights> weights, Skeleton skeleton,
             const PoseFitOptions& options = {});

  // `pose`: of the weights' skeleton, not null.
  void set_frame(const PositionsView& frame, const SkeletonPose* pose) override;
  DeformReport deform(std::span<const PositionConstraint> constraints) override;
  const Coordinates& positions() const override { return positions_; }

  // The pose of the last result.
  const SkeletonPose& pose() const { return pose_; }

 private:
  std::shared_ptr<const SkinWeights> weights_;
  Skeleton skeleton_;
  PoseFitOptions options_;
  Positions frame_;  // N x 3; empty before `set_frame`
  SkeletonPose frame_pose_;
  SkeletonPose pose_;
  Coordinates positions_;
};

}  // namespace reprise
