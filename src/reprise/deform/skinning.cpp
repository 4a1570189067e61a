// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/skinning.h"

#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/math/dual_quaternion.h"

namespace reprise {
namespace {

using Eigen::Vector3d;

constexpr std::size_t grain = 1024;

// Calls `carry(row of weights, x)` for every vertex.
template <typename Carry>
void for_each_vertex(const PositionsView& source, const Carry& carry_vertex, PositionsRef skinned) {
  parallel_for(
      0, static_cast<std::size_t>(source.rows()),
      [&](std::size_t v) {
        const auto row = static_cast<Eigen::Index>(v);
        const Vector3d x = source.row(row).cast<double>().transpose();
        skinned.row(row) = carry_vertex(row, x).template cast<float>().transpose();
      },
      grain);
}

void skin_linear(const SkinWeights& weights, const std::vector<BoneMotion>& motions,
                 const PositionsView& source, PositionsRef skinned) {
  using Matrix34 = Eigen::Matrix<double, 3, 4>;
  std::vector<Matrix34> bones(motions.size());
  for (std::size_t j = 0; j < motions.size(); ++j) {
    bones[j] << motions[j].rotation.toRotationMatrix(), motions[j].translation;
  }
  for_each_vertex(
      source,
      [&](Eigen::Index v, const Vector3d& x) -> Vector3d {
        Matrix34 blend = Matrix34::Zero();
        for (SkinWeights::InnerIterator it(weights, v); it; ++it) {
          blend += it.value() * bones[static_cast<std::size_t>(it.col())];
        }
        return blend * x.homogeneous();
      },
      skinned);
}

void skin_dual_quaternion(const SkinWeights& weights, const std::vector<BoneMotion>& motions,
                          const PositionsView& source, PositionsRef skinned) {
  std::vector<DualQuaternion> bones(motions.size());
  for (std::size_t j = 0; j < motions.size(); ++j) {
    bones[j] = dual_quaternion(motions[j].rotation, motions[j].translation);
  }
  for_each_vertex(
      source,
      [&](Eigen::Index v, const Vector3d& x) -> Vector3d {
        SkinWeights::InnerIterator strongest(weights, v);
        for (SkinWeights::InnerIterator it(weights, v); it; ++it) {
          if (it.value() > strongest.value()) strongest = it;
        }
        DualQuaternionSum sum(strongest.value(), bones[static_cast<std::size_t>(strongest.col())]);
        for (SkinWeights::InnerIterator it(weights, v); it; ++it) {
          if (it.col() != strongest.col()) sum.add(it.value(), bones[static_cast<std::size_t>(it.col())]);
        }
        return carry(sum.sum(), x);
      },
      skinned);
}

}  // namespace

void skin(const SkinWeights& weights, const Skeleton& skeleton, const PositionsView& source,
          const SkeletonPose& source_pose, const SkeletonPose& target_pose, Skinning skinning,
          PositionsRef skinned) {
  validate(source_pose, skeleton, "source");
  validate(target_pose, skeleton, "target");
  validate(weights, static_cast<std::int32_t>(source.rows()), skeleton.size());
  if (skinned.rows() != source.rows()) {
    throw InvalidArgument(
        fmt::format("skinning: the result has {} vertices, the source {}", skinned.rows(), source.rows()));
  }
  const std::vector<BoneMotion> motions = bone_motions(source_pose, target_pose);
  switch (skinning) {
    case Skinning::linear:
      return skin_linear(weights, motions, source, skinned);
    case Skinning::dual_quaternion:
      return skin_dual_quaternion(weights, motions, source, skinned);
  }
}

std::vector<BoneMotion> bone_motions(const SkeletonPose& source, const SkeletonPose& target) {
  std::vector<BoneMotion> motions;
  motions.reserve(source.rotation.size());
  for (std::size_t j = 0; j < source.rotation.size(); ++j) {
    // The rest positions cancel: the joint itself goes from its place in the source to that in the target.
    const Eigen::Quaterniond rotation = target.rotation[j] * source.rotation[j].conjugate();
    motions.push_back({rotation, target.position[j] - rotation * source.position[j]});
  }
  return motions;
}

void validate(const SkeletonPose& pose, const Skeleton& skeleton, const char* name) {
  const std::size_t count = skeleton.joints.size();
  if (pose.rotation.size() != count || pose.position.size() != count) {
    throw InvalidArgument(
        fmt::format("the {} pose has {} rotations and {} positions; expected {}, one a joint", name,
                    pose.rotation.size(), pose.position.size(), count));
  }
  for (std::size_t j = 0; j < count; ++j) {
    if (!pose.position[j].allFinite() || !(std::abs(pose.rotation[j].norm() - 1.0) <= 1e-6)) {
      throw InvalidArgument(fmt::format("joint '{}' of the {} pose has no finite position and unit rotation",
                                        skeleton.joints[j].name, name));
    }
  }
}

}  // namespace reprise
