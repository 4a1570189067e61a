// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Makes a performance database of two clips, the second turned and moved on the ground, and finds that motion
// again.

#include <cmath>
#include <cstdio>
#include <memory>

#include "reprise/database/performance_database.h"
#include "reprise/similarity/vertex_metric.h"

int main() {
  const auto topology = std::make_shared<const reprise::Topology>(
      reprise::Topology{.vertex_count = 4, .triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}});
  reprise::MeshSequence clip("here", topology, 1, 25.0);
  clip.frame(0) << 0.0F, 0.0F, 0.0F,  //
      1.0F, 0.0F, 0.0F,               //
      0.0F, 2.0F, 0.0F,               //
      0.0F, 0.0F, 3.0F;

  const reprise::GroundTransform there_from_here{.yaw = 0.5, .translation = {1.0, -2.0}};
  reprise::MeshSequence moved = clip;
  moved.set_name("there");
  // A copy whose memory comes from the library and goes back to the system here: both sides must align alike.
  const reprise::Mesh mesh = clip.mesh(0);
  reprise::transform_positions(there_from_here, {mesh.positions.data(), mesh.positions.rows(), 3},
                               moved.frame(0));

  reprise::PerformanceDatabase database;
  database.add(clip);
  database.add(moved);
  const auto& clips = database.clips();
  const reprise::GroundAlignment found = reprise::align_on_ground(clips[1].frame(0), clips[0].frame(0));
  std::printf("yaw %.3f, translation (%.3f, %.3f), rms %.3f\n", found.a_from_b.yaw,
              found.a_from_b.translation.x(), found.a_from_b.translation.y(), found.rms_distance);

  const bool is_found = std::abs(found.a_from_b.yaw - there_from_here.yaw) < 1e-5 &&
                        (found.a_from_b.translation - there_from_here.translation).norm() < 1e-5 &&
                        found.rms_distance < 1e-5 &&
                        reprise::vertex_dissimilarity(database).frame_count() == database.frame_count();
  return is_found ? 0 : 1;
}
