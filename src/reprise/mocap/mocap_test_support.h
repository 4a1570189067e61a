// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The capsule figure with what was learnt of it, ready to be driven.

#pragma once

#include <memory>
#include <vector>

#include "reprise/deform/learnt_figure_test_support.h"
#include "reprise/deform/skin_weights.h"
#include "reprise/mocap/surface_driver.h"
#include "reprise/skeleton/skeleton_extraction.h"

namespace reprise::test {

inline const PerformanceDatabase& figure_performer() {
  static const PerformanceDatabase database = [] {
    PerformanceDatabase learnt = small_figure();
    learnt.set_models({.part = figure_parts(), .whole = figure_whole()});
    return learnt;
  }();
  return database;
}

// The skeletons of its clips.
inline const std::vector<SkeletalMotion>& figure_motions() {
  static const std::vector<SkeletalMotion> motions = [] {
    std::vector<SkeletalMotion> found;
    for (const MeshSequence& clip : figure_performer().clips()) {
      found.push_back(extract_skeleton(clip, *figure_performer().markup()));
    }
    return found;
  }();
  return motions;
}

// Driven by every third labelled vertex.
inline DriveRig figure_rig(DriveModel model) {
  const PerformanceDatabase& database = figure_performer();
  static const auto weights =
      std::make_shared<const SkinWeights>(skin_weights(database.topology(), *database.markup()));
  static const auto part =
      std::make_shared<const PartModel>(database.topology(), figure_parts(), drive_part_options());
  static const auto whole =
      std::make_shared<const PartModel>(database.topology(), figure_whole(), drive_part_options());
  DriveRig rig{.topology = database.topology(), .markup = &*database.markup(), .weights = weights};
  const std::vector<std::int32_t>& joints = database.markup()->joint_of_vertex;
  for (std::size_t v = 0; v < joints.size(); v += 3) {
    if (joints[v] >= 0) rig.vertices.push_back({.vertex = static_cast<std::int32_t>(v), .joint = joints[v]});
  }
  if (model == DriveModel::part) rig.learnt = part;
  if (model == DriveModel::whole) rig.learnt = whole;
  return rig;
}

}  // namespace reprise::test
