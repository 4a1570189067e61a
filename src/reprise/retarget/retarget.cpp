// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/retarget/retarget.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "reprise/core/error.h"
#include "reprise/retarget/foot_contacts.h"
#include "reprise/retarget/foot_planting.h"
#include "reprise/retarget/foot_shape.h"
#include "reprise/retarget/pose_transfer.h"

namespace reprise {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

using AnkleShifts = std::vector<std::array<Vector3d, 2>>;

void check(const SkeletalMotion& motion, const RetargetOptions& options) {
  validate(motion.skeleton);
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
  constexpr double greatest_rate = 1000.0;
  if (!(options.frames_per_second > 0.0) || !(options.frames_per_second <= greatest_rate)) {
    throw InvalidArgument(
        fmt::format("cannot retarget to {} frames per second; expected a rate above 0 and "
                    "at most {}",
                    options.frames_per_second, greatest_rate));
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

// First frame over the origin, facing +Z. Shifts turn with it.
GroundTransform place_at_origin(SkeletalMotion& motion, AnkleShifts& shifts) {
  const SkeletonPose& first = motion.frames.front();
  const double yaw = -facing(motion.skeleton, first);
  const Vector3d start(first.position[0].x(), 0.0, first.position[0].z());
  const Quaterniond turn(Eigen::AngleAxisd(yaw, Vector3d::UnitY()));
  for (SkeletonPose& pose : motion.frames) {
    for (Vector3d& position : pose.position) position = turn * (position - start);
    for (Quaterniond& rotation : pose.rotation) rotation = (turn * rotation).normalized();
  }
  for (auto& both : shifts) {
    for (Vector3d& shift : both) shift = turn * shift;
  }
  const Vector3d moved = -(turn * start);
  return {wrap_angle(yaw), {moved.x(), moved.z()}};
}

// A motion ready for transfer: upright, its floor level, without what does not belong to it.
struct Source {
  SkeletalMotion motion;
  std::vector<int> joint_of;  // of each standing joint, or -1
  std::size_t left_out = 0;
};

Source prepared(const SkeletalMotion& motion, const Skeleton& standing, const JointMap& map) {
  Source source;
  source.joint_of = retargeting::source_joints(standing, map, motion.skeleton);
  source.motion = retargeting::upright(motion, source.joint_of, standing);
  source.left_out = retargeting::frames_before_motion(source.motion, source.joint_of, standing);
  if (source.left_out > 0) {
    spdlog::info("motion '{}' begins with {} frames of another pose, which are left out", motion.name,
                 source.left_out);
    source.motion.frames.erase(source.motion.frames.begin(),
                               source.motion.frames.begin() + static_cast<std::ptrdiff_t>(source.left_out));
  }
  return source;
}

// Of the character's own joints those that the motion has, and which of the motion they are.
void pair_joints(RetargetedMotion& result, const StandingFigure& character, const Source& source,
                 std::vector<std::size_t>& theirs) {
  for (int j = 0; j < character.own().size(); ++j) {
    const std::string& name = character.own().joints[static_cast<std::size_t>(j)].name;
    for (const auto& [body, own] : character.map().joints) {
      if (own != name) continue;
      const int joint = source.joint_of[static_cast<std::size_t>(character.standing().joint_idx(body))];
      if (joint < 0) continue;
      result.source_joints.push_back(j);
      theirs.push_back(static_cast<std::size_t>(joint));
    }
  }
}

}  // namespace

RetargetedMotion retarget_motion(const SkeletalMotion& motion, const StandingFigure& character,
                                 const RetargetOptions& options) {
  check(motion, options);
  const std::string what = fmt::format("motion '{}'", motion.name);
  RetargetedMotion result;
  result.map = options.joint_map ? checked(*options.joint_map, motion.skeleton, what)
                                 : find_joints(motion.skeleton, what);
  const Skeleton& standing = character.standing();
  Source source = prepared(motion, standing, result.map);
  result.left_out = source.left_out;
  const retargeting::PoseTransfer transfer(standing, source.motion.skeleton, source.joint_of);
  const double source_rate = source.motion.frames_per_second;
  level_ground(source.motion, retargeting::ground_slope(foot_tracks(source.motion, transfer), source_rate));
  // In frames of the motion's own rate: the faster, the better contacts are timed.
  std::array<std::vector<bool>, 2> contacts;
  double source_ankle = 0.0;
  const std::array<retargeting::FootTrack, 2> tracks = foot_tracks(source.motion, transfer);
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    contacts[side] = retargeting::detect_contacts(tracks[side], source_rate);
    source_ankle += 0.5 * retargeting::standing_ankle_height(tracks[side]);
  }
  const double own_ankle =
      0.5 * (retargeting::foot_shape(standing, 0).ankle.y() + retargeting::foot_shape(standing, 1).ankle.y());

  result.scale = transfer.scale();
  std::vector<std::size_t> theirs;
  pair_joints(result, character, source, theirs);
  SkeletalMotion moved{motion.name, standing, options.frames_per_second, {}};
  AnkleShifts shifts;
  const std::vector<SkeletonPose> sampled = retargeting::sample(source.motion, options.frames_per_second);
  for (std::size_t k = 0; k < sampled.size(); ++k) {
    const SkeletonPose& pose = sampled[k];
    const std::vector<Quaterniond> rotations = transfer.rotations(pose);
    const Vector3d source_hips = transfer.hips(pose);
    Vector3d hips = transfer.scale() * source_hips;
    hips.y() += own_ankle - source_ankle;
    if (!options.scale_path) {
      hips.x() = source_hips.x();
      hips.z() = source_hips.z();
      // Feet that stand in the source stand here if the steps are as long as there, too.
      auto& both = shifts.emplace_back();
      for (const int side : {0, 1}) {
        Vector3d& shift = both[static_cast<std::size_t>(side)];
        shift = (1.0 - transfer.scale()) * (transfer.ankle(pose, side) - source_hips);
        shift.y() = 0.0;
      }
    }
    moved.frames.push_back(
        pose_from_rotations(standing, rotations, hips - rotations[0] * transfer.hips_from_pelvis()));
    const double at = static_cast<double>(k) * source_rate / options.frames_per_second;
    const auto frame = std::min(static_cast<std::size_t>(std::lround(at)), source.motion.frames.size() - 1);
    result.contacts.push_back({contacts[0][frame], contacts[1][frame]});

    Eigen::MatrixX3d& positions = result.source_positions.emplace_back(theirs.size(), 3);
    for (std::size_t i = 0; i < theirs.size(); ++i) {
      Vector3d position = pose.position[theirs[i]];
      position.y() += (own_ankle - source_ankle) / transfer.scale();
      positions.row(static_cast<Eigen::Index>(i)) = position.transpose();
    }
  }
  result.world_from_source = place_at_origin(moved, shifts);
  if (options.plant_feet) {
    retargeting::plant_feet(moved, result.contacts, shifts);
    // The hips may have gone along with the feet.
    const Vector3d& start = moved.frames.front().position[0];
    const Vector3d back(-start.x(), 0.0, -start.z());
    for (SkeletonPose& pose : moved.frames) {
      for (Vector3d& position : pose.position) position += back;
    }
    result.world_from_source.translation += Eigen::Vector2d(back.x(), back.z());
  }

  result.motion = {motion.name, character.own(), options.frames_per_second, {}};
  for (const SkeletonPose& pose : moved.frames) result.motion.frames.push_back(character.own_pose(pose));
  return result;
}

}  // namespace reprise
