// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/foot_planting.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/deform/blend.h"
#include "reprise/graph/transition.h"
#include "reprise/synthesis/feet_test_support.h"
#include "reprise/synthesis/leg_weights.h"
#include "reprise/synthesis/naturalness.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const GroundTransform elsewhere{.yaw = 2.0, .translation = {3.0, -1.5}};

double largest_difference(const MeshSequence& a, const MeshSequence& b) {
  double largest = 0.0;
  for (std::size_t f = 0; f < a.frame_count(); ++f)
    largest = std::max(largest, static_cast<double>((a.frame(f) - b.frame(f)).rowwise().norm().maxCoeff()));
  return largest;
}

class FootPlanting : public ::testing::Test {
 protected:
  // Walks, and slides sideways as it does.
  static MeshSequence sliding_walk() {
    MeshSequence walk = test::replay(test::performer_with_feet(), "walk");
    for (std::size_t f = 0; f < walk.frame_count(); ++f)
      walk.frame(f).col(0).array() += 0.004F * static_cast<float>(f);
    return walk;
  }

  // Stands; then goes over to standing elsewhere: each foot is another 8 cm away and turned by 0.3 radians.
  static MeshSequence shuffle() {
    const PerformanceDatabase& database = test::performer_with_feet();
    const PoissonReconstruction poisson(database.topology(), database.clip(0).frame(0));
    MeshSequence result = test::replay(database, "stand", 0, 39);
    const MeshSequence other = test::moved_animation(test::replay(database, "stand", 0, 39),
                                                     {.yaw = 0.3, .translation = {0.08, 0.0}});
    std::vector<FrameOrigin> origins = result.origins();
    for (std::size_t f = 12; f < 40; ++f) {
      if (f >= 28) {
        result.frame(f) = other.frame(f);
        continue;
      }
      const double alpha = blend_weight(BlendProfile::smooth, static_cast<int>(f) - 20, 9);
      origins[f].partner_clip = "stand";
      origins[f].partner_frame_idx = static_cast<std::int32_t>(f);
      origins[f].partner_weight = alpha;
      blend_frames(poisson, std::as_const(result).frame(f), other.frame(f), alpha, result.frame(f));
    }
    result.set_origins(std::move(origins));
    return result;
  }

  const PerformanceDatabase& database_ = test::performer_with_feet();
  FootPlanter planter_{database_};
};

TEST_F(FootPlanting, CapturedMotionIsNotTouched) {
  for (const MeshSequence& clip : database_.clips()) {
    MeshSequence replay = test::replay(database_, clip.name());
    const PlantingReport report = planter_.plant(replay);
    EXPECT_EQ(replay.data(), clip.data()) << clip.name();
    EXPECT_EQ(report.largest_shift, 0.0) << clip.name();
  }
}

TEST_F(FootPlanting, CapturedMotionElsewhereIsNotTouched) {
  MeshSequence moved = test::moved_animation(test::replay(database_, "walk"), elsewhere);
  const std::vector<float> before = moved.data();
  planter_.plant(moved);
  EXPECT_EQ(moved.data(), before);
}

TEST_F(FootPlanting, SlidingFeetStandStill) {
  MeshSequence walk = sliding_walk();
  const Naturalness before = evaluate_naturalness(walk, database_);
  const PlantingReport report = planter_.plant(walk);
  const Naturalness after = evaluate_naturalness(walk, database_);
  ASSERT_GT(before.foot_drift, before.shown_foot_drift + 8.0) << "4 mm a frame are 10 cm/s";
  EXPECT_LT(after.foot_drift, after.shown_foot_drift + 0.5);
  EXPECT_GT(report.largest_shift, 0.01);
  EXPECT_LT(report.largest_shift, 0.08)
      << "a stand of some 15 frames slides by 6 cm, half before, half after";
  EXPECT_GT(report.mean_shift, 0.0);
  EXPECT_LT(report.mean_shift, report.largest_shift);
}

TEST_F(FootPlanting, FeetThatStandInBothFramesOfABlendStayPlanted) {
  MeshSequence motion = shuffle();
  const Naturalness before = evaluate_naturalness(motion, database_);
  planter_.plant(motion);
  const Naturalness after = evaluate_naturalness(motion, database_);
  ASSERT_GT(before.blend_foot_drift, 10.0);
  // Both feet stand from the first frame to the last, 10 cm further on, and nothing may move there: all that
  // can be done is to spread the way over all frames.
  EXPECT_LT(after.blend_foot_drift, 0.6 * before.blend_foot_drift);
}

TEST_F(FootPlanting, BlendThatIsFollowedByAStepStaysPlanted) {
  // As `shuffle`, but then walks off: the feet have swings in which to make up for it.
  const PoissonReconstruction poisson(database_.topology(), database_.clip(0).frame(0));
  MeshSequence motion = test::replay(database_, "walk");
  const MeshSequence other =
      test::moved_animation(test::replay(database_, "walk"), {.yaw = 0.0, .translation = {0.06, 0.03}});
  std::vector<FrameOrigin> origins = motion.origins();
  const std::size_t middle = motion.frame_count() / 2;
  for (std::size_t f = middle - 5; f < motion.frame_count(); ++f) {
    if (f > middle + 5) {
      motion.frame(f) = other.frame(f);
      continue;
    }
    const double alpha =
        blend_weight(BlendProfile::smooth, static_cast<int>(f) - static_cast<int>(middle), 6);
    origins[f].partner_clip = "walk";
    origins[f].partner_frame_idx = static_cast<std::int32_t>(f);
    origins[f].partner_weight = alpha;
    blend_frames(poisson, std::as_const(motion).frame(f), other.frame(f), alpha, motion.frame(f));
  }
  motion.set_origins(std::move(origins));
  const Naturalness before = evaluate_naturalness(motion, database_);
  planter_.plant(motion);
  const Naturalness after = evaluate_naturalness(motion, database_);
  ASSERT_GT(before.blend_foot_drift, 10.0);
  EXPECT_LT(after.blend_foot_drift, after.shown_foot_drift + 1.0);
  EXPECT_LT(after.foot_drift, after.shown_foot_drift + 0.5);
  EXPECT_LT(after.pop_ratio, 1.2);
  EXPECT_LT(after.edge_stretch_p99, 1.05 * before.edge_stretch_p99);
}

TEST_F(FootPlanting, FirstAndLastFrameStay) {
  MeshSequence walk = sliding_walk();
  planter_.plant(walk);
  const std::size_t last = walk.frame_count() - 1;
  EXPECT_EQ(walk.frame(0), sliding_walk().frame(0));
  EXPECT_EQ(walk.frame(last), sliding_walk().frame(last));
}

TEST_F(FootPlanting, RigidPlacementOfTheWholeMotionCommutes) {
  MeshSequence moved = test::moved_animation(sliding_walk(), elsewhere);
  planter_.plant(moved);
  MeshSequence walk = sliding_walk();
  planter_.plant(walk);
  EXPECT_LT(largest_difference(moved, test::moved_animation(walk, elsewhere)), 2e-5);
}

TEST_F(FootPlanting, OnlyTheLegsMove) {
  const MeshSequence before = sliding_walk();
  MeshSequence after = before;
  planter_.plant(after);
  const Eigen::MatrixXd weights = leg_weights(database_, planter_.contacts());
  std::size_t still = 0;
  std::size_t moved = 0;
  for (Eigen::Index v = 0; v < weights.rows(); ++v) {
    bool same = true;
    for (std::size_t f = 0; f < before.frame_count(); ++f)
      same = same && before.frame(f).row(v) == std::as_const(after).frame(f).row(v);
    if (weights.row(v).isZero(0.0)) {
      EXPECT_TRUE(same) << "vertex " << v;
      ++still;
    } else if (!same) {
      ++moved;
    }
  }
  EXPECT_GT(still, weights.rows() / 3);
  EXPECT_GT(moved, weights.rows() / 10);
}

TEST_F(FootPlanting, AFootIsMovedAsOnePiece) {
  const MeshSequence before = shuffle();
  MeshSequence after = before;
  planter_.plant(after);
  for (const std::vector<std::int32_t>& sole : planter_.contacts().feet()) {
    for (std::size_t f = 0; f < before.frame_count(); ++f) {
      const auto a = before.frame(f);
      const auto b = std::as_const(after).frame(f);
      for (std::size_t i = 1; i < sole.size(); ++i) {
        EXPECT_NEAR((a.row(sole[i]) - a.row(sole[0])).norm(), (b.row(sole[i]) - b.row(sole[0])).norm(),
                    1e-5F);
      }
    }
  }
}

TEST_F(FootPlanting, NormalsFollowTheSurface) {
  MeshSequence walk = sliding_walk();
  for (std::size_t f = 0; f < walk.frame_count(); ++f)
    walk.mutable_normals(f) = vertex_normals(*walk.topology(), std::as_const(walk).frame(f));
  planter_.plant(walk);
  for (std::size_t f = 0; f < walk.frame_count(); f += 7) {
    const Positions expected = vertex_normals(*walk.topology(), std::as_const(walk).frame(f));
    // Vertices next to the legs keep their own: their triangles hardly turn.
    EXPECT_LT((walk.normals(f) - expected).rowwise().norm().maxCoeff(), 0.02F);
  }
}

TEST_F(FootPlanting, SameBytesForAnyNumberOfThreads) {
  MeshSequence serial = sliding_walk();
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    FootPlanter(database_).plant(serial);
  }
  const tbb::global_control many(tbb::global_control::max_allowed_parallelism, 4);
  MeshSequence parallel = sliding_walk();
  FootPlanter(database_).plant(parallel);
  EXPECT_EQ(parallel.data(), serial.data());
}

TEST_F(FootPlanting, PerformerWithoutFeetIsNotTouched) {
  PerformanceDatabase database;
  MeshSequence clip = test::walk("a", 12);
  for (std::size_t f = 0; f < clip.frame_count(); ++f) clip.frame(f).col(1).array() += static_cast<float>(f);
  database.add(std::move(clip));
  MeshSequence flight = test::replay(database, "a");
  const std::vector<float> before = flight.data();
  const PlantingReport report = FootPlanter(database, {.height = 0.0}).plant(flight);
  EXPECT_EQ(flight.data(), before);
  EXPECT_EQ(report.largest_shift, 0.0);
  EXPECT_EQ(report.mean_shift, 0.0);
}

TEST_F(FootPlanting, MotionOfTwoFramesStays) {
  MeshSequence two = test::replay(database_, "walk", 3, 4);
  two.frame(1).col(0).array() += 0.1F;
  const std::vector<float> before = two.data();
  planter_.plant(two);
  EXPECT_EQ(two.data(), before);
}

TEST_F(FootPlanting, MotionOfUnknownOriginIsRefused) {
  MeshSequence captured = database_.clip(0);
  EXPECT_THAT([&] { planter_.plant(captured); }, ThrowsMessage<InvalidArgument>(HasSubstr("has no origins")));
  MeshSequence foreign = test::walk("x", 2);
  foreign.set_origins({{.clip = "walk", .frame_idx = 0}, {.clip = "walk", .frame_idx = 1}});
  EXPECT_THROW(planter_.plant(foreign), InvalidArgument);
  MeshSequence nobody = test::replay(database_, "walk", 0, 1);
  nobody.set_origins({{.clip = "walk", .frame_idx = 0}, {.clip = "nobody", .frame_idx = 1}});
  EXPECT_THAT([&] { planter_.plant(nobody); }, ThrowsMessage<InvalidArgument>(HasSubstr("no clip 'nobody'")));
}

}  // namespace
}  // namespace reprise
