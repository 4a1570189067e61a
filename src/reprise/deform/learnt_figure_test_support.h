// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The capsule figure with learnt models of its parts and of the whole body, made once a test program.

#pragma once

#include <memory>

#include "reprise/database/body_parts.h"
#include "reprise/deform/example_selection.h"
#include "reprise/deform/learning.h"
#include "reprise/deform/part_editor.h"
#include "reprise/synthetic/figure/figure.h"

namespace reprise::test {

inline const PerformanceDatabase& small_figure() {
  static const PerformanceDatabase figure = make_figure({.voxel_size = 0.05});
  return figure;
}

inline LearntModel learn_figure(const std::vector<BodyPart>& parts, double kept_variance = 0.99,
                                std::size_t count = 40) {
  const PerformanceDatabase& figure = small_figure();
  std::vector<std::vector<FrameId>> examples;
  for (const BodyPart& part : parts) {
    examples.push_back(
        select_examples(figure, figure.markup()->reference, part.vertices, {.count = count}).frames);
  }
  return learn_model(figure, figure.markup()->reference, parts, examples, {.kept_variance = kept_variance});
}

inline const LearntModel& figure_parts() {
  static const LearntModel model = learn_figure(small_figure().markup()->parts);
  return model;
}

inline const LearntModel& figure_whole() {
  static const LearntModel model = learn_figure({whole_body_part(small_figure().topology()->vertex_count)});
  return model;
}

inline std::shared_ptr<const PartModel> part_model(const LearntModel& learnt,
                                                   const PartEditorOptions& options = {}) {
  return std::make_shared<const PartModel>(small_figure().topology(), learnt, options);
}

// Constraints on every `step`-th vertex, at the places of a frame.
inline std::vector<PositionConstraint> every_vertex(const PositionsView& frame, std::int32_t step) {
  std::vector<PositionConstraint> constraints;
  for (std::int32_t v = 0; v < frame.rows(); v += step)
    constraints.push_back({.vertex = v, .target = frame.row(v).transpose().cast<double>()});
  return constraints;
}

// Constraints on the vertices of a joint's label, moved.
inline std::vector<PositionConstraint> drag_joint(const std::string& joint, const Eigen::Vector3d& move,
                                                  const PositionsView& frame) {
  const Markup& markup = *small_figure().markup();
  std::vector<PositionConstraint> constraints;
  for (const std::int32_t v : markup.vertices_of_joint(markup.skeleton.joint_idx(joint)))
    constraints.push_back({.vertex = v, .target = frame.row(v).transpose().cast<double>() + move});
  return constraints;
}

}  // namespace reprise::test
