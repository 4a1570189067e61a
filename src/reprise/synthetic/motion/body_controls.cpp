// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/motion/body_controls.h"

namespace reprise::motion {

namespace {

// Seconds by which a channel lags behind the trunk's.
double lag(int channel) {
  if (channel == head_yaw || channel == head_list || channel == head_tilt) return 0.03;
  if (channel < knee) return 0.0;
  switch ((channel - knee) % side_channels + knee) {
    case elbow:
    case palm_in_twist:
      return 0.03;
    case wrist:
      return 0.06;
    default:
      return 0.0;
  }
}

}  // namespace

Controls lerp(const Controls& a, const Controls& b, double u) {
  Controls result;
  for (int c = 0; c < channel_count; ++c) result[c] = lerp(a[c], b[c], u);
  return result;
}

Controls changed(Controls controls, Changes changes) {
  for (const auto& [channel, value] : changes) controls[channel] = value;
  return controls;
}

Controls mirrored(const Controls& controls) {
  Controls result = controls;
  for (const Channel c :
       {heading, pelvis_yaw, pelvis_list, chest_yaw, chest_list, head_yaw, head_list, shift_x})
    result[c] = -controls[c];
  result[left_weight] = 1.0 - controls[left_weight];
  for (int c = knee; c < knee + side_channels; ++c) {
    result[c] = controls[c + side_channels];
    result[c + side_channels] = controls[c];
  }
  return result;
}

KeyedControls::KeyedControls(const std::vector<KeyPose>& poses, double smoothing) {
  for (int c = 0; c < channel_count; ++c) {
    std::vector<Key> keys;
    for (const KeyPose& pose : poses) keys.push_back({pose.time + lag(c), pose.controls[c]});
    curves_.emplace_back(std::move(keys), smoothing);
  }
}

Controls KeyedControls::operator()(double time) const {
  Controls controls;
  for (int c = 0; c < channel_count; ++c) controls[c] = curves_[static_cast<std::size_t>(c)](time);
  return controls;
}

}  // namespace reprise::motion
