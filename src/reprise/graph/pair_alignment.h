// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// `align_on_ground` for very many pairs of the frames of one database.

#pragma once

#include <vector>

#include "reprise/database/performance_database.h"
#include "reprise/math/ground_transform.h"

namespace reprise {

class PairAlignment {
 public:
  // Keeps a reference to the database.
  explicit PairAlignment(const PerformanceDatabase& database);

  // Equal to `align_on_ground` up to rounding, in one pass over the vertices.
  GroundTransform source_from_target(std::size_t source_clip, int m, std::size_t target_clip, int n) const;

 private:
  const PerformanceDatabase& database_;
  std::vector<std::vector<Eigen::Vector3d>> centroids_;  // of each frame of each clip
};

}  // namespace reprise
