// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// When the feet of a captured motion stand, and on what.

#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

namespace reprise::retargeting {

// Ankle and toe joint of one foot in every frame, metres, Y up.
struct FootTrack {
  std::vector<Eigen::Vector3d> ankle, toe;
};

// The height above which the ankle is hardly ever lower: that of a foot that stands flat.
double standing_ankle_height(const FootTrack& track);

// Slope of the ground along x and z: captures whose floor was not calibrated level rise by centimetres in a
// few steps. Zero where the feet hardly travel, or where the ground is steeper than any such mistake.
Eigen::Vector2d ground_slope(const std::array<FootTrack, 2>& tracks, double frames_per_second);

// Frames in which the foot bears on the ground: its ankle or toe joint is low and slow. Thresholds for going
// down and up differ, so that noise does not make the foot flicker; gaps and contacts shorter than a real
// step's are closed or dropped. Speeds and heights are those of a body of adult size.
std::vector<bool> detect_contacts(const FootTrack& track, double frames_per_second);

}  // namespace reprise::retargeting
