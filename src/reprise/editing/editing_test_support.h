// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// An editor that is exact and instant, for what holds of any editor.

#pragma once

#include <atomic>
#include <cmath>

#include "reprise/core/error.h"
#include "reprise/editing/editor_factory.h"
#include "support/shapes.h"

namespace reprise::test {

// Every vertex goes with the constraints around it, weighted with the inverse fourth power of the distance;
// constrained vertices meet their targets. Throws where a target lies farther than 1000 m from the origin.
class NearbyEditor final : public SurfaceEditor {
 public:
  explicit NearbyEditor(std::atomic<int>& solves) : solves_(solves) {}

  void set_frame(const PositionsView& frame, const SkeletonPose*) override {
    frame_ = frame.cast<double>();
    positions_ = frame_;
  }

  DeformReport deform(std::span<const PositionConstraint> constraints) override {
    check_constraints(constraints, static_cast<std::int32_t>(frame_.rows()), frame_);
    positions_.setZero();  // what fails half way leaves nothing of use
    for (const PositionConstraint& constraint : constraints) {
      if (constraint.target.norm() > 1000.0) throw Error("too far");
    }
    for (Eigen::Index v = 0; v < frame_.rows(); ++v) positions_.row(v) = moved(v, constraints);
    ++solves_;
    return {
        .iterations = 1, .solved_parts = 1, .largest_residual = largest_residual(constraints, positions_)};
  }

  const Coordinates& positions() const override { return positions_; }

 private:
  Eigen::RowVector3d moved(Eigen::Index v, std::span<const PositionConstraint> constraints) const {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    double total = 0.0;
    for (const PositionConstraint& constraint : constraints) {
      if (constraint.vertex == v) return constraint.target.transpose();
      const double distance = (frame_.row(v) - frame_.row(constraint.vertex)).norm();
      const double weight = constraint.weight / std::pow(distance, 4.0);
      sum += weight * (constraint.target.transpose() - frame_.row(constraint.vertex));
      total += weight;
    }
    return frame_.row(v) + sum / total;
  }

  std::atomic<int>& solves_;
  Coordinates frame_;
  Coordinates positions_;
};

// `dqs` is a model that cannot be made.
class NearbyFactory final : public EditorFactory {
 public:
  using EditorFactory::EditorFactory;

  std::unique_ptr<SurfaceEditor> make(EditModel model) const override {
    if (model == EditModel::dqs) throw InvalidArgument("no such model here");
    return std::make_unique<NearbyEditor>(solves);
  }
  const SkeletonPose* pose(EditModel, FrameId) const override { return nullptr; }

  mutable std::atomic<int> solves = 0;
};

}  // namespace reprise::test
