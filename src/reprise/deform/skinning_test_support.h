// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A closed tube on bones in a row, and the small figure, for tests of skinning.

#pragma once

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "reprise/database/markup.h"
#include "reprise/deform/skinning.h"
#include "reprise/synthetic/figure/figure.h"

namespace reprise::test {

struct MarkedSurface {
  TopologyPtr topology;
  Markup markup;
};

constexpr double tube_radius = 0.1;
constexpr int tube_segments = 16;

// Adds an upright closed tube to a surface: rings between `bottom` and `top`, alternately turned by half a
// segment, so that an odd number of them mirrors itself in the middle; then the two poles.
inline void add_tube(Topology& topology, Positions& positions, double radius, double bottom, double top,
                     int rings, const Eigen::Vector3d& place = Eigen::Vector3d::Zero()) {
  const std::int32_t first = topology.vertex_count;
  topology.vertex_count += rings * tube_segments + 2;
  positions.conservativeResize(topology.vertex_count, 3);
  const auto at = [&](int ring, int segment) {
    return first + ring * tube_segments + (segment + tube_segments) % tube_segments;
  };
  for (int i = 0; i < rings; ++i) {
    for (int k = 0; k < tube_segments; ++k) {
      const double angle = 2.0 * std::numbers::pi * (k + 0.5 * (i % 2)) / tube_segments;
      const double y = bottom + (top - bottom) * i / (rings - 1);
      const Eigen::Vector3d p =
          place + Eigen::Vector3d(radius * std::cos(angle), y, radius * std::sin(angle));
      positions.row(at(i, k)) = p.transpose().cast<float>();
    }
  }
  const std::int32_t south = first + rings * tube_segments, north = south + 1;
  positions.row(south) = (place + Eigen::Vector3d(0, bottom, 0)).transpose().cast<float>();
  positions.row(north) = (place + Eigen::Vector3d(0, top, 0)).transpose().cast<float>();
  for (int k = 0; k < tube_segments; ++k) {
    for (int i = 0; i + 1 < rings; ++i) {
      const int ahead =
          i % 2;  // the upper ring stands half a segment ahead of an even one, behind an odd one
      topology.triangles.push_back({at(i, k), at(i + 1, k + ahead), at(i, k + 1)});
      topology.triangles.push_back({at(i + 1, k), at(i + 1, k + 1), at(i, k + 1 - ahead)});
    }
    topology.triangles.push_back({south, at(0, k), at(0, k + 1)});
    topology.triangles.push_back({north, at(rings - 1, k + 1), at(rings - 1, k)});
  }
}

// From y = -1 to 1 with bones "lower" below and "upper" above 0, nothing labelled.
inline MarkedSurface tube(int rings = 61) {
  Topology topology;
  MarkedSurface surface;
  add_tube(topology, surface.markup.reference, tube_radius, -1.0, 1.0, rings);
  surface.markup.joint_of_vertex.assign(static_cast<std::size_t>(topology.vertex_count), -1);
  surface.markup.skeleton.joints = {{.name = "lower", .parent = -1, .rest_position = {0, -1, 0}},
                                    {.name = "upper", .parent = 0, .rest_position = {0, 0, 0}}};
  surface.topology = std::make_shared<const Topology>(std::move(topology));
  return surface;
}

// The figure's database, made once.
inline const PerformanceDatabase& figure_database() {
  static const PerformanceDatabase database = make_figure({.voxel_size = 0.035});
  return database;
}

inline PositionsView view(const Positions& positions) {
  return {positions.data(), positions.rows(), 3};
}

inline Positions skinned(const SkinWeights& weights, const Skeleton& skeleton, const Positions& source,
                         const SkeletonPose& source_pose, const SkeletonPose& target_pose,
                         Skinning skinning) {
  Positions result(source.rows(), 3);
  skin(weights, skeleton, view(source), source_pose, target_pose, skinning,
       PositionsRef(result.data(), result.rows(), 3));
  return result;
}

inline double largest_distance(const Positions& a, const Positions& b) {
  return std::sqrt((a.cast<double>() - b.cast<double>()).rowwise().squaredNorm().maxCoeff());
}

// The pose turned by `rotation` about the origin and moved by `shift`.
inline SkeletonPose moved(const SkeletonPose& pose, const Eigen::Quaterniond& rotation,
                          const Eigen::Vector3d& shift) {
  SkeletonPose result = pose;
  for (Eigen::Quaterniond& q : result.rotation) q = rotation * q;
  for (Eigen::Vector3d& p : result.position) p = rotation * p + shift;
  return result;
}

inline Positions moved(const Positions& positions, const Eigen::Quaterniond& rotation,
                       const Eigen::Vector3d& shift) {
  Positions result(positions.rows(), 3);
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    const Eigen::Vector3d p = positions.row(v).cast<double>().transpose();
    result.row(v) = (rotation * p + shift).transpose().cast<float>();
  }
  return result;
}

}  // namespace reprise::test
