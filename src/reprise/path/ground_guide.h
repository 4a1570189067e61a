// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What a quick search over the ground goes by: a guess, not a bound.

#pragma once

#include <vector>

#include "reprise/path/ground_bounds.h"

namespace reprise::path_detail {

// Bounds know nothing of turns: a performer who walks away from the goal seems as well off as one who walks
// towards it until it is too late. The guide charges the angle between where the clip is about to take the
// performer and where the goal or the route lies, and on to the turn at the end, at the price at which this
// graph's transitions turn.
class GroundGuide {
 public:
  GroundGuide(const PathMetrics& metrics, const GroundTask& task, const FrameId& first);

  // What a walk that begins like this may cost in all; infinite where the bounds rule it out.
  double operator()(const GroundBounds& bounds, const GroundLabel& label, double ceiling) const;

 private:
  double turning(const GroundLabel& label) const;

  const GroundTask& task_;
  std::vector<Eigen::Vector2d> directions_;  // of travel at each node, in its clip's axes; zero: it stands
  double price_ = 0.0;                       // of a radian
};

}  // namespace reprise::path_detail
