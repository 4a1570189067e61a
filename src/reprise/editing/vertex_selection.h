// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Which vertices a person means: by number, by joint, by body part, by place.

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "reprise/database/performance_database.h"

namespace reprise {

// All that is given must hold of a vertex; at least one must be.
struct VertexSelection {
  std::vector<std::int32_t> vertices;
  std::string joint;                    // of the markup: vertices labelled with it
  std::string part;                     // of the markup: vertices of the part
  std::optional<Eigen::Vector3d> near;  // metres, in the frame: vertices within `radius` of it
  double radius = 0.05;                 // metres

  bool empty() const { return vertices.empty() && joint.empty() && part.empty() && !near; }
};

// Ascending, at least one. Throws `InvalidArgument`: nothing given; a joint or part that the markup lacks
// (offers the nearest) or no markup at all; a vertex out of range; a radius that is not positive; no vertex
// meets it all (says how far the nearest one is, if a place was given).
std::vector<std::int32_t> select_vertices(const PerformanceDatabase& database, FrameId frame,
                                          const VertexSelection& selection);

}  // namespace reprise
