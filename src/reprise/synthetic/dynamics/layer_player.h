// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// All layers of a body through one frame after another.

#pragma once

#include <memory>
#include <vector>

#include "reprise/synthetic/dynamics/dynamics.h"
#include "reprise/synthetic/dynamics/soft_layer.h"

namespace reprise::dynamics {

// Garments and hair with freedom are simulated; they collide with the skin, the shoes and the garments
// without.
class LayerPlayer {
 public:
  LayerPlayer(const std::vector<BodyLayer>& layers, const DynamicsOptions& options, double frames_per_second);

  // Everything at rest where the skin says; one entry a layer.
  void start(const std::vector<Points>& skinned);

  // Plays one frame. `skinned_after`: the layers one frame after its end. The first call after `start` plays
  // a frame in which the body stands still, so that call k ends where the points of call k - 1 (or of
  // `start`) are.
  void advance(const std::vector<Points>& skinned_after);

  // Places of all layers at the end of the frame.
  std::vector<Points> points();

  // The simulated layers: index into the layers, and how they are played.
  struct Simulated {
    std::size_t layer_idx = 0;
    std::unique_ptr<SoftLayer> soft;
  };
  const std::vector<Simulated>& simulated() const { return simulated_; }

 private:
  Points body_of(const std::vector<Points>& layers) const;

  FrameSettings settings_;
  std::vector<Simulated> simulated_;
  std::vector<std::size_t> body_layers_;
  std::vector<Points> end_, after_;  // skinned: at the end of the frame, and one frame after
};

}  // namespace reprise::dynamics
