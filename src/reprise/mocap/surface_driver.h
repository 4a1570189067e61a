// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// One frame of the surface takes another pose (HSSMG 5.2.3).

#pragma once

#include <memory>
#include <vector>

#include "reprise/deform/part_editor.h"
#include "reprise/deform/skinning.h"
#include "reprise/math/ground_transform.h"
#include "reprise/mocap/drive_model.h"
#include "reprise/mocap/drive_vertices.h"

namespace reprise {

// What drives a frame, shared by all drivers of a character. Immutable.
struct DriveRig {
  TopologyPtr topology;
  const Markup* markup = nullptr;
  std::shared_ptr<const SkinWeights> weights;
  std::vector<DriveVertex> vertices;
  std::shared_ptr<const PartModel> learnt;  // for the models `part` and `whole`
};

// Learnt parts for driving. Constraints are dense, so the pose of a part is known, and what the coefficients
// of its learnt space must not do is explain the rest of its motion: their prior is a hundred times that of
// edits by hand. For the same reason the surface turns by itself only where it is far from what was learnt;
// skirts that hang loosely flutter from frame to frame otherwise (docs/mocap.md).
PartEditorOptions drive_part_options();

// Keeps factorisations from frame to frame; one a thread. What it makes of a frame does not depend on the
// frames before.
class SurfaceDriver {
 public:
  // Throws `InvalidArgument` for a learnt model that the rig lacks.
  SurfaceDriver(DriveRig rig, DriveModel model);
  ~SurfaceDriver();

  // `frame`, whose skeleton is in `source`, in the pose `target`: N x 3, metres. It is first moved as a whole
  // to where its joints lie nearest to their targets; skinning from there tells the drive vertices where to
  // be (x_c), and the model solves for the rest. The same pose twice gives the frame back, to rounding.
  // `out` may be `frame`.
  void drive(const PositionsView& frame, const SkeletonPose& source, const SkeletonPose& target,
             PositionsRef out);

 private:
  DriveRig rig_;
  DriveModel model_;
  std::unique_ptr<SurfaceEditor> editor_;  // null: skinning alone
};

// The yaw and translation that bring the joints of `source` nearest to those of `target`, in the
// least-squares sense. As many joints.
struct UprightMotion {
  GroundTransform ground;
  double rise = 0.0;  // metres, along +Y, after it

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return ground * point + rise * Eigen::Vector3d::UnitY();
  }
};
UprightMotion nearest_upright(const SkeletonPose& source, const SkeletonPose& target);
SkeletonPose moved(const UprightMotion& motion, const SkeletonPose& pose);

}  // namespace reprise
