// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/skeleton_comparison.h"

#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "reprise/path/retrieval_case_test_support.h"

namespace reprise::path_detail {
namespace {

using test::moved;
using test::random_move;
using test::random_track;

double squared_difference(const Eigen::MatrixX3d& query, const Eigen::MatrixX3d& captured, double yaw,
                          const std::vector<double>& weights) {
  // The best translation for a yaw moves the weighted means onto each other.
  const Eigen::MatrixX3d turned = moved({.yaw = yaw}, captured);
  Eigen::RowVector3d mean = Eigen::RowVector3d::Zero();
  double sum = 0.0;
  for (Eigen::Index j = 0; j < query.rows(); ++j) {
    mean += weights[static_cast<std::size_t>(j)] * (query.row(j) - turned.row(j));
    sum += weights[static_cast<std::size_t>(j)];
  }
  mean /= sum;
  mean.y() = 0.0;
  double result = 0.0;
  for (Eigen::Index j = 0; j < query.rows(); ++j) {
    result += weights[static_cast<std::size_t>(j)] * (query.row(j) - turned.row(j) - mean).squaredNorm();
  }
  return result;
}

// By trying turns: the finest of a hundred, then between its neighbours.
double best_yaw(const Eigen::MatrixX3d& query, const Eigen::MatrixX3d& captured,
                const std::vector<double>& weights) {
  double center = 0.0;
  double reach = std::numbers::pi;
  while (reach > 1e-9) {
    double best = std::numeric_limits<double>::infinity();
    double best_at = center;
    for (int i = -50; i <= 50; ++i) {
      const double yaw = center + reach * i / 50.0;
      const double difference = squared_difference(query, captured, yaw, weights);
      if (difference < best) {
        best = difference;
        best_at = yaw;
      }
    }
    center = best_at;
    reach /= 20.0;
  }
  return center;
}

class SkeletonComparisonTest : public ::testing::Test {
 protected:
  static constexpr int joint_count = 21;
  static constexpr int frame_count = 37;  // no multiple of the lanes

  MovingSkeleton captured(int frame) const {
    return moving_skeleton(track_, static_cast<std::size_t>(frame));
  }
  MovingSkeleton query(int frame) const {
    return moving_skeleton(query_track_, static_cast<std::size_t>(frame));
  }

  std::mt19937 random_{11};
  JointTrack track_ = random_track(frame_count, joint_count, random_);
  JointTrack query_track_ = random_track(frame_count, joint_count, random_);
  std::vector<double> equal_ = std::vector<double>(joint_count, 1.0);
  std::vector<double> uneven_ = [this] {
    std::vector<double> weights;
    for (int j = 0; j < joint_count; ++j) weights.push_back(j % 5 == 0 ? 0.0 : 0.1 * (j + 1));
    std::shuffle(weights.begin(), weights.end(), random_);
    return weights;
  }();
};

TEST_F(SkeletonComparisonTest, TheAlignmentIsTheBestOfAllTurns) {
  for (const std::vector<double>& weights : {equal_, uneven_}) {
    for (int f = 0; f < frame_count; f += 6) {
      const Eigen::MatrixX3d& x = track_[static_cast<std::size_t>(f)];
      const Eigen::MatrixX3d& q = query_track_[static_cast<std::size_t>(f)];
      const double yaw = best_yaw(q, x, weights);
      const GroundTransform turn{.yaw = yaw};
      const Eigen::MatrixX3d turned = moved(turn, x);
      Eigen::RowVector3d shift = Eigen::RowVector3d::Zero();
      double weight_sum = 0.0;
      for (Eigen::Index j = 0; j < joint_count; ++j) {
        shift += weights[static_cast<std::size_t>(j)] * (q.row(j) - turned.row(j));
        weight_sum += weights[static_cast<std::size_t>(j)];
      }
      shift /= weight_sum;
      shift.y() = 0.0;
      const Eigen::MatrixX3d velocity = moved(turn, captured(f).velocities);
      double expected = 0.0;
      for (Eigen::Index j = 0; j < joint_count; ++j) {
        expected += weights[static_cast<std::size_t>(j)] *
                    ((q.row(j) - turned.row(j) - shift).norm() +
                     2.5 * (query(f).velocities.row(j) - velocity.row(j)).norm());
      }
      // The least sum of squares is flat: trying turns finds it to the root of a double's precision.
      EXPECT_NEAR(skeleton_dissimilarity(query(f), captured(f), {.joints = weights, .velocity = 2.5}),
                  expected, 1e-5);
    }
  }
}

TEST_F(SkeletonComparisonTest, MovesOnTheGroundDoNotCountAndHeightsDo) {
  const SkeletonWeights weights{.joints = uneven_, .velocity = 1.5};
  const double expected = skeleton_dissimilarity(query(3), captured(5), weights);
  for (int i = 0; i < 20; ++i) {
    const GroundTransform move = random_move(random_);
    const MovingSkeleton elsewhere{.joints = moved(move, query(3).joints),
                                   .velocities = moved({.yaw = move.yaw}, query(3).velocities)};
    EXPECT_NEAR(skeleton_dissimilarity(elsewhere, captured(5), weights), expected, 1e-9);
    EXPECT_NEAR(skeleton_dissimilarity(query(3), elsewhere, weights), 0.0, 1e-9);
  }
  MovingSkeleton lifted = captured(5);
  lifted.joints.col(1).array() += 0.25;
  EXPECT_NEAR(skeleton_dissimilarity(captured(5), lifted, weights), 0.25 * weights.sum(), 1e-9);
}

TEST_F(SkeletonComparisonTest, FastRowsAreThoseOfDoublePrecision) {
  SkeletonTable table(frame_count, joint_count);
  for (int f = 0; f < frame_count; ++f) table.set(static_cast<std::size_t>(f), captured(f), equal_);
  const SkeletonTable recentred = table.recentred(uneven_);
  for (const bool even : {true, false}) {
    for (const double velocity : {0.0, 3.0}) {
      const SkeletonWeights weights{.joints = even ? equal_ : uneven_, .velocity = velocity};
      for (int k = 0; k < frame_count; ++k) {
        const QuerySkeleton skeleton(query(k), weights);
        std::vector<float> row(table.block_count() * SkeletonTable::lanes);
        for (std::size_t block = 0; block < table.block_count(); ++block) {
          (even ? table : recentred).compare(skeleton, block, row.data() + block * SkeletonTable::lanes);
        }
        for (int f = 0; f < frame_count; ++f) {
          const double expected = skeleton_dissimilarity(query(k), captured(f), weights);
          EXPECT_NEAR(row[static_cast<std::size_t>(f)], expected, 1e-6 * weights.sum() * (1.0 + velocity));
        }
      }
    }
  }
}

TEST_F(SkeletonComparisonTest, SkeletonsWithoutADirectionKeepTheirs) {
  // Joints on one plumb line have no yaw.
  Eigen::MatrixX3d line = Eigen::MatrixX3d::Zero(3, 3);
  line.col(1) << 0.0, 1.0, 1.7;
  Eigen::MatrixX3d arm = line;
  arm(2, 0) = 0.3;
  const std::vector<double> weights(3, 1.0);
  const MovingSkeleton a{.joints = line, .velocities = Eigen::MatrixX3d::Zero(3, 3)};
  const MovingSkeleton b{.joints = arm, .velocities = Eigen::MatrixX3d::Zero(3, 3)};
  SkeletonTable table(1, 3);
  table.set(0, a, weights);
  std::vector<float> row(SkeletonTable::lanes);
  table.compare(QuerySkeleton(b, {.joints = weights}), 0, row.data());
  EXPECT_NEAR(skeleton_dissimilarity(b, a, {.joints = weights}), 0.4, 1e-12);  // 0.1 + 0.1 + 0.2
  EXPECT_NEAR(row[0], 0.4, 1e-6);
}

}  // namespace
}  // namespace reprise::path_detail
