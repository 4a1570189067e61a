// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The posed surface: skinning, and a tunic whose hem lags behind the hips.

#pragma once

#include <vector>

#include "reprise/synthetic/figure/figure_body.h"
#include "reprise/synthetic/figure/figure_motion.h"

namespace reprise::figure {

// Dual quaternion skinning (Kavan et al. 2007): joints keep their volume when they bend.
class Skin {
 public:
  Skin(const Body& body, const Pose& pose);
  Eigen::Vector3d operator()(std::size_t vertex) const;

 private:
  const Body& body_;
  std::array<Eigen::Quaterniond, joint_count> rotation_;
  std::array<Eigen::Quaterniond, joint_count> dual_;
};

// Weights on damped springs around the hem, simulated at a fixed step from well before the first frame. Each
// is pulled to where the skin holds it and slowed by the air that moves along with the body.
class Hem {
 public:
  static constexpr int weight_count = 16;
  using Displacements = std::array<Eigen::Vector3d, weight_count>;

  // Displacements of the hem from the skin at each frame, metres, world axes.
  static std::vector<Displacements> simulate(const Body& body, const Motion& motion, std::size_t frame_count,
                                             double frames_per_second);

  // Of a vertex: interpolated around the hem and faded up to the waist.
  static Eigen::Vector3d displacement(const Body& body, const Displacements& displacements,
                                      std::size_t vertex);
};

}  // namespace reprise::figure
