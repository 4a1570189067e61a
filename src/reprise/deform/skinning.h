// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Skinning of captured frames: from the pose a frame has to another one.

#pragma once

#include "reprise/deform/skin_weights.h"
#include "reprise/mesh/mesh.h"
#include "reprise/sequence/skeleton.h"

namespace reprise {

enum class Skinning {
  linear,           // x' = sum_j w_j (R_j x + t_j): joints lose volume when they bend far or twist
  dual_quaternion,  // x' = the motion nearest to sum_j w_j (q_j, t_j q_j / 2) of x (Kavan et al. 2007): they
                    // keep it, and bulge a little
};

// Moves a frame from the pose it has to another: the bone of joint j carries its vertices by
//   target.world_from_rest(j) * source.world_from_rest(j)^-1,
// so that any frame will do, not only the rest pose, and its own folds and swing stay with it. The same pose
// twice changes nothing; one rigid motion after the target pose moves the result by it.
//
// `source`, `skinned`: N x 3 positions, which may be the same. Weights as `skin_weights` gives them. Throws
// `InvalidArgument` if shapes differ or a pose does not fit the skeleton.
void skin(const SkinWeights& weights, const Skeleton& skeleton, const PositionsView& source,
          const SkeletonPose& source_pose, const SkeletonPose& target_pose, Skinning skinning,
          PositionsRef skinned);

// How the bones move between two poses of one skeleton: x -> rotation x + translation, one a joint.
struct BoneMotion {
  Eigen::Quaterniond rotation;
  Eigen::Vector3d translation;
};
std::vector<BoneMotion> bone_motions(const SkeletonPose& source, const SkeletonPose& target);

// Throws `InvalidArgument` unless the pose has one finite position and one unit rotation a joint. `name`: how
// to call it in the message.
void validate(const SkeletonPose& pose, const Skeleton& skeleton, const char* name);

}  // namespace reprise
