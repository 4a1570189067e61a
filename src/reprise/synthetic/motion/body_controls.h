// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What a clip says about the body above the feet: a few dozen numbers an animator would think in.

#pragma once

#include <array>
#include <initializer_list>
#include <utility>
#include <vector>

#include "reprise/synthetic/motion/motion_curve.h"

namespace reprise::motion {

// Angles in degrees. Yaw is positive to the performer's left, list with the left side up, tilt forwards; of
// pelvis, chest and head they are measured from the heading, not from one another.
enum Channel {
  heading,  // of the body, from +Z towards +X
  pelvis_yaw,
  pelvis_list,
  pelvis_tilt,
  chest_yaw,
  chest_list,
  chest_tilt,
  head_yaw,
  head_list,
  head_tilt,
  shift_x,      // of the hips from where balance puts them, metres, to the left
  shift_z,      // forwards
  left_weight,  // share of the weight on the left foot while both stand
  // Of the left side; the right side's follow at `+ side_channels`.
  knee,       // flexion while the leg carries
  knee_out,   // of the knee's direction from the foot's
  collar_up,  // beyond what the arm's height brings
  collar_forward,
  arm_forward,  // of the upper arm from hanging
  arm_out,
  arm_in_twist,   // about its axis, turning the bent forearm inwards
  elbow,          // flexion
  palm_in_twist,  // of the hand about the forearm, from the resting pose
  wrist,          // flexion
  pin,            // 0: the angles above; 1: the wrist is held at the place below
  pin_out,        // outwards from the middle of the hips, metres, turning with the pelvis
  pin_up,
  pin_forward,
  pin_elbow_back,  // of the elbow's direction, 0: outwards, 90: backwards
  side_channels = 15,
  channel_count = 13 + 2 * side_channels,
};

// Sides: 0 is left (+X), 1 is right.
constexpr Channel sided(Channel left, int side) {
  return static_cast<Channel>(left + side * side_channels);
}

struct Controls {
  std::array<double, channel_count> values{};

  double& operator[](int channel) { return values[static_cast<std::size_t>(channel)]; }
  double operator[](int channel) const { return values[static_cast<std::size_t>(channel)]; }
};

Controls lerp(const Controls& a, const Controls& b, double u);

// A change of a key pose.
using Changes = std::initializer_list<std::pair<Channel, double>>;
Controls changed(Controls controls, Changes changes);

// The same pose with left and right exchanged.
Controls mirrored(const Controls& controls);

struct KeyPose {
  double time;
  Controls controls;
};

// Through key poses in time. Forearms, wrists and head follow the trunk a little later, as they do in life.
class KeyedControls {
 public:
  KeyedControls() = default;
  explicit KeyedControls(const std::vector<KeyPose>& poses, double smoothing = 0.05);

  Controls operator()(double time) const;

 private:
  std::vector<Curve> curves_;  // one a channel
};

}  // namespace reprise::motion
