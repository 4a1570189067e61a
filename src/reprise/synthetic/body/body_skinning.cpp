// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/body/body_skinning.h"

#include <algorithm>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/math/dual_quaternion.h"

namespace reprise::body {

BoneWeights gather(const std::vector<std::pair<int, double>>& weighted) {
  std::vector<std::pair<int, double>> sums;
  for (const auto& [bone, weight] : weighted) {
    const auto found = std::find_if(sums.begin(), sums.end(), [&](const auto& s) { return s.first == bone; });
    if (found == sums.end()) {
      sums.emplace_back(bone, weight);
    } else {
      found->second += weight;
    }
  }
  std::sort(sums.begin(), sums.end(), [](const auto& a, const auto& b) {
    return a.second != b.second ? a.second > b.second : a.first < b.first;
  });
  BoneWeights result;
  double total = 0.0;
  for (std::size_t i = 0; i < std::min(sums.size(), BoneWeights::capacity); ++i) {
    result.bones[i] = sums[i].first;
    result.weights[i] = std::max(0.0, sums[i].second);
    total += result.weights[i];
  }
  if (!(total > 0.0)) throw InvalidArgument("expected bone weights with a positive sum, found none");
  for (double& weight : result.weights) weight /= total;
  return result;
}

BoneWeights mean(const std::vector<std::pair<const BoneWeights*, double>>& weighted) {
  std::vector<std::pair<int, double>> all;
  for (const auto& [weights, factor] : weighted) {
    for (std::size_t i = 0; i < BoneWeights::capacity; ++i) {
      if (weights->weights[i] > 0.0) all.emplace_back(weights->bones[i], factor * weights->weights[i]);
    }
  }
  return gather(all);
}

// Dual quaternion skinning (Kavan et al. 2007): joints keep their volume when they bend and twist.
Points skin_points(const Points& rest, const std::vector<BoneWeights>& weights,
                   const std::vector<RigidTransform>& bones) {
  std::vector<DualQuaternion> dual(bones.size());
  for (std::size_t b = 0; b < bones.size(); ++b)
    dual[b] = dual_quaternion(bones[b].rotation, bones[b].translation);
  Points points(rest.rows(), 3);
  constexpr std::size_t grain = 1024;
  parallel_for(
      0, static_cast<std::size_t>(rest.rows()),
      [&](std::size_t v) {
        const BoneWeights& w = weights[v];
        DualQuaternionSum sum(w.weights[0], dual[static_cast<std::size_t>(w.bones[0])]);
        for (std::size_t i = 1; i < BoneWeights::capacity && w.weights[i] > 0.0; ++i) {
          sum.add(w.weights[i], dual[static_cast<std::size_t>(w.bones[i])]);
        }
        const auto row = static_cast<Eigen::Index>(v);
        points.row(row) = carry(sum.sum(), rest.row(row).transpose()).transpose();
      },
      grain);
  return points;
}

}  // namespace reprise::body
