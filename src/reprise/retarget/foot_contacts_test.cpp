// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/retarget/foot_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace reprise {
namespace {

using Eigen::Vector3d;

// Contacts of a foot that steps once a second: down for 0.6 s, with jitter as of markers.
TEST(FootContactDetection, ContactsAreFoundThroughNoise) {
  constexpr double rate = 120.0;
  retargeting::FootTrack track;
  std::vector<bool> truth;
  for (int f = 0; f < 576; ++f) {
    const double phase = std::fmod(f / rate, 1.0), step = std::floor(f / rate);
    const double u = std::max(0.0, (phase - 0.6) / 0.4);
    const double way = u - std::sin(2.0 * std::numbers::pi * u) / (2.0 * std::numbers::pi);
    const double jitter = 0.0006 * std::sin(12.9898 * f) * std::cos(78.233 * f);
    const double lift = 0.12 * std::sin(std::numbers::pi * u) * std::sin(std::numbers::pi * u);
    track.ankle.emplace_back(0.0, 0.07 + lift + jitter, step + way + jitter);
    track.toe.emplace_back(0.0, 0.03 + lift - jitter, 0.12 + step + way - jitter);
    truth.push_back(phase < 0.6);
  }
  const std::vector<bool> contacts = retargeting::detect_contacts(track, rate);
  int changes = 0, wrong = 0;
  for (std::size_t f = 0; f < contacts.size(); ++f) {
    wrong += contacts[f] != truth[f] ? 1 : 0;
    changes += f > 0 && contacts[f] != contacts[f - 1] ? 1 : 0;
  }
  EXPECT_EQ(changes, 9);    // no flicker
  EXPECT_LE(wrong, 9 * 6);  // found within 50 ms
}

TEST(FootContactDetection, ASlopingCaptureFloorIsFound) {
  std::array<retargeting::FootTrack, 2> tracks;
  for (int f = 0; f < 480; ++f) {
    for (const int side : {0, 1}) {
      const double t = f / 120.0 + 0.5 * side;
      const double u = std::max(0.0, (t - std::floor(t) - 0.6) / 0.4);
      const double way =
          1.2 * (std::floor(t) + u - std::sin(2.0 * std::numbers::pi * u) / (2.0 * std::numbers::pi));
      const Vector3d place(0.2 * side, 0.03 + 0.02 * way + 0.1 * std::sin(std::numbers::pi * u), way);
      tracks[static_cast<std::size_t>(side)].toe.push_back(place);
      tracks[static_cast<std::size_t>(side)].ankle.emplace_back(place + Vector3d(0.0, 0.04, -0.12));
    }
  }
  const Eigen::Vector2d slope = retargeting::ground_slope(tracks, 120.0);
  EXPECT_NEAR(slope.y(), 0.02, 0.002);
  EXPECT_NEAR(slope.x(), 0.0, 0.002);
}

}  // namespace
}  // namespace reprise
