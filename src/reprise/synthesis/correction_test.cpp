// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/correction.h"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

constexpr CorrectionOptions tenth{.max_retiming = 0.1, .max_stretch = 0.1};

MotionPath path_of(int frame_count, double distance) {
  MotionPath path;
  path.frame_count = frame_count;
  path.time = frame_count / 25.0;
  path.distance = distance;
  return path;
}

TEST(PlanCorrection, TargetsWithinTheLimitsAreMetTheTimeToHalfAFrame) {
  for (const double distance : {9.01, 9.5, 10.0, 10.7, 10.99}) {
    for (const double time : {3.61, 3.99, 4.0, 4.013, 4.39}) {
      const Correction c = plan_correction(path_of(100, 10.0), distance, time, 25.0, tenth);
      EXPECT_NEAR(c.distance, distance, 1e-12);
      EXPECT_NEAR(c.stretch, distance / 10.0, 1e-12);
      EXPECT_LE(std::abs(c.time - time), 0.5 / 25.0 + 1e-12);
      EXPECT_DOUBLE_EQ(c.time, c.frame_count / 25.0);
    }
  }
}

TEST(PlanCorrection, TargetsOutOfReachAreApproachedUpToTheLimits) {
  const MotionPath path = path_of(100, 10.0);
  const Correction least = plan_correction(path, 0.0, 0.0, 25.0, tenth);
  EXPECT_EQ(least.frame_count, 90);
  EXPECT_DOUBLE_EQ(least.distance, 9.0);
  const Correction most = plan_correction(path, 100.0, 100.0, 25.0, tenth);
  EXPECT_EQ(most.frame_count, 110);
  EXPECT_DOUBLE_EQ(most.distance, 11.0);
  const Correction wide = plan_correction(path, 100.0, 0.0, 25.0, {.max_retiming = 0.5, .max_stretch = 0.5});
  EXPECT_EQ(wide.frame_count, 50);
  EXPECT_DOUBLE_EQ(wide.distance, 15.0);
  const Correction none = plan_correction(path, 0.0, 100.0, 25.0, {.max_retiming = 0.0, .max_stretch = 0.0});
  EXPECT_EQ(none.frame_count, 100);
  EXPECT_DOUBLE_EQ(none.stretch, 1.0);
}

TEST(PlanCorrection, ShareOfAShortPathIsNeverExceeded) {
  for (int frames = 2; frames < 60; ++frames) {
    const int fewest = plan_correction(path_of(frames, 1.0), 1.0, 0.0, 25.0, tenth).frame_count;
    const int most = plan_correction(path_of(frames, 1.0), 1.0, 99.0, 25.0, tenth).frame_count;
    // In whole numbers: 10 fewest >= 9 frames and one less would break it.
    EXPECT_TRUE(10 * fewest >= 9 * frames && (fewest == 2 || 10 * (fewest - 1) < 9 * frames)) << frames;
    EXPECT_TRUE(10 * most <= 11 * frames && 10 * (most + 1) > 11 * frames) << frames;
  }
}

TEST(PlanCorrection, PathThatDoesNotTravelIsNotStretchedAndASingleFrameNotRetimed) {
  const Correction standing = plan_correction(path_of(100, 0.049), 5.0, 4.2, 25.0);
  EXPECT_EQ(standing.stretch, 1.0);
  EXPECT_EQ(standing.distance, 0.049);
  EXPECT_EQ(standing.frame_count, 105);
  const Correction single =
      plan_correction(path_of(1, 0.0), 0.0, 4.0, 25.0, {.max_retiming = 0.5, .max_stretch = 0.5});
  EXPECT_EQ(single.frame_count, 1);
  EXPECT_DOUBLE_EQ(single.time, 0.04);
}

TEST(PlanCorrection, BadOptionsAndTargetsAreNamed) {
  const auto plan = [](double distance, double time, double rate, CorrectionOptions options,
                       int frames = 10) {
    return [=] { plan_correction(path_of(frames, 1.0), distance, time, rate, options); };
  };
  // Share below zero.
  EXPECT_THAT(
      plan(1, 1, 25, {.max_retiming = -0.01}),
      ThrowsMessage<InvalidArgument>(HasSubstr("max_retiming must be a share from 0 to 0.5, found -0.01")));
  // Share above one half.
  EXPECT_THAT(
      plan(1, 1, 25, {.max_stretch = 0.51}),
      ThrowsMessage<InvalidArgument>(HasSubstr("max_stretch must be a share from 0 to 0.5, found 0.51")));
  // No number.
  EXPECT_THAT(plan(1, 1, 25, {.max_stretch = not_a_number}),
              ThrowsMessage<InvalidArgument>(HasSubstr("max_stretch")));
  // Target below zero, endless target.
  EXPECT_THAT(plan(-1, 1, 25, {}), ThrowsMessage<InvalidArgument>(HasSubstr("target distance")));
  EXPECT_THAT(plan(1, unlimited, 25, {}), ThrowsMessage<InvalidArgument>(HasSubstr("target time")));
  // Rate.
  EXPECT_THAT(plan(1, 1, 0, {}), ThrowsMessage<InvalidArgument>(HasSubstr("frames per second")));
  // No path.
  EXPECT_THAT(plan(1, 1, 25, {}, 0), ThrowsMessage<InvalidArgument>(HasSubstr("path is empty")));
}

// The body in `frame_count` frames over `duration` (in units of the motion), each vertex moved by
// `place(point, time)`.
MeshSequence motion(std::size_t frame_count, double duration,
                    const std::function<Eigen::Vector3d(const Eigen::Vector3d&, double)>& place) {
  static const test::Shape shape = test::body();
  MeshSequence clip("motion", shape.topology, frame_count, 25.0);
  for (std::size_t f = 0; f < frame_count; ++f) {
    const double time = duration * static_cast<double>(f) / static_cast<double>(frame_count - 1);
    for (Eigen::Index v = 0; v < shape.positions.rows(); ++v) {
      const Eigen::Vector3d point = shape.positions.row(v).cast<double>().transpose();
      clip.frame(f).row(v) = place(point, time).cast<float>().transpose();
    }
  }
  return clip;
}

// About an axis through the body's centroid.
Eigen::Vector3d turned(const Eigen::Vector3d& point, double angle) {
  static const Positions body = test::body().positions;
  static const Eigen::Vector3d center = centroid(PositionsView(body.data(), body.rows(), 3));
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, 2.0, -0.5).normalized();
  return center + Eigen::AngleAxisd(angle, axis) * (point - center);
}

double largest_difference(const MeshSequence& a, const MeshSequence& b) {
  double largest = 0.0;
  for (std::size_t f = 0; f < a.frame_count(); ++f) {
    largest = std::max(largest, static_cast<double>((a.frame(f) - b.frame(f)).rowwise().norm().maxCoeff()));
  }
  return largest;
}

class Retimed : public ::testing::Test {
 protected:
  MeshSequence walk_ = test::walk("walk", 31);
  PoissonReconstruction poisson_{walk_.topology(), std::as_const(walk_).frame(0)};
};

TEST_F(Retimed, BySameNumberOfFramesIsTheIdentity) {
  EXPECT_EQ(retimed(walk_, 31, poisson_).data(), walk_.data());
}

TEST_F(Retimed, FramesThatFallOnOldOnesAreKept) {
  const MeshSequence twice = retimed(walk_, 61, poisson_);
  for (std::size_t f = 0; f < 31; ++f) EXPECT_EQ(twice.frame(2 * f), walk_.frame(f));
  const MeshSequence half = retimed(walk_, 16, poisson_);
  for (std::size_t f = 0; f < 16; ++f) EXPECT_EQ(half.frame(f), walk_.frame(2 * f));
  for (const int count : {2, 7, 28, 30, 32, 34, 100}) {
    const MeshSequence other = retimed(walk_, count, poisson_);
    ASSERT_EQ(other.frame_count(), static_cast<std::size_t>(count));
    EXPECT_EQ(other.frame(0), walk_.frame(0));
    EXPECT_EQ(other.frame(other.frame_count() - 1), walk_.frame(30));
  }
}

TEST_F(Retimed, ConstantSpeedConstantAccelerationAndRigidTurnsAreMet) {
  const auto straight = [](const Eigen::Vector3d& p, double t) -> Eigen::Vector3d {
    return p + t * Eigen::Vector3d(0.5, 0.1, 2.0);
  };
  const auto faster = [](const Eigen::Vector3d& p, double t) -> Eigen::Vector3d {
    return p + t * t * Eigen::Vector3d(0.3, 0.0, 1.0);
  };
  const auto turning = [](const Eigen::Vector3d& p, double t) { return turned(p, 3.0 * t); };
  const auto winding_up = [](const Eigen::Vector3d& p, double t) { return turned(p, 3.0 * t * t); };
  const auto growing = [](const Eigen::Vector3d& p, double t) -> Eigen::Vector3d {
    return (1.0 + t * t) * p;
  };
  for (const int count : {6, 19, 21, 23, 50}) {
    const auto error = [&](const auto& place) {
      return largest_difference(retimed(motion(20, 1.0, place), count, poisson_),
                                motion(static_cast<std::size_t>(count), 1.0, place));
    };
    EXPECT_LT(error(straight), 2e-6) << count;
    EXPECT_LT(error(faster), 2e-6) << count;
    EXPECT_LT(error(growing), 5e-6) << count;
    EXPECT_LT(error(winding_up), 5e-6) << count;
    EXPECT_LT(error(turning), 5e-6) << count;
  }
}

TEST_F(Retimed, RigidTurnStaysRigidToTheLastDigit) {
  // 40 degrees a frame.
  const MeshSequence wheel =
      motion(10, 9.0 * 40.0 / 180.0 * std::numbers::pi, [](const auto& p, double t) { return turned(p, t); });
  const MeshSequence result = retimed(wheel, 23, poisson_);
  for (const Triangle& triangle : wheel.topology()->triangles) {
    const double length = (wheel.frame(0).row(triangle[0]) - wheel.frame(0).row(triangle[1])).norm();
    for (std::size_t f = 0; f < result.frame_count(); ++f) {
      ASSERT_NEAR((result.frame(f).row(triangle[0]) - result.frame(f).row(triangle[1])).norm(), length, 2e-6);
    }
  }
}

TEST_F(Retimed, ErrorFallsWithTheThirdPowerOfTheFrameTime) {
  const auto swaying = [](const Eigen::Vector3d& p, double t) -> Eigen::Vector3d {
    return turned(p, 0.5 * std::sin(6.0 * t) * p.y()) + Eigen::Vector3d(std::sin(5.0 * t), 0.0, t);
  };
  const auto error = [&](std::size_t frames) {
    return largest_difference(
        retimed(motion(frames + 1, 1.0, swaying), static_cast<int>(2 * frames + 1), poisson_),
        motion(2 * frames + 1, 1.0, swaying));
  };
  const double coarse = error(16);
  const double fine = error(32);
  EXPECT_GT(coarse, 1e-4) << "the test must have something to measure";
  EXPECT_GT(coarse / fine, 7.0);
}

TEST_F(Retimed, MovingTheMotionOnTheGroundMovesTheResult) {
  const GroundTransform elsewhere{.yaw = 2.0, .translation = {3.0, -1.5}};
  const MeshSequence moved_after = test::moved(retimed(walk_, 28, poisson_), elsewhere, "a");
  const MeshSequence moved_before = retimed(test::moved(walk_, elsewhere, "b"), 28, poisson_);
  EXPECT_LT(largest_difference(moved_after, moved_before), 5e-6);
}

TEST_F(Retimed, SameBytesForAnyNumberOfThreads) {
  const MeshSequence walk = test::walk("walk", 120);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const MeshSequence serial = retimed(walk, 131, poisson_);
  const tbb::global_control many(tbb::global_control::max_allowed_parallelism, 4);
  EXPECT_EQ(retimed(walk, 131, poisson_).data(), serial.data());
}

TEST_F(Retimed, OriginsAreThoseOfTheNearerFrame) {
  std::vector<FrameOrigin> origins;
  for (int f = 0; f < 31; ++f) origins.push_back({.clip = "walk", .frame_idx = f});
  walk_.set_origins(origins);
  const MeshSequence result = retimed(walk_, 34, poisson_);
  ASSERT_EQ(result.origins().size(), 34U);
  for (std::size_t f = 0; f < 34; ++f) {
    const double old_frame = static_cast<double>(f) * 30.0 / 33.0;
    EXPECT_LE(std::abs(result.origins()[f].frame_idx - old_frame), 0.5) << f;
  }
}

TEST_F(Retimed, ColoursAreMixedAndAConstantSetStaysOne) {
  const std::vector<Color> red(walk_.vertex_count(), Color{200, 0, 0});
  walk_.set_colors(red);
  EXPECT_FALSE(retimed(walk_, 61, poisson_).has_colors_per_frame());
  EXPECT_EQ(retimed(walk_, 61, poisson_).colors(60)[3], (Color{200, 0, 0}));
  std::vector<Color> fading;
  for (int f = 0; f < 31; ++f) {
    fading.insert(fading.end(), walk_.vertex_count(), Color{200, static_cast<std::uint8_t>(4 * f), 0});
  }
  walk_.set_colors(fading);
  const MeshSequence result = retimed(walk_, 61, poisson_);
  for (std::size_t f = 0; f < 61; ++f)
    EXPECT_EQ(result.colors(f)[3], (Color{200, static_cast<std::uint8_t>(2 * f), 0}));
}

TEST_F(Retimed, NormalsAreKeptWhereFramesAreAndComputedBetween) {
  for (std::size_t f = 0; f < 31; ++f) {
    walk_.mutable_normals(f).setZero();
    walk_.mutable_normals(f).col(1).setOnes();  // no computed normals look like that
  }
  const MeshSequence result = retimed(walk_, 61, poisson_);
  EXPECT_EQ(result.normals(20), walk_.normals(10));
  EXPECT_EQ(
      result.normals(21),
      vertex_normals(*result.topology(), PositionsView(result.frame(21).data(), result.frame(21).rows(), 3)));
  EXPECT_FALSE(retimed(test::walk("bare", 31), 61, poisson_).has_normals());
}

TEST_F(Retimed, CountsThatCannotBeAreRefused) {
  EXPECT_THAT([&] { retimed(walk_, 1, poisson_); },
              ThrowsMessage<InvalidArgument>(HasSubstr("the 31 frames of 'walk' in 1: expected 2 or more")));
  EXPECT_THROW(retimed(walk_, 0, poisson_), InvalidArgument);
  EXPECT_THROW(retimed(walk_, -3, poisson_), InvalidArgument);
  const MeshSequence single = test::walk("single", 1);
  EXPECT_EQ(retimed(single, 1, poisson_).data(), single.data());
  EXPECT_THAT([&] { retimed(single, 2, poisson_); },
              ThrowsMessage<InvalidArgument>(HasSubstr("in 2: expected 1")));
  EXPECT_THAT([&] { retimed(MeshSequence("none", single.topology(), 0, 25.0), 2, poisson_); },
              ThrowsMessage<InvalidArgument>(HasSubstr("'none' has no frames")));
}

TEST(StretchTrajectory, LengthIsExactAndTheTrajectoryKeepsItsShape) {
  for (const double factor : {0.5, 0.93, 1.0, 1.08, 1.5}) {
    const MeshSequence walk = test::walk("walk", 50, 0.06);
    const auto before = ground_trajectory(walk);
    const double wanted = factor * ground_distance(before, 0, 49);
    MeshSequence result = walk;
    stretch_trajectory(result, wanted);
    const auto after = ground_trajectory(result);
    EXPECT_NEAR(ground_distance(after, 0, 49), wanted, 2e-6);
    EXPECT_EQ(result.frame(0), walk.frame(0));
    for (std::size_t f = 0; f < 50; ++f) {
      EXPECT_LT((after[f] - before[0] - factor * (before[f] - before[0])).norm(), 1e-6) << f;
      // Each frame is moved as a whole, on the ground.
      const Eigen::RowVector3f shift = result.frame(f).row(0) - walk.frame(f).row(0);
      EXPECT_EQ(shift.y(), 0.0F);
      EXPECT_LT((result.frame(f) - walk.frame(f)).rowwise().operator-(shift).cwiseAbs().maxCoeff(), 1e-6F);
    }
  }
}

TEST(StretchTrajectory, StandingMotionStaysAsItIs) {
  MeshSequence standing = test::walk("standing", 5, 0.0, 400.0);
  const std::vector<float> before = standing.data();
  stretch_trajectory(standing, 3.0);
  EXPECT_EQ(standing.data(), before);
  MeshSequence single = test::walk("single", 1);
  stretch_trajectory(single, 3.0);
  EXPECT_EQ(single.data(), test::walk("single", 1).data());
}

TEST(StretchTrajectory, LengthThatIsNoneIsRefused) {
  MeshSequence walk = test::walk("walk", 10);
  for (const double length : {-1.0, not_a_number, unlimited}) {
    EXPECT_THAT([&] { stretch_trajectory(walk, length); },
                ThrowsMessage<InvalidArgument>(HasSubstr("trajectory's length")));
  }
}

}  // namespace
}  // namespace reprise
