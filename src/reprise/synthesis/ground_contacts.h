// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Which parts of the captured surface stand on the ground, and when.

#pragma once

#include <cstdint>
#include <vector>

#include "reprise/database/performance_database.h"

namespace reprise {

struct ContactOptions {
  double height = 0.03;  // metres above the ground below which a vertex can be in contact
  double speed = 0.3;    // m/s: a vertex that moves faster in its captured clip is not in contact
};

// A vertex is in contact at a captured frame if from that frame to the next it stays below `height` and
// moves over the ground slower than `speed`. The ground of a clip is the 5th percentile of its frames' lowest
// points.
//
// Feet are connected patches of vertices that are ever in contact: those that lie on average in the lowest
// quarter of the performer (a hand on the floor is no foot) and have at least a tenth of the contacts of the
// busiest patch (nor is a hem that brushes it).
class GroundContacts {
 public:
  // Throws `InvalidArgument` naming the option that is out of range, or if the database is empty.
  explicit GroundContacts(const PerformanceDatabase& database, const ContactOptions& options = {});

  // Vertices in contact from `frame_idx` to the frame after it, ascending; none at a clip's last frame.
  // Throws `InvalidArgument` if the database has no such frame.
  const std::vector<std::int32_t>& touching(std::size_t clip_idx, std::size_t frame_idx) const;
  // Vertices of each foot, ascending; feet in the order of their first vertices.
  const std::vector<std::vector<std::int32_t>>& feet() const { return feet_; }
  double ground_height(std::size_t clip_idx) const { return ground_[clip_idx]; }

  // How tall the performer is: the median over frames of the highest point above the ground, metres.
  double stature() const { return stature_; }
  // Height of each vertex above the ground, metres: mean over all frames.
  const std::vector<double>& mean_heights() const { return mean_heights_; }

 private:
  void find_feet(const Topology& topology);

  std::vector<double> ground_;
  std::vector<std::vector<std::vector<std::int32_t>>> touching_;  // clip, frame
  double stature_ = 0.0;
  std::vector<double> mean_heights_;
  std::vector<std::vector<std::int32_t>> feet_;
};

}  // namespace reprise
