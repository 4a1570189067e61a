// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/ground_guide.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace reprise::path_detail {
namespace {

constexpr int frames_ahead = 12;      // over which a direction of travel is taken
constexpr double least_travel = 0.1;  // metres in these frames; less is no direction
constexpr double way_ahead = 1.0;     // metres along the route to look
constexpr double least_gap = 0.5;     // metres; nearer places have no direction worth turning to
constexpr double least_turn = 0.1;    // radians; transitions that turn less set no price
constexpr double inflation = 1.3;     // of what is to come: puts those first that have come far

double angle_between(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)));
}

}  // namespace

GroundGuide::GroundGuide(const PathMetrics& metrics, const GroundTask& task, const FrameId& first)
    : task_(task) {
  for (const NodePlace& place : node_places(metrics, *task.graph, first)) {
    Eigen::Vector2d direction = Eigen::Vector2d::Zero();
    if (place.frame >= 0) {
      const std::vector<Eigen::Vector2d>& clip = metrics.trajectory(place.clip_idx);
      const auto last = static_cast<int>(clip.size()) - 1;
      const int to = std::min(place.frame + frames_ahead, last);
      const int from = std::max(to - frames_ahead, 0);
      direction = clip[static_cast<std::size_t>(to)] - clip[static_cast<std::size_t>(from)];
      const double travel = direction.norm();
      direction *= travel < least_travel ? 0.0 : 1.0 / travel;
    }
    directions_.push_back(direction);
  }
  std::vector<double> prices;
  for (const Transition& transition : metrics.transitions()) {
    const double turn = std::abs(wrap_angle(transition.source_from_target.yaw));
    if (turn > least_turn) prices.push_back(transition.cost / turn);
  }
  if (prices.empty()) return;
  const auto middle = prices.begin() + static_cast<std::ptrdiff_t>(prices.size() / 2);
  std::nth_element(prices.begin(), middle, prices.end());
  price_ = *middle;
}

double GroundGuide::operator()(const GroundBounds& bounds, const GroundLabel& label, double ceiling) const {
  const double guess = task_.route ? bounds.guess(label, ceiling) : label.bound;
  return label.cost + inflation * (guess - label.cost) + price_ * turning(label);
}

double GroundGuide::turning(const GroundLabel& label) const {
  const Eigen::Matrix2d R = ground_rotation(label.yaw);
  const Eigen::Vector2d& own = directions_[static_cast<std::size_t>(label.node)];
  Eigen::Vector2d heading = R * own;
  double angle = 0.0;
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  if (task_.route) {
    to = task_.route->ahead(label.marker, way_ahead) - label.position;
  } else if (task_.goal) {
    to = task_.goal->position - label.position;
  }
  const bool has_way = to.norm() > least_gap;
  if (has_way) {
    if (!heading.isZero()) angle += angle_between(heading, to);
    heading = to;
  }
  if (!task_.goal || !task_.goal->turn) return angle;
  const Eigen::Vector2d& last = directions_.back();
  if (!has_way || last.isZero() || heading.isZero()) {
    return angle + std::abs(wrap_angle(label.yaw - *task_.goal->turn));
  }
  return angle + angle_between(heading, ground_rotation(*task_.goal->turn) * last);
}

}  // namespace reprise::path_detail
