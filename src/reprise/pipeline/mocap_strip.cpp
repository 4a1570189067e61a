// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/mocap_strip.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/image_file.h"
#include "reprise/render/renderer.h"
#include "reprise/render/skeleton_surface.h"

namespace reprise {
namespace {

// The ground below the middle of a surface.
Eigen::RowVector3f ground_middle(const PositionsView& frame) {
  const Eigen::Vector3d middle = centroid(frame);
  return Eigen::RowVector3d(middle.x(), 0.0, middle.z()).cast<float>();
}

}  // namespace

SkeletalMotion query_in_place(const SkeletalMotion& query, const RetargetedMotion& target) {
  SkeletalMotion shown = query;
  shown.frames.erase(
      shown.frames.begin(),
      shown.frames.begin() + static_cast<std::ptrdiff_t>(std::min(target.left_out, query.frames.size() - 1)));
  shown = resample(shown, target.motion.frames_per_second);
  shown.frames.resize(target.motion.frames.size(), shown.frames.back());
  const Eigen::Quaterniond turn(target.world_from_source.rotation());
  for (SkeletonPose& pose : shown.frames) {
    for (Eigen::Vector3d& position : pose.position) {
      position = target.world_from_source * Eigen::Vector3d(target.scale * position);
    }
    for (Eigen::Quaterniond& rotation : pose.rotation) rotation = turn * rotation;
  }
  for (Joint& joint : shown.skeleton.joints) joint.rest_position *= target.scale;
  return shown;
}

SkeletalMotion frames_of(const SkeletalMotion& motion, const std::vector<std::size_t>& frames) {
  SkeletalMotion some{
      .name = motion.name, .skeleton = motion.skeleton, .frames_per_second = motion.frames_per_second};
  for (const std::size_t f : frames) some.frames.push_back(motion.frames.at(f));
  return some;
}

StripFrames::StripFrames(TopologyPtr topology, double frames_per_second, std::vector<std::size_t> frames)
    : strip_("strip", std::move(topology), frames.size(), frames_per_second), frames_(std::move(frames)) {}

void StripFrames::add(const Mesh& frame, std::size_t frame_idx) {
  if (taken_ == frames_.size() || frames_[taken_] != frame_idx) return;
  strip_.frame(taken_++) = frame.positions;
  colors_.insert(colors_.end(), frame.colors.begin(), frame.colors.end());
}

MeshSequence StripFrames::take() {
  strip_.set_colors(std::move(colors_));
  return std::move(strip_);
}

void draw_strip(const SkeletalMotion& query, const MeshSequence& frames, const std::filesystem::path& png) {
  if (query.frames.empty() || query.frames.size() != frames.frame_count()) {
    throw InvalidArgument(
        fmt::format("draw_strip: expected as many skeletons as frames, at least one, found {} and {}",
                    query.frames.size(), frames.frame_count()));
  }
  MeshSequence skeletons = skeleton_surface(query);
  MeshSequence surfaces = frames;
  for (MeshSequence* row : {&skeletons, &surfaces}) {
    for (std::size_t f = 0; f < row->frame_count(); ++f) {
      const Eigen::RowVector3f away = ground_middle(std::as_const(*row).frame(f));
      row->frame(f).rowwise() -= away;
    }
  }
  const RenderOptions view{.width = 240, .height = 400, .camera_yaw_degrees = 60.0, .zoom = 1.25};
  std::vector<Image> pictures;
  for (const MeshSequence* row : {&skeletons, &surfaces}) {
    SequenceRenderer renderer(*row, view);
    for (std::size_t f = 0; f < row->frame_count(); ++f) pictures.push_back(renderer.draw(f));
  }
  AtomicOutput output(png, AtomicOutput::Kind::file);
  write_png(tile(pictures, static_cast<int>(frames.frame_count())), output.path());
  output.commit();
}

}  // namespace reprise
