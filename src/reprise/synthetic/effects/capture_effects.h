// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What a real capture adds to the truth: reconstruction noise, drift along the surface, light that depends on
// the pose.

#pragma once

#include <cstdint>

#include "reprise/sequence/mesh_sequence.h"

namespace reprise {

// Noise and drift are smooth random fields: the correlation of two vertices falls with their distance d along
// the surface as exp(-d^2 / (2 length^2)), and that of two frames with the time between them likewise.
struct CaptureEffects {
  double noise = 0.0;          // metres, standard deviation along the normal
  double noise_length = 0.06;  // metres
  double noise_time = 0.08;    // seconds
  double drift =
      0.0;  // metres, standard deviation of a vertex's sliding, along each direction of the surface
  double drift_length = 0.25;  // metres
  double drift_time = 1.0;     // seconds
  bool studio_lights = false;  // a colour a vertex and frame, as seen under lights that stand still
  std::uint64_t seed = 1;

  bool any() const { return noise > 0.0 || drift > 0.0 || studio_lights; }
};

// Throws `InvalidArgument` for an amount, length or time that is negative or not finite, or for a length or
// time of zero where there is an amount.
void validate(const CaptureEffects& effects);

// Applies the effects to a clip, frame by frame. `rest`: N x 3, the surface at rest, on which distances are
// measured. The same seed, clip name, clip and options give the same result on any number of threads. Throws
// `InvalidArgument` for an amount, length or time that is negative or not finite, for a length or time of
// zero where there is an amount, or for lights on a clip without colours.
void apply_capture_effects(MeshSequence& clip, const Positions& rest, const CaptureEffects& effects);

}  // namespace reprise
