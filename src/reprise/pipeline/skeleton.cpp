// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/skeleton.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/core/progress.h"
#include "reprise/core/text.h"
#include "reprise/io/bvh.h"
#include "reprise/io/database_file.h"

namespace reprise {
namespace {

using nlohmann::json;

constexpr double degrees = 180.0 / std::numbers::pi;

json describe_joints(const Topology& topology, const Markup& markup,
                     const SkeletonExtractionOptions& options) {
  const std::vector<bool> followed = followed_bones(topology, markup, options);
  json joints = json::array();
  for (int j = 0; j < markup.skeleton.size(); ++j) {
    const Joint& joint = markup.skeleton.joints[static_cast<std::size_t>(j)];
    json parent;
    if (joint.parent >= 0) parent = markup.skeleton.joints[static_cast<std::size_t>(joint.parent)].name;
    joints.push_back({{"name", joint.name},
                      {"parent", std::move(parent)},
                      {"vertices", markup.vertices_of_joint(j).size()},
                      {"followed", static_cast<bool>(followed[static_cast<std::size_t>(j)])}});
  }
  return joints;
}

// Mean and greatest share by which the distance of a joint from its parent strays from that at rest.
json length_error(const SkeletalMotion& motion) {
  double sum = 0.0;
  double greatest = 0.0;
  std::size_t count = 0;
  for (const SkeletonPose& pose : motion.frames) {
    for (std::size_t j = 0; j < motion.skeleton.joints.size(); ++j) {
      const Joint& joint = motion.skeleton.joints[j];
      if (joint.parent < 0) continue;
      const auto p = static_cast<std::size_t>(joint.parent);
      const double rest = (joint.rest_position - motion.skeleton.joints[p].rest_position).norm();
      if (rest <= 0.0) continue;
      const double error = std::abs((pose.position[j] - pose.position[p]).norm() / rest - 1.0);
      sum += error;
      greatest = std::max(greatest, error);
      ++count;
    }
  }
  return {{"mean", count > 0 ? sum / static_cast<double>(count) : 0.0}, {"max", greatest}};
}

json describe(const PoseDifference& difference, const Skeleton& skeleton) {
  json joints = json::array();
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    joints.push_back({{"name", skeleton.joints[j].name},
                      {"mean_distance", difference.mean_distance[j]},
                      {"max_distance", difference.max_distance[j]},
                      {"mean_angle_degrees", difference.mean_angle[j] * degrees},
                      {"max_angle_degrees", difference.max_angle[j] * degrees}});
  }
  return {{"distance", difference.distance},
          {"angle_degrees", difference.angle * degrees},
          {"joints", std::move(joints)}};
}

std::vector<std::size_t> chosen_clips(const DatabaseReader& reader, const std::filesystem::path& database,
                                      const std::string& name) {
  std::vector<std::string> names;
  std::vector<std::size_t> chosen;
  for (const ClipInfo& clip : reader.clips()) {
    if (name.empty() || clip.name == name) chosen.push_back(names.size());
    names.push_back(clip.name);
  }
  if (!chosen.empty() || name.empty()) return chosen;
  const std::string nearest = nearest_word(name, names);
  throw InvalidArgument(nearest.empty() ? fmt::format("{} has no clip '{}'; its clips are {}",
                                                      database.string(), name, fmt::join(names, ", "))
                                        : fmt::format("{} has no clip '{}'; did you mean '{}'?",
                                                      database.string(), name, nearest));
}

}  // namespace

SkeletonResult extract_skeletons(const std::filesystem::path& database, const SkeletonOptions& options) {
  const DatabaseReader reader(database);
  if (!reader.markup()) {
    throw InvalidArgument(fmt::format(
        "{} has no markup, which says what bone each vertex follows: give it one with `reprise markup`",
        database.string()));
  }
  const Markup& markup = *reader.markup();
  const std::vector<std::size_t> chosen = chosen_clips(reader, database, options.clip);
  const bool is_rigid = options.extraction.position == SkeletonExtractionOptions::JointPosition::rigid;
  SkeletonResult result;
  json clips = json::array();
  std::size_t frame_count = 0;
  for (const std::size_t c : chosen) frame_count += reader.clips()[c].frame_count;
  Progress progress("skeleton", frame_count);
  for (const std::size_t c : chosen) {
    SkeletalMotion motion = extract_skeleton(reader.read_clip(c), markup, options.extraction);
    json clip = {{"name", motion.name},
                 {"frames", motion.frames.size()},
                 {"length_error", length_error(motion)},
                 {"difference", nullptr}};
    if (const std::optional<ClipTruth> truth = reader.read_truth(c)) {
      clip["difference"] = describe(pose_difference(motion, truth->poses), markup.skeleton);
    }
    clips.push_back(std::move(clip));
    progress.advance(motion.frames.size());
    result.motions.push_back(std::move(motion));
  }
  result.report = {{"database", database.string()},
                   {"position", is_rigid ? "rigid" : "centroid"},
                   {"joints", describe_joints(*reader.topology(), markup, options.extraction)},
                   {"clips", std::move(clips)}};
  return result;
}

void write_skeletons(const std::vector<SkeletalMotion>& motions, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directory(folder, error);
  if (!std::filesystem::is_directory(folder)) {
    throw FileError(folder, fmt::format("is not a folder and cannot be made one{}",
                                        error ? ": " + error.message() : std::string()));
  }
  for (const SkeletalMotion& motion : motions) write_bvh(motion, folder / (motion.name + ".bvh"));
}

}  // namespace reprise
