// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The small continuous correction after the discrete optimum: a path is played a little faster or slower and
// walks a little longer or shorter, until time and distance are those asked for.

#pragma once

#include "reprise/deform/gradient_field.h"
#include "reprise/path/keyframe_query.h"

namespace reprise {

struct CorrectionOptions {
  double max_retiming = 0.15;  // share by which the duration may change, in [0, 0.5]
  double max_stretch = 0.4;    // share by which the ground trajectory's length may change, in [0, 0.5]
};

// What will be done to a path, and what then comes out.
struct Correction {
  int frame_count = 0;    // frames after retiming
  double stretch = 1.0;   // new length of the ground trajectory over its old one
  double distance = 0.0;  // metres, then
  double time = 0.0;      // seconds, then
};

// As close to the targets (metres, seconds) as the limits allow; the time to half a frame. A path that does
// not travel (less than 5 cm) is not stretched, one of a single frame not retimed. Throws `InvalidArgument`
// naming the option or target that is out of range.
Correction plan_correction(const MotionPath& path, double target_distance, double target_time,
                           double frames_per_second, const CorrectionOptions& options = {});

// `sequence` played in `frame_count` frames at an even pace. First and last frame stay, and so does what
// falls on a frame; others lie between two: positions by a cubic in the gradient field (inbetweens.h),
// colours linearly, computed normals, and the origin of the nearer frame. Parallel, the same bits for any
// number of threads. Throws `InvalidArgument` for fewer than two frames, unless there is one and stays one.
MeshSequence retimed(const MeshSequence& sequence, int frame_count, const PoissonReconstruction& poisson);

// Moves each frame on the ground so that the trajectory of centres keeps its shape and is `distance` metres
// long: steps are scaled alike, the first frame stays. No effect on motion that does not travel (less than
// 5 cm). Throws `InvalidArgument` if `distance` is negative or not finite.
void stretch_trajectory(MeshSequence& sequence, double distance);

}  // namespace reprise
