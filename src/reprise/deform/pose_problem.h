// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The cost of a pose that `fit_pose` minimises, its gradient and its curvature. Internal.

#pragma once

#include <span>
#include <utility>
#include <vector>

#include "reprise/deform/posed_vertices.h"
#include "reprise/deform/position_constraint.h"

namespace reprise {

class PoseProblem {
 public:
  // The unknowns of a step: for each joint a turn with all that hangs on it about its place, in world axes
  // (radians), for each root a shift as well (metres).
  using Step = Eigen::VectorXd;

  // Cost of a pose after a step s, to second order: cost + 2 g s + s H s.
  struct Model {
    Eigen::MatrixXd H;  // only the lower triangle
    Eigen::VectorXd g;
    Eigen::VectorXd scales;  // how stiffly each unknown is held; alike for the three axes of one
  };

  // Everything has been validated and outlives the problem. `pull2`: the square of `PoseFitOptions::pull`.
  PoseProblem(const SkinWeights& weights, const Skeleton& skeleton, const PositionsView& source,
              const SkeletonPose& source_pose, std::span<const PositionConstraint> constraints,
              Skinning skinning, double pull2);

  void set_pull2(double pull2) { pull2_ = pull2; }

  // Root mean square distance of the constrained vertices from their targets.
  double residual(const SkeletonPose& pose) const;
  double cost(const SkeletonPose& pose) const;
  void linearise(const SkeletonPose& pose, Model& model);
  SkeletonPose moved(const SkeletonPose& pose, const Step& step) const;

  // The source moved as a whole to where its constrained vertices fit best.
  SkeletonPose first_guess() const;

  // Of all joints.
  double longest_turn(const Step& step) const;
  // The most that any joint is held against turning.
  double stiffness(const Model& model) const;

 private:
  struct JointUnknowns {
    int parent = -1;
    Eigen::Quaterniond source_turn;  // in the source, against the parent
    Eigen::Vector3d offset;          // of the joint in its parent's frame
    Eigen::Index turn = 0;           // columns of the unknowns
    Eigen::Index shift = -1;         // -1: not a root
    std::vector<bool> is_above;      // one entry a joint: it hangs on this one
  };

  Eigen::Vector3d bend(const SkeletonPose& pose, std::size_t joint) const;
  void add_constraint(std::size_t i, const Eigen::Vector3d& place, Model& model) const;
  void add_pull(const SkeletonPose& pose, std::size_t joint, Model& model) const;

  const SkeletonPose& source_pose_;
  std::span<const PositionConstraint> constraints_;
  double pull2_;
  PosedVertices vertices_;
  std::vector<JointUnknowns> joints_;
  Eigen::Index unknown_count_ = 0;
  std::vector<std::vector<PosedVertices::Motion>> motions_;  // of the last linearisation
};

}  // namespace reprise
