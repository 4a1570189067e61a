// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/graph/pair_alignment.h"

#include <array>
#include <cmath>

#include "reprise/core/parallel.h"

namespace reprise {
namespace {

// Coordinates stand interleaved, x y z x y z: sums are kept apart by their place in a block whose length
// suits both the threes and the vector registers.
constexpr Eigen::Index lanes = 24;

struct Block {
  std::array<double, lanes + 2> values{};  // the last two stay zero: neighbours of the last lane

  void load(const float* from, Eigen::Index count, const std::array<double, lanes>& origin) {
    if (count == lanes) {
      for (std::size_t i = 0; i < lanes; ++i) values[i] = static_cast<double>(from[i]) - origin[i];
      return;
    }
    values.fill(0.0);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      values[i] = static_cast<double>(from[i]) - origin[i];
    }
  }
};

std::array<double, lanes> repeated(const Eigen::Vector3d& p) {
  std::array<double, lanes> result{};
  for (std::size_t i = 0; i < lanes; ++i) result[i] = p[static_cast<Eigen::Index>(i % 3)];
  return result;
}

}  // namespace

PairAlignment::PairAlignment(const PerformanceDatabase& database) : database_(database) {
  for (const MeshSequence& clip : database.clips()) {
    std::vector<Eigen::Vector3d>& of_clip = centroids_.emplace_back(clip.frame_count());
    parallel_for(0, clip.frame_count(), [&](std::size_t f) { of_clip[f] = centroid(clip.frame(f)); });
  }
}

GroundTransform PairAlignment::source_from_target(std::size_t source_clip, int m, std::size_t target_clip,
                                                  int n) const {
  const auto source_frame = static_cast<std::size_t>(m);
  const auto target_frame = static_cast<std::size_t>(n);
  const PositionsView a = database_.clip(source_clip).frame(source_frame);
  const PositionsView b = database_.clip(target_clip).frame(target_frame);
  const Eigen::Vector3d& centre_a = centroids_[source_clip][source_frame];
  const Eigen::Vector3d& centre_b = centroids_[target_clip][target_frame];
  const std::array<double, lanes> origin_a = repeated(centre_a);
  const std::array<double, lanes> origin_b = repeated(centre_b);
  Block A;
  Block B;
  std::array<double, lanes> same{};  // a_x b_x, unused, a_z b_z
  std::array<double, lanes> turn{};  // a_x b_z - a_z b_x, unused, unused
  for (Eigen::Index first = 0; first < a.size(); first += lanes) {
    const Eigen::Index count = std::min(lanes, a.size() - first);
    A.load(a.data() + first, count, origin_a);
    B.load(b.data() + first, count, origin_b);
    for (std::size_t i = 0; i < lanes; ++i) {
      same[i] += A.values[i] * B.values[i];
      turn[i] += A.values[i] * B.values[i + 2] - A.values[i + 2] * B.values[i];
    }
  }
  // sum_v conj(b_v) a_v with z + i x about the centroids, see `align_on_ground`.
  double real = 0.0;
  double imaginary = 0.0;
  for (std::size_t i = 0; i < lanes; i += 3) {
    real += same[i] + same[i + 2];
    imaginary += turn[i];
  }
  GroundTransform transform{.yaw = std::atan2(imaginary, real)};
  const Eigen::Vector3d turned = transform * centre_b;  // the translation is still zero
  transform.translation = {centre_a.x() - turned.x(), centre_a.z() - turned.z()};
  return transform;
}

}  // namespace reprise
