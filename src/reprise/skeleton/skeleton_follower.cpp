// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/skeleton/skeleton_follower.h"

#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/skeleton/bone_fits.h"

namespace reprise {

using skeleton::fit_rigid_robustly;
using skeleton::LabelledBone;
using skeleton::Points;
using skeleton::RigidFit;

struct SkeletonFollower::Impl {
  Skeleton skeleton;
  std::vector<LabelledBone> bones;  // `weights`: by area and by how steady each vertex was
  std::optional<skeleton::PoseFromFits> pose_from_fits;
  std::vector<double> residuals;  // one a vertex, metres
  bool at_centroids = false;

  static RigidFit fit(const LabelledBone& bone, const Points& points) {
    // Far below what a capture tells apart.
    constexpr double close = 2e-5;  // metres
    return fit_rigid_robustly(bone.rest, points, bone.weights, close);
  }
};

SkeletonFollower::SkeletonFollower(const std::vector<MeshSequence>& clips, const Markup& markup,
                                   const SkeletonExtractionOptions& options) {
  if (clips.empty()) throw InvalidArgument("there is no clip to learn from");
  for (const MeshSequence& clip : clips) skeleton::check_input(clip, markup, options);
  auto impl = std::make_unique<Impl>();
  impl->skeleton = markup.skeleton;
  impl->bones = skeleton::label_bones(*clips.front().topology(), markup, options.fewest_vertices);
  skeleton::check_followed(markup.skeleton, impl->bones, options.fewest_vertices);
  impl->residuals.assign(clips.front().vertex_count(), std::numeric_limits<double>::infinity());
  impl->at_centroids = options.position == SkeletonExtractionOptions::JointPosition::centroid;
  impl->pose_from_fits.emplace(markup.skeleton, impl->bones);
  if (impl->at_centroids) skeleton::put_joints_at_centroids(impl->bones, impl->skeleton);

  std::size_t frames = 0;
  for (const MeshSequence& clip : clips) frames += clip.frame_count();
  parallel_for(0, impl->bones.size(), [&](std::size_t j) {
    LabelledBone& bone = impl->bones[j];
    if (!bone.is_followed) return;
    const auto squared_residuals = [&] {
      std::vector<double> residuals(bone.vertices.size(), 0.0);
      for (const MeshSequence& clip : clips) {
        for (std::size_t f = 0; f < clip.frame_count(); ++f) {
          const Points points = skeleton::gather(clip.frame(f), bone.vertices);
          skeleton::add_residuals(bone, points, Impl::fit(bone, points), residuals);
        }
      }
      return residuals;
    };
    bone.weights = skeleton::steady_weights(bone, squared_residuals());
    const std::vector<double> residuals = squared_residuals();
    for (std::size_t i = 0; i < residuals.size(); ++i) {
      impl->residuals[static_cast<std::size_t>(bone.vertices[i])] =
          std::sqrt(residuals[i] / static_cast<double>(frames));
    }
  });
  impl_ = std::move(impl);
}

SkeletonFollower::~SkeletonFollower() = default;
SkeletonFollower::SkeletonFollower(SkeletonFollower&&) noexcept = default;

const Skeleton& SkeletonFollower::skeleton() const {
  return impl_->skeleton;
}

const std::vector<double>& SkeletonFollower::residuals() const {
  return impl_->residuals;
}

SkeletonPose SkeletonFollower::pose(const PositionsView& frame) const {
  if (frame.rows() != static_cast<Eigen::Index>(impl_->residuals.size())) {
    throw InvalidArgument(fmt::format("a frame of {} vertices; the clips that taught the skeleton have {}",
                                      frame.rows(), impl_->residuals.size()));
  }
  const std::vector<LabelledBone>& bones = impl_->bones;
  std::vector<RigidFit> fits(bones.size());
  std::vector<const RigidFit*> followed(bones.size(), nullptr);
  for (std::size_t j = 0; j < bones.size(); ++j) {
    if (!bones[j].is_followed) continue;
    fits[j] = Impl::fit(bones[j], skeleton::gather(frame, bones[j].vertices));
    followed[j] = &fits[j];
  }
  SkeletonPose pose = (*impl_->pose_from_fits)(followed);
  if (impl_->at_centroids) skeleton::put_joints_at_centroids(bones, frame, pose);
  return pose;
}

}  // namespace reprise
