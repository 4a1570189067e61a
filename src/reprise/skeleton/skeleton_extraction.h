// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The skeleton of a mesh sequence from marked-up vertices (HSSMG 3).

#pragma once

#include <vector>

#include "reprise/database/markup.h"
#include "reprise/sequence/mesh_sequence.h"

namespace reprise {

struct SkeletonExtractionOptions {
  enum class JointPosition {
    rigid,     // where the bones on both sides of the joint carry its rest position
    centroid,  // the paper's: the centroid of the vertices labelled with the joint
  };
  JointPosition position = JointPosition::rigid;
  // Bones with fewer labelled vertices than this are inferred from their neighbours (a knee under a long
  // skirt).
  int fewest_vertices = 6;
};

// A pose a frame: every bone's full rotation is the least-squares rigid fit (Kabsch) of its labelled vertices
// from the markup's reference surface to the frame, so that the twist about the bone is known. Bones without
// enough vertices are placed between those that have them, keeping bone lengths (two-bone inverse kinematics
// for a limb). Throws `InvalidArgument` if the markup does not fit the clip or labels too few bones to stand
// on.
SkeletalMotion extract_skeleton(const MeshSequence& clip, const Markup& markup,
                                const SkeletonExtractionOptions& options = {});

// Which bones are followed by their own vertices, one entry a joint; the others are inferred.
std::vector<bool> followed_bones(const Topology& topology, const Markup& markup,
                                 const SkeletonExtractionOptions& options = {});

// The markup's skeleton with joints moved to where the bones on both sides agree best through all clips: a
// joint is the point that both carry alike, as far as they turn against each other; in directions that the
// motion does not show, and where a bone or its parent is not followed, it stays. No joint moves farther than
// 6 cm. For skeletons that were placed by eye. Throws as `extract_skeleton` does.
Skeleton refine_joints(const std::vector<MeshSequence>& clips, const Markup& markup,
                       const SkeletonExtractionOptions& options = {});

// How far two motions of one skeleton are apart: mean and greatest over frames, per joint.
struct PoseDifference {
  std::vector<double> mean_distance, max_distance;  // metres
  std::vector<double> mean_angle, max_angle;        // radians, between full rotations
  double distance = 0.0, angle = 0.0;               // means over joints
};
PoseDifference pose_difference(const SkeletalMotion& motion, const std::vector<SkeletonPose>& truth);

}  // namespace reprise
