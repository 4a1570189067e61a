// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Small surfaces and motions with known geometry.

#pragma once

#include "reprise/database/performance_database.h"

namespace reprise::test {

struct Shape {
  TopologyPtr topology;
  Positions positions;
};

// Closed unit sphere around (0, 1, 0) from an octahedron split `levels` times: 4^(levels + 1) + 2 vertices.
Shape sphere(int levels);

// Open grid of (cells + 1)^2 vertices over the unit square at height 0, normals up.
Shape sheet(int cells);

// A closed, upright, elongated body of a few hundred vertices with an arm-like bump, so that its yaw is
// unambiguous.
Shape body();

// A motion of `body()` that walks `speed` metres per frame along +Z while swaying with a period of `period`
// frames, starting at `phase` (frames).
MeshSequence walk(const std::string& name, std::size_t frame_count, double speed = 0.04, double period = 20.0,
                  double phase = 0.0);

// The same clip with every frame moved on the ground.
MeshSequence moved(const MeshSequence& clip, const GroundTransform& transform, const std::string& name);

// The clips in order.
PerformanceDatabase database_of(std::vector<MeshSequence> clips);

}  // namespace reprise::test
