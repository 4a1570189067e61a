// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// c_skel (HSSMG Eq. 28): how far apart two skeletons are once they are aligned on the ground; for one pair,
// and for one skeleton against thousands.

#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace reprise::path_detail {

struct MovingSkeleton {
  Eigen::MatrixX3d joints;      // metres
  Eigen::MatrixX3d velocities;  // metres a frame
};
// A frame of a track, its velocities by central differences over 3 frames to each side, fewer where the track
// ends.
MovingSkeleton moving_skeleton(const std::vector<Eigen::MatrixX3d>& track, std::size_t frame_idx);

struct SkeletonWeights {
  std::vector<double> joints;  // w_i
  double velocity = 0.0;       // frames: what a difference in velocity counts for, against one in position
  double sum() const;          // of w_i
};

// Eq. 28 in double precision: the sum of w_i times distance over the joints, after the yaw and ground
// translation of `captured` that make the weighted sum of squared distances least; and the differences of the
// velocities, turned alike, with w_i times the weight of velocity. Metres.
double skeleton_dissimilarity(const MovingSkeleton& query, const MovingSkeleton& captured,
                              const SkeletonWeights& weights);

// A skeleton of the query, made ready for comparisons with a table.
class QuerySkeleton {
 public:
  QuerySkeleton(const MovingSkeleton& skeleton, const SkeletonWeights& weights);

 private:
  friend class SkeletonTable;
  struct Term {
    float x, y, z, weight;
  };
  std::vector<Term> terms_;  // the joints, relative to their weighted mean on the ground; then velocities
  std::vector<Eigen::Vector2f> weighted_;  // weight * (x, z) of the joints
};

// Skeletons in single precision, in blocks of `lanes`: within a block the x of all lanes stand side by side
// for each joint, then the y, then the z; after the joints their velocities likewise. A block stays in
// registers and the first cache while it is compared.
class SkeletonTable {
 public:
  static constexpr std::size_t lanes = 16;

  SkeletonTable(std::size_t skeleton_count, std::size_t joint_count);

  // Writes one skeleton. Different skeletons may be written from different threads.
  void set(std::size_t skeleton_idx, const MovingSkeleton& skeleton, const std::vector<double>& weights);
  // The same skeletons relative to their means under other weights; comparisons take the weights that the
  // table was made with.
  SkeletonTable recentred(const std::vector<double>& weights) const;

  std::size_t block_count() const { return block_count_; }
  // Eq. 28 between the query's skeleton and those of a block: `lanes` numbers, metres. Those beyond the last
  // skeleton mean nothing.
  void compare(const QuerySkeleton& query, std::size_t block_idx, float* dissimilarities) const;

 private:
  // Of a joint, or (joint_count_ later) of its velocity.
  float* coordinates(std::size_t skeleton_idx, std::size_t row_idx);

  std::size_t joint_count_;
  std::size_t block_count_;
  std::vector<float, Eigen::aligned_allocator<float>> values_;
};

}  // namespace reprise::path_detail
