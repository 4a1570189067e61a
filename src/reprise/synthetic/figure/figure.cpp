// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/figure/figure.h"

#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/core/parallel.h"
#include "reprise/database/body_parts.h"
#include "reprise/synthetic/figure/figure_skin.h"

namespace reprise {

namespace {

Markup true_markup(const figure::Body& body, double scale) {
  Markup markup;
  for (int joint = 0; joint < figure::joint_count; ++joint) {
    markup.skeleton.joints.push_back({.name = figure::joint_name(joint),
                                      .parent = figure::parent_of(joint),
                                      .rest_position = scale * figure::rest_position(joint)});
  }
  markup.reference.resize(static_cast<Eigen::Index>(body.points.size()), 3);
  for (std::size_t v = 0; v < body.points.size(); ++v) {
    markup.reference.row(static_cast<Eigen::Index>(v)) = (scale * body.points[v]).transpose().cast<float>();
    markup.joint_of_vertex.push_back(body.hem[v] > 0.2 ? -1 : body.bindings[v].joints.front());
  }
  markup.parts = body_parts(*body.topology, markup.reference, markup.skeleton, markup.joint_of_vertex);
  return markup;
}

SkeletonPose scaled(const figure::Pose& pose, double scale) {
  SkeletonPose scaled{.rotation = {pose.rotation.begin(), pose.rotation.end()}, .position = {}};
  for (const Eigen::Vector3d& position : pose.position) scaled.position.push_back(scale * position);
  return scaled;
}

}  // namespace

PerformanceDatabase make_figure(const FigureOptions& options) {
  const auto require = [](bool ok, const char* name, const char* range, double found) {
    if (!ok) throw InvalidArgument(fmt::format("{}: expected {}, found {}", name, range, found));
  };
  require(options.frames_per_second >= 5.0 && options.frames_per_second <= 500.0, "frames_per_second",
          "5 to 500", options.frames_per_second);
  require(options.height >= 0.1 && options.height <= 10.0, "height", "0.1 to 10 m", options.height);
  const double scale = options.height / figure::design_height;
  const double voxel_size = options.voxel_size / scale;
  require(voxel_size >= 0.004 && voxel_size <= 0.097, "voxel_size", "1/437 to 1/18 of the height",
          options.voxel_size);

  const figure::Body body = figure::make_body(voxel_size);
  const std::vector<figure::ClipPlan> plans = figure::clip_plans();
  std::vector<MeshSequence> clips(plans.size());
  std::vector<ClipTruth> truths(plans.size());
  parallel_for(0, plans.size(), [&](std::size_t c) {
    const figure::Motion motion(plans[c]);
    const auto frame_count =
        static_cast<std::size_t>(std::lround(motion.plan().duration * options.frames_per_second));
    MeshSequence clip(motion.plan().name, body.topology, frame_count, options.frames_per_second);
    const auto hem = figure::Hem::simulate(body, motion, frame_count, options.frames_per_second);
    for (std::size_t f = 0; f < frame_count; ++f) {
      throw_if_interrupted();
      const double time = static_cast<double>(f) / options.frames_per_second;
      const figure::Pose pose = motion.pose(time);
      truths[c].poses.push_back(scaled(pose, scale));
      truths[c].contacts.push_back({motion.flat_footed(0, time), motion.flat_footed(1, time)});
      const figure::Skin skin(body, pose);
      PositionsRef positions = clip.frame(f);
      for (std::size_t v = 0; v < body.points.size(); ++v) {
        const Eigen::Vector3d point = skin(v) + figure::Hem::displacement(body, hem[f], v);
        positions.row(static_cast<Eigen::Index>(v)) = (scale * point).transpose().cast<float>();
      }
    }
    clip.set_colors(body.colors);
    clips[c] = std::move(clip);
  });

  PerformanceDatabase database;
  for (MeshSequence& clip : clips) database.add(std::move(clip));
  database.set_markup(true_markup(body, scale));
  for (std::size_t c = 0; c < truths.size(); ++c) database.set_truth(c, std::move(truths[c]));
  return database;
}

}  // namespace reprise
