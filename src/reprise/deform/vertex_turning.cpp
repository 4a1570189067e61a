// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/vertex_turning.h"

#include <algorithm>
#include <cmath>

namespace reprise {

VertexTurning::VertexTurning(const Topology& topology) {
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  for (const Triangle& triangle : topology.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      edges.emplace_back(triangle[k], triangle[(k + 1) % 3]);
      edges.emplace_back(triangle[(k + 1) % 3], triangle[k]);
    }
  }
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  first_.assign(static_cast<std::size_t>(topology.vertex_count) + 1, 0);
  for (const auto& [from, to] : edges) {
    ++first_[static_cast<std::size_t>(from) + 1];
    neighbours_.push_back(to);
  }
  for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
}

void VertexTurning::update(const Coordinates& from, const Coordinates& to,
                           std::vector<Eigen::Quaterniond>& rotations) const {
  for (std::size_t v = 0; v + 1 < first_.size(); ++v) {
    Eigen::Matrix3d M = Eigen::Matrix3d::Zero();  // columns: where the axes of `from` go
    const auto row = static_cast<Eigen::Index>(v);
    for (std::size_t i = first_[v]; i < first_[v + 1]; ++i) {
      M += (to.row(neighbours_[i]) - to.row(row)).transpose() * (from.row(neighbours_[i]) - from.row(row));
    }
    // Mueller et al. 2016, "A robust method to extract the rotational part of deformations": turns the last
    // rotation towards the best one, which needs no branches for flat or mirrored neighbourhoods.
    Eigen::Quaterniond& q = rotations[v];
    constexpr int most_steps = 8;
    for (int step = 0; step < most_steps; ++step) {
      const Eigen::Matrix3d R = q.toRotationMatrix();
      Eigen::Vector3d torque = Eigen::Vector3d::Zero();
      double grip = 0.0;
      for (int k = 0; k < 3; ++k) {
        torque += R.col(k).cross(M.col(k));
        grip += R.col(k).dot(M.col(k));
      }
      const Eigen::Vector3d turn = torque / (std::abs(grip) + 1e-12);
      const double angle = turn.norm();
      constexpr double tolerance = 1e-3;  // radians: the next update goes on from here
      if (!(angle > tolerance)) break;
      q = (Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * q).normalized();
    }
  }
}

}  // namespace reprise
