// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/skeleton_metric.h"

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/similarity/vertex_metric.h"

namespace reprise {

DissimilarityMatrix skeleton_dissimilarity(const PerformanceDatabase& database,
                                           const std::vector<SkeletalMotion>& motions) {
  if (motions.size() != database.clips().size()) {
    throw InvalidArgument(fmt::format("{} skeletal motions of a database of {} clips: expected one each",
                                      motions.size(), database.clips().size()));
  }
  DissimilarityMatrix matrix("skeleton", database);
  std::vector<Positions> frames;
  for (std::size_t c = 0; c < motions.size(); ++c) {
    const SkeletalMotion& motion = motions[c];
    const std::string& name = database.clip(c).name();
    if (motion.frames.size() != database.clip(c).frame_count()) {
      throw InvalidArgument(fmt::format("the skeletal motion of clip '{}' has {} poses, the clip {} frames",
                                        name, motion.frames.size(), database.clip(c).frame_count()));
    }
    const auto joint_count = static_cast<std::size_t>(motions.front().skeleton.size());
    for (std::size_t f = 0; f < motion.frames.size(); ++f) {
      const std::vector<Eigen::Vector3d>& joints = motion.frames[f].position;
      if (joints.size() != joint_count || joint_count == 0) {
        throw InvalidArgument(fmt::format("the pose of {}:{} has {} joints, expected {}", name, f,
                                          joints.size(),
                                          joint_count == 0 ? "at least one" : std::to_string(joint_count)));
      }
      Positions& positions = frames.emplace_back(static_cast<Eigen::Index>(joint_count), 3);
      for (std::size_t j = 0; j < joint_count; ++j) {
        positions.row(static_cast<Eigen::Index>(j)) = joints[j].transpose().cast<float>();
      }
    }
  }
  std::vector<PositionsView> views;
  views.reserve(frames.size());
  for (const Positions& positions : frames) views.emplace_back(positions.data(), positions.rows(), 3);
  set_aligned_distances(views, matrix);
  return matrix;
}

}  // namespace reprise
