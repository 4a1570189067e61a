// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/posed_vertices.h"

#include <algorithm>
#include <utility>

#include "reprise/math/dual_quaternion.h"

namespace reprise {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Matrix3d cross_matrix(const Vector3d& a) {
  Matrix3d result;
  result << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return result;
}

Quaterniond pure(const Vector3d& v) {
  return {0.0, v.x(), v.y(), v.z()};
}

Quaterniond real_part(const DualQuaternion& d) {
  return {d[0], d[1], d[2], d[3]};
}

Quaterniond dual_part(const DualQuaternion& d) {
  return {d[4], d[5], d[6], d[7]};
}

DualQuaternion joined(const Quaterniond& real, const Quaterniond& dual) {
  DualQuaternion result;
  result << real.w(), real.vec(), dual.w(), dual.vec();
  return result;
}

std::vector<DualQuaternion> duals_of(const std::vector<BoneMotion>& bones) {
  std::vector<DualQuaternion> result;
  result.reserve(bones.size());
  for (const BoneMotion& bone : bones) {
    result.push_back(dual_quaternion(bone.rotation, bone.translation));
  }
  return result;
}

// Derivative of `carry(sum, x)` by the sum. With its quaternions b and e,
//   carry = vec(b x b* + 2 e b*) / |b|^2.
Eigen::Matrix<double, 3, 8> derivative_of_carry(const DualQuaternion& sum, const Vector3d& x) {
  const Quaterniond b = real_part(sum), e = dual_part(sum);
  const double inverse_norm2 = 1.0 / b.squaredNorm();
  const Vector3d carried = carry(sum, x);
  const Quaterniond x_b = pure(x) * b.conjugate();
  Eigen::Matrix<double, 3, 8> result;
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector4d unit = Eigen::Vector4d::Unit(k);
    const Quaterniond d(unit[0], unit[1], unit[2], unit[3]);
    // vec(d x b* + b x d*) = 2 vec(d x b*).
    const Vector3d numerator = 2.0 * (d * x_b).vec() + 2.0 * (e * d.conjugate()).vec();
    result.col(k) = inverse_norm2 * (numerator - 2.0 * sum[k] * carried);
    result.col(4 + k) = inverse_norm2 * 2.0 * (d * b.conjugate()).vec();
  }
  return result;
}

}  // namespace

PosedVertices::PosedVertices(const SkinWeights& weights, const Skeleton& skeleton,
                             const PositionsView& source, const SkeletonPose& source_pose,
                             std::span<const std::int32_t> vertices, Skinning skinning)
    : source_pose_(source_pose), skinning_(skinning) {
  for (const std::int32_t v : vertices) {
    std::vector<std::pair<double, int>> shares;
    for (SkinWeights::InnerIterator it(weights, v); it; ++it) {
      if (it.value() > 0.0) shares.emplace_back(-it.value(), static_cast<int>(it.col()));
    }
    std::sort(shares.begin(), shares.end());
    Vertex vertex{.source = source.row(v).cast<double>().transpose()};
    for (const auto& [share, bone] : shares) {
      vertex.bones.push_back(static_cast<std::size_t>(bone));
      vertex.weights.push_back(-share);
      for (int j = bone; j >= 0; j = skeleton.joints[static_cast<std::size_t>(j)].parent) {
        vertex.joints.push_back(j);
      }
    }
    std::sort(vertex.joints.begin(), vertex.joints.end());
    vertex.joints.erase(std::unique(vertex.joints.begin(), vertex.joints.end()), vertex.joints.end());
    for (const std::size_t bone : vertex.bones) {
      std::vector<std::size_t>& movers = vertex.movers.emplace_back();
      for (int j = static_cast<int>(bone); j >= 0; j = skeleton.joints[static_cast<std::size_t>(j)].parent) {
        const auto found = std::lower_bound(vertex.joints.begin(), vertex.joints.end(), j);
        movers.push_back(static_cast<std::size_t>(found - vertex.joints.begin()));
      }
    }
    vertices_.push_back(std::move(vertex));
  }
}

std::vector<Vector3d> PosedVertices::positions(const SkeletonPose& pose) const {
  const std::vector<BoneMotion> bones = bone_motions(source_pose_, pose);
  std::vector<Vector3d> result;
  result.reserve(vertices_.size());
  if (skinning_ == Skinning::linear) {
    for (const Vertex& vertex : vertices_) {
      Vector3d sum = Vector3d::Zero();
      for (std::size_t k = 0; k < vertex.bones.size(); ++k) {
        const BoneMotion& bone = bones[vertex.bones[k]];
        sum += vertex.weights[k] * (bone.rotation * vertex.source + bone.translation);
      }
      result.push_back(sum);
    }
  } else {
    const std::vector<DualQuaternion> duals = duals_of(bones);
    for (const Vertex& vertex : vertices_) {
      DualQuaternionSum sum(vertex.weights[0], duals[vertex.bones[0]]);
      for (std::size_t k = 1; k < vertex.bones.size(); ++k)
        sum.add(vertex.weights[k], duals[vertex.bones[k]]);
      result.push_back(carry(sum.sum(), vertex.source));
    }
  }
  return result;
}

void PosedVertices::derivatives(const SkeletonPose& pose, std::vector<std::vector<Motion>>& motions) const {
  const std::vector<BoneMotion> bones = bone_motions(source_pose_, pose);
  const std::vector<DualQuaternion> duals = duals_of(bones);
  motions.resize(vertices_.size());
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    motions[i].resize(vertices_[i].joints.size());
    if (skinning_ == Skinning::linear) {
      derivatives_linear(vertices_[i], bones, pose, motions[i]);
    } else {
      derivatives_dual(vertices_[i], duals, pose, motions[i]);
    }
  }
}

void PosedVertices::derivatives_linear(const Vertex& vertex, const std::vector<BoneMotion>& bones,
                                       const SkeletonPose& pose, std::vector<Motion>& motions) const {
  // What hangs on a joint: its share m and first moment u. A turn w moves it by w x (u - m p).
  std::vector<double> share(vertex.joints.size(), 0.0);
  std::vector<Vector3d> moment(vertex.joints.size(), Vector3d::Zero());
  for (std::size_t k = 0; k < vertex.bones.size(); ++k) {
    const BoneMotion& bone = bones[vertex.bones[k]];
    const Vector3d place = bone.rotation * vertex.source + bone.translation;
    for (const std::size_t mover : vertex.movers[k]) {
      share[mover] += vertex.weights[k];
      moment[mover] += vertex.weights[k] * place;
    }
  }
  for (std::size_t a = 0; a < motions.size(); ++a) {
    const Vector3d& joint = pose.position[static_cast<std::size_t>(vertex.joints[a])];
    motions[a] = {.turn = -cross_matrix(moment[a] - share[a] * joint),
                  .shift = share[a] * Matrix3d::Identity()};
  }
}

void PosedVertices::derivatives_dual(const Vertex& vertex, const std::vector<DualQuaternion>& duals,
                                     const SkeletonPose& pose, std::vector<Motion>& motions) const {
  // A motion with angular velocity w and velocity v at the origin changes a dual quaternion d by (w, v) d /
  // 2, and so the part of the sum that hangs on a joint.
  std::vector<DualQuaternion> part(vertex.joints.size(), DualQuaternion::Zero());
  DualQuaternionSum sum(vertex.weights[0], duals[vertex.bones[0]]);
  for (std::size_t k = 0; k < vertex.bones.size(); ++k) {
    const DualQuaternion& bone = duals[vertex.bones[k]];
    if (k > 0) sum.add(vertex.weights[k], bone);
    const double weight = sum.sign(bone) * vertex.weights[k];
    for (const std::size_t mover : vertex.movers[k]) part[mover] += weight * bone;
  }
  const Eigen::Matrix<double, 3, 8> D = derivative_of_carry(sum.sum(), vertex.source);
  for (std::size_t a = 0; a < motions.size(); ++a) {
    const Quaterniond b = real_part(part[a]), e = dual_part(part[a]);
    const Vector3d& joint = pose.position[static_cast<std::size_t>(vertex.joints[a])];
    const Quaterniond none(0.0, 0.0, 0.0, 0.0);
    for (int axis = 0; axis < 3; ++axis) {
      const Quaterniond unit = pure(Vector3d::Unit(axis));
      const Quaterniond velocity = pure(joint.cross(Vector3d::Unit(axis)));
      const Quaterniond dual_change((unit * e).coeffs() + (velocity * b).coeffs());
      motions[a].turn.col(axis) = 0.5 * D * joined(unit * b, dual_change);
      motions[a].shift.col(axis) = 0.5 * D * joined(none, unit * b);
    }
  }
}

}  // namespace reprise
