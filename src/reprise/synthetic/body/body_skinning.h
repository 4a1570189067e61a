// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// How vertices follow the bones of the body.

#pragma once

#include <array>
#include <vector>

#include "reprise/synthetic/body/body_rig.h"
#include "reprise/synthetic/body/dressed_body.h"

namespace reprise::body {

struct BoneWeights {
  static constexpr std::size_t capacity = 6;
  std::array<int, capacity> bones{};
  std::array<double, capacity> weights{};  // largest first, sum 1; unused ones are 0
};

// The sum of weighted bones, the same bone more than once allowed: the largest ones, with sum 1. Throws
// `InvalidArgument` unless the sum is positive.
BoneWeights gather(const std::vector<std::pair<int, double>>& weighted);
// A weighted mean of such weights.
BoneWeights mean(const std::vector<std::pair<const BoneWeights*, double>>& weighted);

// Every point where the bones take it.
Points skin_points(const Points& rest, const std::vector<BoneWeights>& weights,
                   const std::vector<RigidTransform>& bones);

}  // namespace reprise::body
