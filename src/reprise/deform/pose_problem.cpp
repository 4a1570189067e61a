// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/pose_problem.h"

#include <algorithm>
#include <cmath>

#include "reprise/skeleton/rigid_fit.h"

namespace reprise {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Quaterniond exp_of(const Vector3d& turn) {
  const double angle = turn.norm();
  if (!(angle > 0.0)) return Quaterniond::Identity();
  return Quaterniond(Eigen::AngleAxisd(angle, turn / angle));
}

// The shortest rotation vector of a unit quaternion.
Vector3d log_of(const Quaterniond& q) {
  const double sine = q.vec().norm();
  if (!(sine > 0.0)) return Vector3d::Zero();
  return std::copysign(2.0 * std::atan2(sine, std::abs(q.w())) / sine, q.w()) * q.vec();
}

// The vector a of a x w, from the matrix of that product or one near to it.
Vector3d vector_of(const Matrix3d& cross) {
  return 0.5 * Vector3d(cross(2, 1) - cross(1, 2), cross(0, 2) - cross(2, 0), cross(1, 0) - cross(0, 1));
}

std::vector<std::int32_t> vertices_of(std::span<const PositionConstraint> constraints) {
  std::vector<std::int32_t> result;
  for (const PositionConstraint& constraint : constraints) result.push_back(constraint.vertex);
  return result;
}

}  // namespace

PoseProblem::PoseProblem(const SkinWeights& weights, const Skeleton& skeleton, const PositionsView& source,
                         const SkeletonPose& source_pose, std::span<const PositionConstraint> constraints,
                         Skinning skinning, double pull2)
    : source_pose_(source_pose),
      constraints_(constraints),
      pull2_(pull2),
      vertices_(weights, skeleton, source, source_pose, vertices_of(constraints), skinning) {
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    JointUnknowns joint{.parent = skeleton.joints[j].parent, .turn = unknown_count_};
    unknown_count_ += 3;
    if (joint.parent < 0) {
      joint.shift = unknown_count_;
      unknown_count_ += 3;
      joint.source_turn = source_pose.rotation[j];
      joint.offset = source_pose.position[j];
    } else {
      const auto p = static_cast<std::size_t>(joint.parent);
      const Quaterniond parent_from_world = source_pose.rotation[p].conjugate();
      joint.source_turn = parent_from_world * source_pose.rotation[j];
      joint.offset = parent_from_world * (source_pose.position[j] - source_pose.position[p]);
    }
    joint.is_above.assign(skeleton.joints.size(), false);
    for (std::size_t k = j + 1; k < skeleton.joints.size(); ++k) {
      const int parent = skeleton.joints[k].parent;
      joint.is_above[k] =
          parent == static_cast<int>(j) || (parent >= 0 && joint.is_above[static_cast<std::size_t>(parent)]);
    }
    joints_.push_back(std::move(joint));
  }
}

double PoseProblem::residual(const SkeletonPose& pose) const {
  if (constraints_.empty()) return 0.0;
  const std::vector<Vector3d> places = vertices_.positions(pose);
  double sum = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i) sum += (places[i] - constraints_[i].target).squaredNorm();
  return std::sqrt(sum / static_cast<double>(places.size()));
}

double PoseProblem::cost(const SkeletonPose& pose) const {
  const std::vector<Vector3d> places = vertices_.positions(pose);
  double sum = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double weight2 = constraints_[i].weight * constraints_[i].weight;
    sum += weight2 * (places[i] - constraints_[i].target).squaredNorm();
  }
  for (std::size_t j = 0; j < joints_.size(); ++j) sum += pull2_ * bend(pose, j).squaredNorm();
  return sum;
}

SkeletonPose PoseProblem::first_guess() const {
  std::vector<Vector3d> from, to;
  std::vector<double> weights;
  for (std::size_t i = 0; i < constraints_.size(); ++i) {
    from.push_back(vertices_.source_position(i));
    to.push_back(constraints_[i].target);
    weights.push_back(constraints_[i].weight * constraints_[i].weight);
  }
  const skeleton::RigidFit fit = skeleton::fit_rigid(from, to, weights);
  Quaterniond rotation = Quaterniond::Identity();
  if (skeleton::fixes_rotation(from, weights) && skeleton::fixes_rotation(to, weights)) {
    rotation = Quaterniond(fit.rotation).normalized();
  }
  SkeletonPose pose = source_pose_;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    pose.rotation[j] = rotation * pose.rotation[j];
    pose.position[j] = fit.centroid + rotation * (pose.position[j] - fit.rest_centroid);
  }
  return pose;
}

void PoseProblem::linearise(const SkeletonPose& pose, Model& model) {
  model.H.setZero(unknown_count_, unknown_count_);
  model.g.setZero(unknown_count_);
  model.scales.setZero(unknown_count_);
  const std::vector<Vector3d> places = vertices_.positions(pose);
  vertices_.derivatives(pose, motions_);
  for (std::size_t i = 0; i < places.size(); ++i) add_constraint(i, places[i], model);
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    if (joints_[j].parent >= 0) add_pull(pose, j, model);
  }
  model.scales = model.scales.cwiseMax(pull2_);
}

SkeletonPose PoseProblem::moved(const SkeletonPose& pose, const Step& step) const {
  SkeletonPose result = pose;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const JointUnknowns& joint = joints_[j];
    const Quaterniond turned = exp_of(step.segment<3>(joint.turn)) * pose.rotation[j];
    if (joint.parent < 0) {
      result.rotation[j] = turned.normalized();
      result.position[j] = pose.position[j] + step.segment<3>(joint.shift);
      continue;
    }
    const auto p = static_cast<std::size_t>(joint.parent);
    result.rotation[j] = (result.rotation[p] * (pose.rotation[p].conjugate() * turned)).normalized();
    result.position[j] = result.position[p] + result.rotation[p] * joint.offset;
  }
  return result;
}

double PoseProblem::longest_turn(const Step& step) const {
  double longest = 0.0;
  for (const JointUnknowns& joint : joints_) longest = std::max(longest, step.segment<3>(joint.turn).norm());
  return longest;
}

double PoseProblem::stiffness(const Model& model) const {
  double largest = 0.0;
  for (const JointUnknowns& joint : joints_) largest = std::max(largest, model.scales[joint.turn]);
  return largest;
}

// Rotation vector of a joint against its parent from the source to the pose, in the joint's own frame; zero
// for roots.
Vector3d PoseProblem::bend(const SkeletonPose& pose, std::size_t joint) const {
  const JointUnknowns& unknowns = joints_[joint];
  if (unknowns.parent < 0) return Vector3d::Zero();
  const auto p = static_cast<std::size_t>(unknowns.parent);
  return log_of(unknowns.source_turn.conjugate() * (pose.rotation[p].conjugate() * pose.rotation[joint]));
}

// With r the residual and x = ... + w x y for a turn w of a joint: Gauss and Newton's term, and the curvature
// of the arc, r (v x (w x y)) for a turn v of the same joint or one above. Without that a limb on its way to
// a target out of reach swings about it. For dual quaternions y is the linear part of what they do.
void PoseProblem::add_constraint(std::size_t i, const Vector3d& place, Model& model) const {
  const double weight2 = constraints_[i].weight * constraints_[i].weight;
  const Vector3d r = place - constraints_[i].target;
  const std::vector<int>& movers = vertices_.joints(i);
  for (std::size_t b = 0; b < movers.size(); ++b) {
    const auto low = static_cast<std::size_t>(movers[b]);
    const PosedVertices::Motion& motion = motions_[i][b];
    const Eigen::Index row = joints_[low].turn;
    const Vector3d y = vector_of(-motion.turn);
    model.g.segment<3>(row) += weight2 * (motion.turn.transpose() * r);
    model.scales.segment<3>(row).array() += weight2 * (motion.turn.squaredNorm() / 3.0 + r.norm() * y.norm());
    const Matrix3d arc = r * y.transpose() - r.dot(y) * Matrix3d::Identity();
    model.H.block<3, 3>(row, row) +=
        weight2 * (motion.turn.transpose() * motion.turn + 0.5 * (arc + arc.transpose()));
    for (std::size_t a = 0; a < b; ++a) {
      const auto high = static_cast<std::size_t>(movers[a]);
      Matrix3d block = motion.turn.transpose() * motions_[i][a].turn;
      if (joints_[high].is_above[low]) block += arc;
      model.H.block<3, 3>(row, joints_[high].turn) += weight2 * block;
      if (joints_[high].parent < 0) {
        model.H.block<3, 3>(row, joints_[high].shift) +=
            weight2 * motion.turn.transpose() * motions_[i][a].shift;
      }
    }
    if (joints_[low].parent >= 0) continue;
    const Eigen::Index shift = joints_[low].shift;
    model.g.segment<3>(shift) += weight2 * (motion.shift.transpose() * r);
    model.scales.segment<3>(shift).array() += weight2 * motion.shift.squaredNorm() / 3.0;
    model.H.block<3, 3>(shift, shift) += weight2 * motion.shift.transpose() * motion.shift;
    model.H.block<3, 3>(shift, row) += weight2 * motion.shift.transpose() * motion.turn;
    for (std::size_t a = 0; a < b; ++a) {
      const JointUnknowns& other = joints_[static_cast<std::size_t>(movers[a])];
      model.H.block<3, 3>(shift, other.turn) += weight2 * motion.shift.transpose() * motions_[i][a].turn;
      if (other.parent < 0) {
        model.H.block<3, 3>(shift, other.shift) += weight2 * motion.shift.transpose() * motions_[i][a].shift;
      }
    }
  }
}

// A turn w of the joint in world axes changes its rotation vector f, itself turned to world axes, by w along
// f and by the factor a / sin a, a = |f| / 2, across it (the inverse right Jacobian of the exponential, but
// for a rotation).
void PoseProblem::add_pull(const SkeletonPose& pose, std::size_t joint, Model& model) const {
  const Vector3d f = pose.rotation[joint] * bend(pose, joint);
  const double half = 0.5 * f.norm();
  const double across = half > 1e-6 ? half / std::sin(half) : 1.0;
  Matrix3d M = across * across * Matrix3d::Identity();
  if (half > 1e-6) M += (1.0 - across * across) * f * f.transpose() / f.squaredNorm();
  const Eigen::Index column = joints_[joint].turn;
  model.H.block<3, 3>(column, column) += pull2_ * M;
  model.g.segment<3>(column) += pull2_ * f;
  model.scales.segment<3>(column).array() += pull2_;
}

}  // namespace reprise
