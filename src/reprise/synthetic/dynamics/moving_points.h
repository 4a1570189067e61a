// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Points known at whole frames, and where they are between.

#pragma once

#include <array>
#include <cstddef>

#include "reprise/synthetic/body/dressed_body.h"

namespace reprise::dynamics {

// Catmull-Rom through four successive frames. Straight lines between frames would not do: their corners kick
// a turning waistband once a frame, and cloth answers with a shiver.
class MovingPoints {
 public:
  // Stands still at `points`.
  void start(const Points& points) { frames_ = {points, points, points, points}; }

  // Goes on by one frame; `after_next` is where the points are one frame after the end of the new one.
  void advance(const Points& after_next) {
    for (std::size_t i = 0; i < 3; ++i) frames_[i].swap(frames_[i + 1]);
    frames_[3] = after_next;
  }

  // `part` in [0, 1]: from the beginning of the current frame to its end.
  void evaluate(double part, Points& points) const {
    const double t = part, t2 = t * t, t3 = t2 * t;
    points = (-0.5 * t3 + t2 - 0.5 * t) * frames_[0] + (1.5 * t3 - 2.5 * t2 + 1.0) * frames_[1] +
             (-1.5 * t3 + 2.0 * t2 + 0.5 * t) * frames_[2] + (0.5 * t3 - 0.5 * t2) * frames_[3];
  }

  const Points& begin() const { return frames_[1]; }
  const Points& end() const { return frames_[2]; }

 private:
  std::array<Points, 4> frames_;
};

}  // namespace reprise::dynamics
