// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/route_line.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace reprise::path_detail {

RouteLine::RouteLine(const std::vector<Eigen::Vector2d>& points) {
  for (const Eigen::Vector2d& point : points) {
    if (points_.empty()) {
      start_.push_back(0.0);
    } else if (point == points_.back()) {
      continue;
    } else {
      start_.push_back(start_.back() + (point - points_.back()).norm());
      directions_.emplace_back((point - points_.back()).normalized());
    }
    points_.push_back(point);
  }
}

std::size_t RouteLine::stretch_at(double at) const {
  return static_cast<std::size_t>(std::upper_bound(start_.begin() + 1, start_.end() - 1, at) -
                                  start_.begin() - 1);
}

Eigen::Vector2d RouteLine::ahead(double marker, double metres) const {
  const double at = std::min(marker + metres, length());
  const std::size_t i = stretch_at(at);
  return points_[i] + (at - start_[i]) * directions_[i];
}

RouteLine::Match RouteLine::follow(double marker, const Eigen::Vector2d& center) const {
  const double farthest = std::min(marker + look_ahead, length());
  std::size_t i = stretch_at(marker);
  double nearest = std::numeric_limits<double>::infinity();
  double best = marker;
  for (; i < directions_.size() && start_[i] <= farthest; ++i) {
    const Eigen::Vector2d to_center = center - points_[i];
    const double least = std::max(marker - start_[i], 0.0);
    const double greatest = std::max(std::min(farthest, start_[i + 1]) - start_[i], least);
    const double along = std::clamp(directions_[i].dot(to_center), least, greatest);
    const double squared = (to_center - along * directions_[i]).squaredNorm();
    if (squared < nearest) {
      nearest = squared;
      best = start_[i] + along;
    }
  }
  return {best, std::sqrt(nearest)};
}

}  // namespace reprise::path_detail
