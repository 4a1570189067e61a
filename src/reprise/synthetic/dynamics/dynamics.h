// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Cloth and hair that move on their own against the moving body.

#pragma once

#include <functional>
#include <vector>

#include "reprise/synthetic/body/dressed_body.h"
#include "reprise/synthetic/motion/performer_motion.h"

namespace reprise {

struct DynamicsOptions {
  int substeps = 20;               // a frame of 1/25 s; scaled for other rates
  double cloth_thickness = 0.004;  // metres kept between cloth and body
  double wind = 0.0;               // m/s along +X: air that moves
};

// Throws `InvalidArgument` for an option out of range.
void validate(const DynamicsOptions& options);

// Plays the clip with all layers of the body: skinned layers follow `DressedBody::skin`, those with `freedom`
// are simulated (position-based, XPBD) from the lead-in on. Calls `frame(frame_idx, layer_points)` for every
// frame after the lead-in, in order; `layer_points` has one entry a layer. Deterministic whatever the number
// of threads.
void simulate(
    const DressedBody& body, const PerformerClip& clip, const DynamicsOptions& options,
    const std::function<void(std::size_t frame_idx, const std::vector<Points>& layer_points)>& frame);

}  // namespace reprise
