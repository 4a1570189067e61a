// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A line drawn on the ground, and how far along it a performer has come.

#pragma once

#include <vector>

#include <Eigen/Core>

namespace reprise::path_detail {

// A polyline and the rule that matches frames with it. A marker walks along the line with the performer: from
// the marker of the frame before, it moves to the point of the line nearest to the frame's centre among those
// not behind it and not more than `look_ahead` metres ahead. So a line may cross itself or turn back beside
// itself and is still walked from one end to the other.
class RouteLine {
 public:
  // Metres along the line. A performer who keeps within it of the line never loses the marker at a corner.
  static constexpr double look_ahead = 2.0;

  // Precondition: at least two points, not all the same.
  explicit RouteLine(const std::vector<Eigen::Vector2d>& points);

  struct Match {
    double marker = 0.0;     // metres along the line
    double deviation = 0.0;  // metres from the centre to the marker
  };
  // The first of several nearest points.
  Match follow(double marker, const Eigen::Vector2d& center) const;

  // The point so many metres ahead of the marker, at most the end.
  Eigen::Vector2d ahead(double marker, double metres) const;

  double length() const { return start_.back(); }
  const Eigen::Vector2d& end() const { return points_.back(); }

 private:
  // The stretch that `at` metres along the line lie on: from its point to the next.
  std::size_t stretch_at(double at) const;

  // No two neighbours the same.
  std::vector<Eigen::Vector2d> points_;
  // Metres along the line of each point.
  std::vector<double> start_;
  // Of the stretches between points: unit vectors.
  std::vector<Eigen::Vector2d> directions_;
};

}  // namespace reprise::path_detail
