// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A few vertices of a skinned frame, where a pose puts them, and how they move with its joints. Internal.

#pragma once

#include <span>
#include <vector>

#include "reprise/deform/skinning.h"
#include "reprise/math/dual_quaternion.h"

namespace reprise {

class PosedVertices {
 public:
  // `vertices`: rows of `source` and of `weights`, which have been validated.
  PosedVertices(const SkinWeights& weights, const Skeleton& skeleton, const PositionsView& source,
                const SkeletonPose& source_pose, std::span<const std::int32_t> vertices, Skinning skinning);

  std::size_t size() const { return vertices_.size(); }
  const Eigen::Vector3d& source_position(std::size_t i) const { return vertices_[i].source; }
  // The joints that move vertex i: its bones and all above them, ascending.
  const std::vector<int>& joints(std::size_t i) const { return vertices_[i].joints; }

  // Where the vertex is.
  std::vector<Eigen::Vector3d> positions(const SkeletonPose& pose) const;

  // How it moves when one of `joints(i)` moves with everything below it: `turn` per radian of a rotation
  // about the joint's place (a column a world axis), `shift` per metre of a translation.
  struct Motion {
    Eigen::Matrix3d turn;
    Eigen::Matrix3d shift;
  };
  // `motions[i]`: one entry for each of `joints(i)`.
  void derivatives(const SkeletonPose& pose, std::vector<std::vector<Motion>>& motions) const;

 private:
  struct Vertex {
    Eigen::Vector3d source;
    std::vector<std::size_t> bones;  // largest weight first
    std::vector<double> weights;     // of the bones
    std::vector<int> joints;
    // Of each bone: itself and the joints above it, as indices of `joints`.
    std::vector<std::vector<std::size_t>> movers;
  };
  void derivatives_linear(const Vertex& vertex, const std::vector<BoneMotion>& bones,
                          const SkeletonPose& pose, std::vector<Motion>& motions) const;
  void derivatives_dual(const Vertex& vertex, const std::vector<DualQuaternion>& duals,
                        const SkeletonPose& pose, std::vector<Motion>& motions) const;

  SkeletonPose source_pose_;
  Skinning skinning_;
  std::vector<Vertex> vertices_;
};

}  // namespace reprise
