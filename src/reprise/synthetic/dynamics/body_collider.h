// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A moving triangle surface that cloth and hair must not enter.

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "reprise/mesh/topology.h"
#include "reprise/synthetic/body/dressed_body.h"

namespace reprise::dynamics {

// Up to three triangles that a particle may touch next, or -1: on different sides of it, as between two legs.
using Candidates = std::array<std::int32_t, 3>;
inline constexpr Candidates no_candidates = {-1, -1, -1};

// Where a particle stands to the surface.
struct Touch {
  bool valid = false;        // false: nothing near, over an open edge, or hopelessly deep
  double distance = 0.0;     // metres; negative: inside
  Eigen::Vector3d normal;    // unit, away from the body
  Eigen::Vector3d movement;  // of the surface under the particle since the last `move`
};

// Search is rare (a few times a frame), the walk from triangle to triangle is cheap and done in every
// substep.
class BodyCollider {
 public:
  // `triangles` counter-clockwise seen from outside. The surface may have open edges: nothing collides there.
  BodyCollider(std::vector<Triangle> triangles, Eigen::Index vertex_count);

  // Brings the surface to `points`.
  void move(const Points& points);

  // Prepares `find` for the surface as it is now, for particles within the box.
  void prepare_search(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double radius);

  // Triangles nearest to the particle, within the radius given to `prepare_search`. `guess`: a triangle that
  // may be near, or -1; it saves time and changes nothing.
  Candidates find(const Eigen::Vector3d& particle, std::int32_t guess = -1) const;

  // The place nearest to the particle among `triangle` and those reached from it by going downhill;
  // `triangle` is moved there.
  Touch touch(const Eigen::Vector3d& particle, std::int32_t& triangle) const;

  // Deeper than this a particle is not pushed out any more: it is on the far side of something thin.
  static constexpr double deepest = 0.04;

 private:
  struct Nearest;
  Nearest nearest(const Eigen::Vector3d& particle, std::int32_t triangle) const;
  Eigen::Vector3d corner(std::int32_t triangle, int k) const {
    return points_.row(triangles_[static_cast<std::size_t>(triangle)][static_cast<std::size_t>(k)]);
  }
  bool on_open_edge(std::int32_t triangle, int feature) const;
  Eigen::Vector3d face_normal(std::int32_t triangle) const;
  Eigen::Vector3d outward(std::int32_t triangle, int feature) const;
  std::size_t cell_idx(const Eigen::Array3i& cell) const {
    return (static_cast<std::size_t>(cell.z()) * static_cast<std::size_t>(cells_.y()) +
            static_cast<std::size_t>(cell.y())) *
               static_cast<std::size_t>(cells_.x()) +
           static_cast<std::size_t>(cell.x());
  }
  Eigen::Array3i cell_of(const Eigen::Vector3d& point) const;

  std::vector<Triangle> triangles_;
  std::vector<std::array<std::int32_t, 3>> across_;  // triangle beyond edge (k, k + 1), or -1
  std::vector<std::int32_t> fan_begin_, fan_;        // triangles round every vertex
  std::vector<bool> open_vertex_;
  Points points_, before_;

  // As of the last search, a triangle each.
  struct Ball {
    Eigen::Vector3d centre, normal;
    double radius = 0.0;
    std::array<std::int16_t, 3> first_cell{};
  };
  std::vector<Ball> balls_;
  double radius_ = 0.0, cells_per_metre_ = 0.0;
  Eigen::Vector3d low_ = Eigen::Vector3d::Zero();
  Eigen::Array3i cells_ = Eigen::Array3i::Zero();
  std::vector<std::int32_t> cell_begin_, cell_triangles_;
};

}  // namespace reprise::dynamics
