// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/motion/retarget.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/retarget/foot_shape.h"

namespace reprise {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

constexpr double lead_in_duration = 1.5;  // seconds

double lowest_sole(const Skeleton& skeleton, const SkeletonPose& pose) {
  double lowest = 1e9;
  for (const int side : {0, 1}) {
    const std::string name = side == 0 ? "left_" : "right_";
    const retargeting::FootShape shape = retargeting::foot_shape(skeleton, side);
    const auto foot = pose.world_from_rest(skeleton, skeleton.joint_idx(name + "foot"));
    const auto toe = pose.world_from_rest(skeleton, skeleton.joint_idx(name + "toe"));
    lowest = std::min({lowest, (foot * shape.heel).y(), (toe * shape.toe_tip).y()});
  }
  return lowest;
}

// The pose as far before the first frame as `later` is after it: rotations and place are mirrored in it, so
// that velocities go through.
SkeletonPose mirrored_in_time(const Skeleton& skeleton, const SkeletonPose& first,
                              const SkeletonPose& later) {
  std::vector<Quaterniond> rotations;
  for (std::size_t j = 0; j < first.rotation.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    const auto local = [&](const SkeletonPose& pose) {
      return parent < 0 ? pose.rotation[j]
                        : Quaterniond(pose.rotation[static_cast<std::size_t>(parent)].conjugate() *
                                      pose.rotation[j]);
    };
    const Quaterniond mirrored = local(first) * local(later).conjugate() * local(first);
    rotations.push_back(parent < 0 ? mirrored.normalized()
                                   : (rotations[static_cast<std::size_t>(parent)] * mirrored).normalized());
  }
  return pose_from_rotations(skeleton, rotations, 2.0 * first.position[0] - later.position[0]);
}

double smoother_step(double u) {
  return u * u * u * (u * (6.0 * u - 15.0) + 10.0);
}

// From standing at rest into the first frame, with its velocity: frame k of the result is k - `count` frames
// from it.
std::vector<SkeletonPose> lead_in(const SkeletalMotion& motion, int count) {
  const Skeleton& skeleton = motion.skeleton;
  const SkeletonPose& first = motion.frames.front();
  const SkeletonPose standing = rest_pose(skeleton);
  constexpr double farthest = 0.1;  // seconds mirrored: what lies further behind tells little of the start
  const double duration = static_cast<double>(count) / motion.frames_per_second;
  const std::size_t ahead = std::min<std::size_t>(2, motion.frames.size() - 1);
  Vector3d velocity = Vector3d::Zero();
  if (ahead > 0) {
    velocity = (motion.frames[ahead].position[0] - first.position[0]) * motion.frames_per_second /
               static_cast<double>(ahead);
  }
  velocity.y() = 0.0;
  // A cubic that starts at rest and arrives with that velocity, and on the way never runs back.
  const Vector3d way = 0.4 * duration * velocity;
  const double sole = lowest_sole(skeleton, first);
  std::vector<SkeletonPose> frames;
  for (int k = 0; k < count; ++k) {
    const double u = static_cast<double>(k) / count;
    const double before = duration * (1.0 - u);
    const double mirrored = farthest * std::tanh(before / farthest) * motion.frames_per_second;
    const double last = static_cast<double>(motion.frames.size() - 1);
    const double at = std::min(mirrored, last);
    const auto frame = std::min(static_cast<std::size_t>(at), motion.frames.size() - 1);
    const SkeletonPose later = interpolate(skeleton, motion.frames[frame],
                                           motion.frames[std::min(frame + 1, motion.frames.size() - 1)],
                                           at - static_cast<double>(frame));
    const double weight = smoother_step(u);
    SkeletonPose pose = interpolate(skeleton, standing, mirrored_in_time(skeleton, first, later), weight);
    const double travelled = u * u * (3.0 - 2.0 * u);  // of the way
    const double arriving = u * u * (u - 1.0);         // of velocity times duration
    Vector3d root = first.position[0] - way + travelled * way + arriving * duration * velocity;
    root.y() = pose.position[0].y() - lowest_sole(skeleton, pose) + weight * sole;
    frames.push_back(pose_from_rotations(skeleton, pose.rotation, root));
  }
  return frames;
}

}  // namespace

PerformerClip retarget(const SkeletalMotion& motion, const Skeleton& performer,
                       const RetargetOptions& options) {
  validate(performer);
  if (performer.joint_idx("pelvis") != 0) {
    throw InvalidArgument(
        fmt::format("the performer's first joint is '{}'; expected 'pelvis'", performer.joints.front().name));
  }
  const StandingFigure figure(performer, {}, "the performer");
  RetargetedMotion retargeted = retarget_motion(motion, figure, options);
  PerformerClip clip;
  clip.motion = std::move(retargeted.motion);
  clip.contacts = std::move(retargeted.contacts);

  clip.lead_in = static_cast<int>(std::lround(lead_in_duration * options.frames_per_second));
  std::vector<SkeletonPose> frames = lead_in(clip.motion, clip.lead_in);
  clip.motion.frames.insert(clip.motion.frames.begin(), frames.begin(), frames.end());
  const FootContacts first = clip.contacts.front();
  clip.contacts.insert(clip.contacts.begin(), frames.size(), first);
  return clip;
}

}  // namespace reprise
