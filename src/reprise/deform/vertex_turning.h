// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// How far the surface around each vertex has turned. Internal to `LearntPartSolver`.

#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "reprise/deform/part_hierarchy.h"

namespace reprise {

class VertexTurning {
 public:
  explicit VertexTurning(const Topology& topology);

  // For every vertex the rotation that takes the edges around it from `from` to `to` best in the
  // least-squares sense, started at `rotations` and left there (n unit quaternions). Edges of triangles; a
  // vertex without any keeps its rotation. Stops within some thousandths of a radian of it; another call goes
  // on from there.
  void update(const Coordinates& from, const Coordinates& to,
              std::vector<Eigen::Quaterniond>& rotations) const;

 private:
  std::vector<std::int32_t> neighbours_;
  std::vector<std::size_t> first_;  // of each vertex; one more entry than vertices
};

}  // namespace reprise
