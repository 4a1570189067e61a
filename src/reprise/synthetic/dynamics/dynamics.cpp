// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/dynamics/dynamics.h"

#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/core/parallel.h"
#include "reprise/synthetic/dynamics/layer_player.h"

namespace reprise {

namespace {

constexpr double ease_seconds = 1.0;  // from rest to the first pose: cloth drapes without catching in arms

// The pose at rest, standing and facing as the root of `pose` does.
SkeletonPose rest_under(const Skeleton& skeleton, const SkeletonPose& pose) {
  SkeletonPose rest = rest_pose(skeleton);
  const Eigen::Vector3d ahead = pose.rotation[0] * Eigen::Vector3d::UnitZ();
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(std::atan2(ahead.x(), ahead.z()), Eigen::Vector3d::UnitY()));
  const Eigen::Vector3d root = rest.position[0];
  for (std::size_t j = 0; j < rest.position.size(); ++j) {
    Eigen::Vector3d place = turn * (rest.position[j] - root);
    place += Eigen::Vector3d(pose.position[0].x(), root.y(), pose.position[0].z());
    rest.position[j] = place;
    rest.rotation[j] = turn * rest.rotation[j];
  }
  return rest;
}

}  // namespace

void validate(const DynamicsOptions& options) {
  if (options.substeps < 1 || options.substeps > 1000)
    throw InvalidArgument(fmt::format("substeps: expected 1 to 1000, found {}", options.substeps));
  if (!(options.cloth_thickness >= 0.0 && options.cloth_thickness <= 0.02))
    throw InvalidArgument(
        fmt::format("cloth thickness: expected 0 to 0.02 m, found {} m", options.cloth_thickness));
  if (!(std::abs(options.wind) <= 30.0))
    throw InvalidArgument(fmt::format("wind: expected -30 to 30 m/s, found {} m/s", options.wind));
}

void simulate(
    const DressedBody& body, const PerformerClip& clip, const DynamicsOptions& options,
    const std::function<void(std::size_t frame_idx, const std::vector<Points>& layer_points)>& frame) {
  validate(options);
  const std::vector<SkeletonPose>& frames = clip.motion.frames;
  if (frames.empty()) throw InvalidArgument(fmt::format("clip \"{}\" has no frames", clip.motion.name));
  const double rate = clip.motion.frames_per_second;
  const auto ease = static_cast<std::size_t>(std::ceil(ease_seconds * rate));
  const SkeletonPose rest = rest_under(body.skeleton(), frames.front());
  const auto skinned = [&](std::size_t step) {
    const double part = static_cast<double>(step) / static_cast<double>(ease);
    const SkeletonPose pose =
        step < ease ? interpolate(body.skeleton(), rest, frames.front(), part * part * (3.0 - 2.0 * part))
                    : frames[step - ease];
    std::vector<Points> layers(body.layers().size());
    parallel_for(0, layers.size(), [&](std::size_t l) { layers[l] = body.skin(l, pose); });
    return layers;
  };

  dynamics::LayerPlayer player(body.layers(), options, rate);
  std::vector<Points> after = skinned(0), before = after;
  player.start(after);
  const std::size_t steps = ease + frames.size();
  for (std::size_t step = 0; step < steps; ++step) {
    throw_if_interrupted();
    before.swap(after);
    if (step + 1 < steps) {
      after = skinned(step + 1);
    } else {  // beyond the end everything goes on as it went
      for (std::size_t l = 0; l < after.size(); ++l) after[l] = 2.0 * before[l] - after[l];
    }
    player.advance(after);
    const std::size_t first = ease + static_cast<std::size_t>(clip.lead_in);
    if (step >= first) frame(step - first, player.points());
  }
}

}  // namespace reprise
