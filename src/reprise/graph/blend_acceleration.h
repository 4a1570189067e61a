// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// How fast a linear blend of two clips makes the surface change its velocity.

#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "reprise/graph/window_weights.h"
#include "reprise/sequence/mesh_sequence.h"

namespace reprise {

// Sampled vertices of all frames of a clip. Columns are frames; rows are x of all samples, then y, then z.
struct SampledClip {
  SampledClip(const MeshSequence& clip, std::span<const std::int32_t> vertices);

  Eigen::Index sample_count() const { return positions.rows() / 3; }
  int frame_count() const { return static_cast<int>(positions.cols()); }

  Eigen::ArrayXXf positions;
  // Second difference at each frame; the clip's ends stand for what lies beyond.
  Eigen::ArrayXXf accelerations;
};

// The frames around (m, n) on common ground, ready to be blended with any window. Keeps its memory from one
// place to the next.
class BlendWindow {
 public:
  // Of a clip pair. Half windows up to `max_half_window`.
  BlendWindow(const SampledClip& source, const SampledClip& target, int max_half_window);

  // Goes to (m, n), looks at the first `sample_count` samples alone. Requires that the half windows asked
  // for afterwards fit into both clips.
  void place(int m, int n, const GroundTransform& source_from_target, Eigen::Index sample_count);

  // Square of the largest acceleration of a sample, m/frame^2, from the first to the last frame of the
  // window, the pure frames outside included so that a corner at either end counts. What was found so far,
  // without looking further, once that is above `limit`.
  float square_peak(const WindowWeights& weights, float limit = std::numeric_limits<float>::infinity());

 private:
  // Moved target minus source, k frames from the middle.
  const float* difference(int k);

  const SampledClip& source_;
  const SampledClip& target_;
  int reach_;
  int m_ = 0;
  int n_ = 0;
  Eigen::Index count_ = 0;
  float cos_yaw_ = 1.0F;
  float sin_yaw_ = 0.0F;
  Eigen::Vector3f source_origin_;  // near the surface, where float32 keeps the most digits
  Eigen::Vector3f target_origin_;
  Eigen::Vector3f offset_;  // of the moved target origin from the source origin
  Eigen::ArrayXXf differences_;
  std::vector<bool> is_ready_;  // of each column
};

}  // namespace reprise
