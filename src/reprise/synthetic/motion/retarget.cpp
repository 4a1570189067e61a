// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/motion/retarget.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "reprise/core/error.h"
#include "reprise/math/ground_transform.h"
#include "reprise/synthetic/motion/foot_contacts.h"
#include "reprise/synthetic/motion/foot_plan.h"
#include "reprise/synthetic/motion/foot_planting.h"
#include "reprise/synthetic/motion/retarget_map.h"
#include "reprise/synthetic/motion/retarget_pose.h"

namespace reprise {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

constexpr double lead_in_duration = 1.5;  // seconds

void check(const SkeletalMotion& motion, const Skeleton& performer) {
  validate(performer);
  validate(motion.skeleton);
  if (performer.joint_idx("pelvis") != 0) {
    throw InvalidArgument(
        fmt::format("the performer's first joint is '{}'; expected 'pelvis'", performer.joints.front().name));
  }
  if (motion.frames.empty()) throw InvalidArgument(fmt::format("motion '{}' has no frames", motion.name));
  if (!(motion.frames_per_second > 0.0) || !std::isfinite(motion.frames_per_second)) {
    throw InvalidArgument(fmt::format("motion '{}': {} frames per second; expected a positive, finite rate",
                                      motion.name, motion.frames_per_second));
  }
  for (std::size_t f = 0; f < motion.frames.size(); ++f) {
    const SkeletonPose& pose = motion.frames[f];
    const std::size_t joints = motion.skeleton.joints.size();
    bool good = pose.rotation.size() == joints && pose.position.size() == joints;
    for (std::size_t j = 0; good && j < joints; ++j) {
      good = pose.position[j].allFinite() && pose.rotation[j].coeffs().allFinite();
    }
    if (!good) {
      throw InvalidArgument(
          fmt::format("motion '{}' frame {}: expected a finite pose of {} joints", motion.name, f, joints));
    }
  }
}

std::array<retargeting::FootTrack, 2> foot_tracks(const SkeletalMotion& motion,
                                                  const retargeting::PoseTransfer& transfer) {
  std::array<retargeting::FootTrack, 2> tracks;
  for (const SkeletonPose& pose : motion.frames) {
    for (const int side : {0, 1}) {
      retargeting::FootTrack& track = tracks[static_cast<std::size_t>(side)];
      track.ankle.emplace_back(transfer.scale() * transfer.ankle(pose, side));
      track.toe.emplace_back(transfer.scale() * transfer.toe(pose, side));
    }
  }
  return tracks;
}

void level_ground(SkeletalMotion& motion, const Eigen::Vector2d& slope) {
  for (SkeletonPose& pose : motion.frames) {
    for (Vector3d& position : pose.position) {
      position.y() -= slope.x() * position.x() + slope.y() * position.z();
    }
  }
}

double facing(const Quaterniond& rotation) {
  const Vector3d ahead = rotation * Vector3d::UnitZ();
  return std::atan2(ahead.x(), ahead.z());
}

// Where the body of a pose faces: hips and chest turn against each other in a stride.
double facing(const Skeleton& skeleton, const SkeletonPose& pose) {
  const double hips = facing(pose.rotation[static_cast<std::size_t>(skeleton.joint_idx("pelvis"))]);
  const double chest = facing(pose.rotation[static_cast<std::size_t>(skeleton.joint_idx("chest"))]);
  return hips + 0.5 * wrap_angle(chest - hips);
}

// First frame over the origin, facing +Z.
void place_at_origin(SkeletalMotion& motion) {
  const SkeletonPose& first = motion.frames.front();
  const double yaw = -facing(motion.skeleton, first);
  const Vector3d start(first.position[0].x(), 0.0, first.position[0].z());
  const Quaterniond turn(Eigen::AngleAxisd(yaw, Vector3d::UnitY()));
  for (SkeletonPose& pose : motion.frames) {
    for (Vector3d& position : pose.position) position = turn * (position - start);
    for (Quaterniond& rotation : pose.rotation) rotation = (turn * rotation).normalized();
  }
}

double lowest_sole(const Skeleton& skeleton, const SkeletonPose& pose) {
  double lowest = 1e9;
  for (const int side : {0, 1}) {
    const std::string name = side == 0 ? "left_" : "right_";
    const motion::FootShape shape = motion::foot_shape(skeleton, side);
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
  check(motion, performer);
  constexpr double greatest_rate = 1000.0;
  if (!(options.frames_per_second > 0.0) || !(options.frames_per_second <= greatest_rate)) {
    throw InvalidArgument(
        fmt::format("cannot retarget to {} frames per second; expected a rate above 0 and "
                    "at most {}",
                    options.frames_per_second, greatest_rate));
  }
  const std::vector<int> source_of = retargeting::map_joints(performer, motion, options.joint_map);
  SkeletalMotion source = retargeting::upright(motion, source_of, performer);
  if (const std::size_t strays = retargeting::frames_before_motion(source, source_of, performer);
      strays > 0) {
    spdlog::info("motion '{}' begins with {} frames of another pose, which are left out", motion.name,
                 strays);
    source.frames.erase(source.frames.begin(), source.frames.begin() + static_cast<std::ptrdiff_t>(strays));
  }
  const retargeting::PoseTransfer transfer(performer, source.skeleton, source_of);
  level_ground(source, retargeting::ground_slope(foot_tracks(source, transfer), source.frames_per_second));
  // In frames of the motion's own rate: the faster, the better contacts are timed.
  std::array<std::vector<bool>, 2> contacts;
  double source_ankle = 0.0;
  const std::array<retargeting::FootTrack, 2> tracks = foot_tracks(source, transfer);
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    contacts[side] = retargeting::detect_contacts(tracks[side], source.frames_per_second);
    source_ankle += 0.5 * retargeting::standing_ankle_height(tracks[side]);
  }

  PerformerClip clip;
  const std::vector<SkeletonPose> sampled = retargeting::sample(source, options.frames_per_second);
  clip.motion = {motion.name, performer, options.frames_per_second, {}};
  const double own_ankle =
      0.5 * (motion::foot_shape(performer, 0).ankle.y() + motion::foot_shape(performer, 1).ankle.y());
  for (std::size_t k = 0; k < sampled.size(); ++k) {
    const SkeletonPose& pose = sampled[k];
    const std::vector<Quaterniond> rotations = transfer.rotations(pose);
    Vector3d hips = transfer.scale() * transfer.hips(pose);
    hips.y() += own_ankle - source_ankle;
    clip.motion.frames.push_back(
        pose_from_rotations(performer, rotations, hips - rotations[0] * transfer.hips_from_pelvis()));
    const double at = static_cast<double>(k) * source.frames_per_second / options.frames_per_second;
    const auto frame = std::min(static_cast<std::size_t>(std::lround(at)), source.frames.size() - 1);
    clip.contacts.push_back({contacts[0][frame], contacts[1][frame]});
  }
  place_at_origin(clip.motion);
  if (options.plant_feet) retargeting::plant_feet(clip.motion, clip.contacts);

  clip.lead_in = static_cast<int>(std::lround(lead_in_duration * options.frames_per_second));
  std::vector<SkeletonPose> frames = lead_in(clip.motion, clip.lead_in);
  clip.motion.frames.insert(clip.motion.frames.begin(), frames.begin(), frames.end());
  const FootContacts first = clip.contacts.front();
  clip.contacts.insert(clip.contacts.begin(), frames.size(), first);
  return clip;
}

}  // namespace reprise
