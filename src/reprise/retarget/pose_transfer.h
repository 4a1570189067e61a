// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Poses of one skeleton on another whose rest pose and proportions differ. The "performer" is the skeleton of
// all body joints that stands at rest.

#pragma once

#include <string>
#include <vector>

#include "reprise/retarget/joint_map.h"
#include "reprise/sequence/skeleton.h"

namespace reprise::retargeting {

// For each joint of the performer the source's joint, or -1: it follows its neighbours. The map is checked.
std::vector<int> source_joints(const Skeleton& performer, const JointMap& map, const Skeleton& source);

// Up is +Y in the result: the axis along which the head is above the hips most of the time.
SkeletalMotion upright(const SkeletalMotion& motion, const std::vector<int>& source_of,
                       const Skeleton& performer);

// Number of frames at the beginning that do not belong to the motion: converters put a T-pose there, from
// which the arms then rush, faster than arms do, into the first real pose.
std::size_t frames_before_motion(const SkeletalMotion& motion, const std::vector<int>& source_of,
                                 const Skeleton& performer);

// Poses at another rate, frame k at k / rate seconds, as `resample()` has them. A much faster motion is
// smoothed over a hundredth of a second first: markers jitter between the frames that are kept.
std::vector<SkeletonPose> sample(const SkeletalMotion& motion, double frames_per_second);

// The performer's rotations from the motion's. A performer's bone has, in the motion's rest pose, the
// direction of the motion's bone: A takes its directions at rest there, and its rotation in a frame is
// R_motion A.
class PoseTransfer {
 public:
  // `source_of`: of `source_joints()`; `source`: upright. Throws `InvalidArgument` for legs without length.
  PoseTransfer(const Skeleton& performer, const Skeleton& source, std::vector<int> source_of);

  // Length of the performer's legs over those of the motion, by which places are scaled.
  double scale() const { return scale_; }
  // World rotations of the performer's joints.
  std::vector<Eigen::Quaterniond> rotations(const SkeletonPose& pose) const;
  // Middle between the hip joints, in the motion's units and place.
  Eigen::Vector3d hips(const SkeletonPose& pose) const;
  // The same point of the performer, seen from the pelvis joint, at rest.
  const Eigen::Vector3d& hips_from_pelvis() const { return hips_from_pelvis_; }
  // Place of the motion's ankle, and of its toe joint or, if it has none, of the point where the performer's
  // would be.
  Eigen::Vector3d ankle(const SkeletonPose& pose, int side) const;
  Eigen::Vector3d toe(const SkeletonPose& pose, int side) const;

 private:
  void align();
  void align_limb(const std::string& upper, const std::string& middle, const std::string& end);
  void align_foot(int side);
  void fill_trunk(std::vector<Eigen::Quaterniond>& rotations) const;
  int own(const std::string& name) const { return performer_.joint_idx(name); }
  // Rest position of the motion's joint for a performer's one.
  const Eigen::Vector3d& source_rest(int own_idx) const;
  const Eigen::Vector3d& own_rest(int own_idx) const {
    return performer_.joints[static_cast<std::size_t>(own_idx)].rest_position;
  }
  bool is_mapped(int own_idx) const { return source_of_[static_cast<std::size_t>(own_idx)] >= 0; }

  Skeleton performer_;
  Skeleton source_;
  std::vector<int> source_of_;
  std::vector<Eigen::Quaterniond> source_rest_from_own_;  // A, one a performer's joint
  double scale_ = 1.0;
  Eigen::Vector3d hips_from_pelvis_;
};

}  // namespace reprise::retargeting
