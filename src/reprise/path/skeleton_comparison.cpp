// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/skeleton_comparison.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace reprise::path_detail {
namespace {

Eigen::Vector3d ground_mean(const Eigen::MatrixX3d& joints, const std::vector<double>& weights) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double total = 0.0;
  for (Eigen::Index j = 0; j < joints.rows(); ++j) {
    const double weight = weights[static_cast<std::size_t>(j)];
    sum += weight * joints.row(j).transpose();
    total += weight;
  }
  return {sum.x() / total, 0.0, sum.z() / total};
}

}  // namespace

MovingSkeleton moving_skeleton(const std::vector<Eigen::MatrixX3d>& track, std::size_t frame_idx) {
  constexpr std::size_t reach = 3;
  const std::size_t before = frame_idx - std::min(reach, frame_idx);
  const std::size_t after = std::min(frame_idx + reach, track.size() - 1);
  const auto span = static_cast<double>(std::max<std::size_t>(after - before, 1));
  return {.joints = track[frame_idx], .velocities = (track[after] - track[before]) / span};
}

double SkeletonWeights::sum() const {
  return std::accumulate(joints.begin(), joints.end(), 0.0);
}

double skeleton_dissimilarity(const MovingSkeleton& query, const MovingSkeleton& captured,
                              const SkeletonWeights& weights) {
  const Eigen::MatrixX3d q = query.joints.rowwise() - ground_mean(query.joints, weights.joints).transpose();
  const Eigen::MatrixX3d x =
      captured.joints.rowwise() - ground_mean(captured.joints, weights.joints).transpose();
  // With x' = c x + s z, z' = c z - s x the sum of squares is least where (c, s) points along (along,
  // across).
  double along = 0.0;
  double across = 0.0;
  for (Eigen::Index j = 0; j < q.rows(); ++j) {
    const double weight = weights.joints[static_cast<std::size_t>(j)];
    along += weight * (q(j, 0) * x(j, 0) + q(j, 2) * x(j, 2));
    across += weight * (q(j, 0) * x(j, 2) - q(j, 2) * x(j, 0));
  }
  const double length = std::hypot(along, across);
  const double c = length > 0.0 ? along / length : 1.0;
  const double s = length > 0.0 ? across / length : 0.0;
  const auto distance = [&](const Eigen::MatrixX3d& a, const Eigen::MatrixX3d& b, Eigen::Index j) {
    return (Eigen::RowVector3d(c * b(j, 0) + s * b(j, 2), b(j, 1), c * b(j, 2) - s * b(j, 0)) - a.row(j))
        .norm();
  };
  double sum = 0.0;
  for (Eigen::Index j = 0; j < q.rows(); ++j) {
    sum += weights.joints[static_cast<std::size_t>(j)] *
           (distance(q, x, j) + weights.velocity * distance(query.velocities, captured.velocities, j));
  }
  return sum;
}

QuerySkeleton::QuerySkeleton(const MovingSkeleton& skeleton, const SkeletonWeights& weights) {
  const Eigen::Vector3d mean = ground_mean(skeleton.joints, weights.joints);
  const auto add = [&](const Eigen::Vector3d& value, double weight) {
    const Eigen::Vector3f v = value.cast<float>();
    terms_.push_back({.x = v.x(), .y = v.y(), .z = v.z(), .weight = static_cast<float>(weight)});
  };
  const Eigen::Index joint_count = skeleton.joints.rows();
  for (Eigen::Index j = 0; j < joint_count; ++j) {
    const double weight = weights.joints[static_cast<std::size_t>(j)];
    const Eigen::Vector3d joint = skeleton.joints.row(j).transpose() - mean;
    add(joint, weight);
    weighted_.push_back((weight * Eigen::Vector2d(joint.x(), joint.z())).cast<float>());
  }
  if (weights.velocity == 0.0) return;
  for (Eigen::Index j = 0; j < joint_count; ++j) {
    add(skeleton.velocities.row(j).transpose(),
        weights.velocity * weights.joints[static_cast<std::size_t>(j)]);
  }
}

SkeletonTable::SkeletonTable(std::size_t skeleton_count, std::size_t joint_count)
    : joint_count_(joint_count),
      block_count_((skeleton_count + lanes - 1) / lanes),
      values_(block_count_ * lanes * joint_count * 6) {}

float* SkeletonTable::coordinates(std::size_t skeleton_idx, std::size_t row_idx) {
  return values_.data() + ((skeleton_idx / lanes) * 2 * joint_count_ + row_idx) * 3 * lanes +
         skeleton_idx % lanes;
}

void SkeletonTable::set(std::size_t skeleton_idx, const MovingSkeleton& skeleton,
                        const std::vector<double>& weights) {
  const Eigen::Vector3d mean = ground_mean(skeleton.joints, weights);
  const auto write = [](float* at, const Eigen::Vector3d& value) {
    for (int axis = 0; axis < 3; ++axis) {
      at[static_cast<std::size_t>(axis) * lanes] = static_cast<float>(value[axis]);
    }
  };
  for (std::size_t j = 0; j < joint_count_; ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    write(coordinates(skeleton_idx, j), skeleton.joints.row(row).transpose() - mean);
    write(coordinates(skeleton_idx, joint_count_ + j), skeleton.velocities.row(row).transpose());
  }
}

SkeletonTable SkeletonTable::recentred(const std::vector<double>& weights) const {
  SkeletonTable result = *this;
  const auto rows = static_cast<Eigen::Index>(joint_count_);
  MovingSkeleton skeleton{.joints = Eigen::MatrixX3d(rows, 3), .velocities = Eigen::MatrixX3d(rows, 3)};
  const auto read = [](const float* at) { return Eigen::RowVector3d(at[0], at[lanes], at[2 * lanes]); };
  for (std::size_t i = 0; i < block_count_ * lanes; ++i) {
    for (std::size_t j = 0; j < joint_count_; ++j) {
      const auto row = static_cast<Eigen::Index>(j);
      skeleton.joints.row(row) = read(result.coordinates(i, j));
      skeleton.velocities.row(row) = read(result.coordinates(i, joint_count_ + j));
    }
    result.set(i, skeleton, weights);
  }
  return result;
}

void SkeletonTable::compare(const QuerySkeleton& query, std::size_t block_idx, float* dissimilarities) const {
  using Lanes = Eigen::Array<float, static_cast<int>(lanes), 1>;
  using Map = Eigen::Map<const Lanes, Eigen::Aligned16>;
  const float* const block = values_.data() + block_idx * joint_count_ * 6 * lanes;
  // The joints of the table are relative to their means and those of the query too: two sums of products are
  // all there is to the rotation.
  Lanes along = Lanes::Zero();
  Lanes across = Lanes::Zero();
  const float* at = block;
  for (const Eigen::Vector2f& q : query.weighted_) {
    const Map x(at);
    const Map z(at + 2 * lanes);
    along += q.x() * x + q.y() * z;
    across += q.x() * z - q.y() * x;
    at += 3 * lanes;
  }
  const Lanes length = (along.square() + across.square()).sqrt();
  const Lanes c = (length > 0.0F).select(along / length, 1.0F);
  const Lanes s = (length > 0.0F).select(across / length, 0.0F);
  Lanes sum = Lanes::Zero();
  at = block;
  for (const QuerySkeleton::Term& q : query.terms_) {
    const Map x(at);
    const Map y(at + lanes);
    const Map z(at + 2 * lanes);
    const Lanes dx = c * x + s * z - q.x;
    const Lanes dy = y - q.y;
    const Lanes dz = c * z - s * x - q.z;
    sum += q.weight * (dx.square() + dy.square() + dz.square()).sqrt();
    at += 3 * lanes;
  }
  Eigen::Map<Lanes>(dissimilarities, static_cast<Eigen::Index>(lanes)) = sum;
}

}  // namespace reprise::path_detail
