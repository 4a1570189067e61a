// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// How natural the motion of a driven character is: pops, sliding and sinking feet, stretched triangles.

#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "reprise/retarget/joint_map.h"
#include "reprise/synthesis/naturalness.h"

namespace reprise {

struct MotionQuality {
  // Largest vertex acceleration (second difference) over the 99th percentile of the captured frames' largest:
  // inside transitions, as `Naturalness::pop_ratio` (0 without any), and over all frames.
  double pop_ratio = 0.0;
  double peak_ratio = 0.0;
  // Of feet that stand in the query, at that frame and the next: mean horizontal speed of what of the sole is
  // down, cm/s, and how far the lowest of it is from the ground (y = 0), above or below, mean, cm.
  double foot_drift = 0.0;
  double foot_height = 0.0;
  double edge_stretch_p99 = 0.0;  // as `Naturalness`
};

// What all animations of a character are measured by. Immutable.
class MotionQualityScale {
 public:
  // `map`: names the joints of the markup's skeleton that are feet. Throws `InvalidArgument` if the database
  // has no markup.
  MotionQualityScale(const PerformanceDatabase& database, const JointMap& map,
                     const ContactOptions& options = {});

  const CapturedNaturalness& captured() const { return captured_; }
  // Vertices of the sole of the left and the right foot: patches of `GroundContacts::feet`, by the nearer
  // foot joint on the marked surface.
  const std::array<std::vector<std::int32_t>, 2>& soles() const { return soles_; }

 private:
  friend class MotionQualityMeter;
  CapturedNaturalness captured_;
  std::array<std::vector<std::int32_t>, 2> soles_;
  std::shared_ptr<const ReferenceEdges> edges_;
};

// Takes frames as they are made; keeps three. Not thread-safe.
class MotionQualityMeter {
 public:
  MotionQualityMeter(const MotionQualityScale& scale, double frames_per_second);

  // `is_blend`: of a transition. `contacts`: feet that stand in the query.
  void add(const Positions& frame, bool is_blend, const FootContacts& contacts);
  MotionQuality quality() const;

 private:
  struct Seen {
    Positions positions;
    bool is_blend = false;
    FootContacts contacts{};
  };
  void add_feet(const Seen& now, const Seen& next);

  const MotionQualityScale& scale_;
  double frames_per_second_;
  EdgeStretch stretch_;
  std::vector<Seen> seen_;  // the last three at most, oldest first
  double peak_ = 0.0, blend_peak_ = 0.0;
  double speed_sum_ = 0.0, height_sum_ = 0.0;
  std::size_t speed_count_ = 0, height_count_ = 0;
};

}  // namespace reprise
