// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/skeleton/skeleton_extraction.h"

#include <algorithm>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/skeleton/bone_fits.h"

namespace reprise {
namespace {

using skeleton::fit_rigid_robustly;
using skeleton::gather;
using skeleton::LabelledBone;
using skeleton::Points;
using skeleton::RigidFit;

// How the bones move through a clip: for each joint one fit a frame, none if it is not followed.
using ClipFits = std::vector<std::vector<RigidFit>>;

std::vector<RigidFit> fit_bone(const MeshSequence& clip, const LabelledBone& bone) {
  std::vector<double> residuals(bone.vertices.size(), 0.0);
  for (std::size_t f = 0; f < clip.frame_count(); ++f) {
    const Points points = gather(clip.frame(f), bone.vertices);
    skeleton::add_residuals(bone, points, fit_rigid_robustly(bone.rest, points, bone.weights), residuals);
  }
  const std::vector<double> weights = skeleton::steady_weights(bone, residuals);
  std::vector<RigidFit> fits(clip.frame_count());
  for (std::size_t f = 0; f < clip.frame_count(); ++f) {
    fits[f] = fit_rigid_robustly(bone.rest, gather(clip.frame(f), bone.vertices), weights);
  }
  return fits;
}

ClipFits fit_bones(const MeshSequence& clip, const std::vector<LabelledBone>& bones) {
  ClipFits fits(bones.size());
  parallel_for(0, bones.size(), [&](std::size_t j) {
    if (bones[j].is_followed) fits[j] = fit_bone(clip, bones[j]);
  });
  return fits;
}

std::vector<LabelledBone> bones_to_follow(const MeshSequence& clip, const Markup& markup,
                                          const SkeletonExtractionOptions& options) {
  skeleton::check_input(clip, markup, options);
  std::vector<LabelledBone> bones = skeleton::label_bones(*clip.topology(), markup, options.fewest_vertices);
  skeleton::check_followed(markup.skeleton, bones, options.fewest_vertices);
  return bones;
}

}  // namespace

SkeletalMotion extract_skeleton(const MeshSequence& clip, const Markup& markup,
                                const SkeletonExtractionOptions& options) {
  const std::vector<LabelledBone> bones = bones_to_follow(clip, markup, options);
  const ClipFits fits = fit_bones(clip, bones);

  SkeletalMotion motion{.name = clip.name(),
                        .skeleton = markup.skeleton,
                        .frames_per_second = clip.frames_per_second(),
                        .frames = std::vector<SkeletonPose>(clip.frame_count())};
  const bool at_centroids = options.position == SkeletonExtractionOptions::JointPosition::centroid;
  if (at_centroids) skeleton::put_joints_at_centroids(bones, motion.skeleton);
  const skeleton::PoseFromFits pose_from_fits(markup.skeleton, bones);
  parallel_for(0, clip.frame_count(), [&](std::size_t f) {
    std::vector<const RigidFit*> of_frame(bones.size(), nullptr);
    for (std::size_t j = 0; j < bones.size(); ++j) {
      if (bones[j].is_followed) of_frame[j] = &fits[j][f];
    }
    motion.frames[f] = pose_from_fits(of_frame);
    if (at_centroids) skeleton::put_joints_at_centroids(bones, clip.frame(f), motion.frames[f]);
  });
  return motion;
}

std::vector<bool> followed_bones(const Topology& topology, const Markup& markup,
                                 const SkeletonExtractionOptions& options) {
  validate(markup, topology.vertex_count);
  std::vector<bool> followed;
  for (const LabelledBone& bone : skeleton::label_bones(topology, markup, options.fewest_vertices)) {
    followed.push_back(bone.is_followed);
  }
  return followed;
}

Skeleton refine_joints(const std::vector<MeshSequence>& clips, const Markup& markup,
                       const SkeletonExtractionOptions& options) {
  constexpr double farthest = 0.05;   // metres
  constexpr double stiffness = 0.02;  // of the old place, beside the squared turning of the bones (radians)
  const std::size_t joints = markup.skeleton.joints.size();
  // Normal equations of (R_parent - R_own) c = t_own - t_parent over all frames, about the old place.
  std::vector<Eigen::Matrix3d> A(joints, Eigen::Matrix3d::Zero());
  std::vector<Eigen::Vector3d> b(joints, Eigen::Vector3d::Zero());
  std::size_t frames = 0;
  for (const MeshSequence& clip : clips) {
    const ClipFits fits = fit_bones(clip, bones_to_follow(clip, markup, options));
    frames += clip.frame_count();
    for (std::size_t j = 0; j < joints; ++j) {
      const Joint& joint = markup.skeleton.joints[j];
      if (joint.parent < 0) continue;
      const std::vector<RigidFit>& own = fits[j];
      const std::vector<RigidFit>& parent = fits[static_cast<std::size_t>(joint.parent)];
      if (own.empty() || parent.empty()) continue;
      for (std::size_t f = 0; f < clip.frame_count(); ++f) {
        const Eigen::Matrix3d turning = parent[f].rotation - own[f].rotation;
        A[j] += turning.transpose() * turning;
        b[j] +=
            turning.transpose() * (own[f].carry(joint.rest_position) - parent[f].carry(joint.rest_position));
      }
    }
  }
  Skeleton refined = markup.skeleton;
  for (std::size_t j = 0; j < joints; ++j) {
    const Eigen::Matrix3d regularised = A[j] + stiffness *
                                                   static_cast<double>(std::max<std::size_t>(frames, 1)) *
                                                   Eigen::Matrix3d::Identity();
    Eigen::Vector3d step = regularised.ldlt().solve(b[j]);
    if (step.norm() > farthest) step *= farthest / step.norm();
    refined.joints[j].rest_position += step;
  }
  return refined;
}

PoseDifference pose_difference(const SkeletalMotion& motion, const std::vector<SkeletonPose>& truth) {
  if (motion.frames.size() != truth.size()) {
    throw InvalidArgument(
        fmt::format("{} frames cannot be compared with {} true ones", motion.frames.size(), truth.size()));
  }
  if (truth.empty()) throw InvalidArgument("there is no frame to compare");
  const std::size_t joints = motion.skeleton.joints.size();
  PoseDifference difference{.mean_distance = std::vector(joints, 0.0),
                            .max_distance = std::vector(joints, 0.0),
                            .mean_angle = std::vector(joints, 0.0),
                            .max_angle = std::vector(joints, 0.0)};
  for (std::size_t f = 0; f < truth.size(); ++f) {
    const SkeletonPose& found = motion.frames[f];
    if (truth[f].position.size() != joints || truth[f].rotation.size() != joints) {
      throw InvalidArgument(fmt::format("frame {} of the truth has {} joints; expected {}", f,
                                        truth[f].position.size(), joints));
    }
    for (std::size_t j = 0; j < joints; ++j) {
      const double distance = (found.position[j] - truth[f].position[j]).norm();
      const double angle = found.rotation[j].angularDistance(truth[f].rotation[j]);
      difference.mean_distance[j] += distance;
      difference.mean_angle[j] += angle;
      difference.max_distance[j] = std::max(difference.max_distance[j], distance);
      difference.max_angle[j] = std::max(difference.max_angle[j], angle);
    }
  }
  for (std::size_t j = 0; j < joints; ++j) {
    difference.mean_distance[j] /= static_cast<double>(truth.size());
    difference.mean_angle[j] /= static_cast<double>(truth.size());
    difference.distance += difference.mean_distance[j] / static_cast<double>(joints);
    difference.angle += difference.mean_angle[j] / static_cast<double>(joints);
  }
  return difference;
}

}  // namespace reprise
