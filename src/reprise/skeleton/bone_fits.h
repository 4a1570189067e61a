// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// How the labelled vertices of a bone tell where it is: what single frames and whole clips share. Internal.

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reprise/database/markup.h"
#include "reprise/sequence/mesh_sequence.h"
#include "reprise/skeleton/pose_inference.h"
#include "reprise/skeleton/rigid_fit.h"
#include "reprise/skeleton/skeleton_extraction.h"

namespace reprise::skeleton {

using Points = std::vector<Eigen::Vector3d>;

Points gather(const PositionsView& positions, const std::vector<std::int32_t>& vertices);

// The labelled vertices of one bone.
struct LabelledBone {
  std::vector<std::int32_t> vertices;  // ascending
  Points rest;
  std::vector<double> weights;  // the area around each, m^2
  bool is_followed = false;
};

// One bone a joint.
std::vector<LabelledBone> label_bones(const Topology& topology, const Markup& markup, int fewest_vertices);

// Throws `InvalidArgument` with the counts of vertices if no bone can be followed.
void check_followed(const Skeleton& skeleton, const std::vector<LabelledBone>& bones, int fewest_vertices);

// Throws `InvalidArgument` as `extract_skeleton` does.
void check_input(const MeshSequence& clip, const Markup& markup, const SkeletonExtractionOptions& options);

// Vertices that hold their place in the bone say more than those that slide over it: each is weighted by how
// its squared residual, summed over frames, stands to the middle one.
std::vector<double> steady_weights(const LabelledBone& bone, const std::vector<double>& residuals);

// Adds to each vertex's entry its squared residual, m^2.
void add_residuals(const LabelledBone& bone, const Points& points, const RigidFit& fit,
                   std::vector<double>& residuals);

// From the fits of a frame, one a followed bone (others null), to the pose of all bones.
class PoseFromFits {
 public:
  PoseFromFits(const Skeleton& skeleton, const std::vector<LabelledBone>& bones);
  SkeletonPose operator()(std::span<const RigidFit* const> fits) const;

 private:
  Skeleton skeleton_;
  PoseInference inference_;
};

// HSSMG 3: joints are the centres of mass of their labelled vertices; those without keep their place.
void put_joints_at_centroids(const std::vector<LabelledBone>& bones, Skeleton& skeleton);
void put_joints_at_centroids(const std::vector<LabelledBone>& bones, const PositionsView& frame,
                             SkeletonPose& pose);

}  // namespace reprise::skeleton
