// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/foot_shifts.h"

#include <limits>

#include <gtest/gtest.h>

namespace reprise {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double radius = 0.1;
constexpr std::size_t frames = 60;

// A foot that rests at the origin below its hip, with no limits.
FootCourse free_course() {
  return {.centers = std::vector<Eigen::Vector3d>(frames, Eigen::Vector3d::Zero()),
          .hips = std::vector<Eigen::Vector3d>(frames, Eigen::Vector3d(0.0, 0.9, 0.0)),
          .longest_leg = infinity,
          .largest_acceleration = infinity};
}

// Four points of the sole about the centre.
const std::vector<Eigen::Vector2d> sole = {{0.05, 0.12}, {-0.05, 0.12}, {0.04, -0.1}, {-0.04, -0.1}};

// A stand from `first` to `last` in which the sole slides by `slide` and turns by `turn` (radians) a frame.
void stand(std::vector<FootDemand>& demands, std::size_t first, std::size_t last,
           const Eigen::Vector2d& slide, double turn = 0.0, double lift = 0.0) {
  for (std::size_t f = first; f < last; ++f) {
    for (const Eigen::Vector2d& p : sole) {
      const Eigen::Vector2d turned(turn * p.y(), -turn * p.x());
      demands[f].hold(0.25, slide + turned, p, p);
      demands[f].lift(0.25, lift);
    }
  }
}

Eigen::Vector2d step(const std::vector<FootShift>& shifts, std::size_t f) {
  const Eigen::Vector3d d = shifts[f + 1].translation - shifts[f].translation;
  return {d.x(), d.z()};
}

double largest_acceleration(const std::vector<FootShift>& shifts) {
  double largest = 0.0;
  for (std::size_t f = 1; f + 1 < shifts.size(); ++f) {
    largest = std::max(
        largest,
        (shifts[f + 1].translation - 2.0 * shifts[f].translation + shifts[f - 1].translation).norm());
  }
  return largest;
}

TEST(FootShiftsTest, NothingToDoIsNothingDone) {
  std::vector<FootDemand> demands(frames);
  stand(demands, 10, 30, Eigen::Vector2d::Zero());
  for (const FootShift& shift : solve_foot_shifts(demands, radius, free_course())) {
    EXPECT_LT(shift.translation.norm(), 1e-12);
    EXPECT_LT(std::abs(shift.yaw), 1e-12);
  }
}

TEST(FootShiftsTest, SlideOfAStandIsCancelledAndTheEndsStay) {
  std::vector<FootDemand> demands(frames);
  const Eigen::Vector2d slide(0.004, -0.003);
  stand(demands, 20, 36, slide);
  const std::vector<FootShift> shifts = solve_foot_shifts(demands, radius, free_course());
  for (std::size_t f = 20; f < 36; ++f) EXPECT_LT((step(shifts, f) + slide).norm(), 2e-5) << "frame " << f;
  EXPECT_TRUE(shifts.front().translation.isZero(0.0));
  EXPECT_TRUE(shifts.back().translation.isZero(0.0));
  // 16 frames of 5 mm are 8 cm to be spread: half before, half after, and gone a stride later.
  EXPECT_NEAR(shifts[20].translation.norm(), 0.04, 0.005);
  EXPECT_NEAR(shifts[36].translation.norm(), 0.04, 0.005);
  EXPECT_LT(shifts[6].translation.norm(), 1e-3);
  EXPECT_LT(shifts[50].translation.norm(), 1e-3);
}

TEST(FootShiftsTest, TurnOfAStandIsCancelled) {
  std::vector<FootDemand> demands(frames);
  stand(demands, 25, 33, Eigen::Vector2d::Zero(), 0.01);
  const std::vector<FootShift> shifts = solve_foot_shifts(demands, radius, free_course());
  for (std::size_t f = 25; f < 33; ++f) {
    EXPECT_NEAR(shifts[f + 1].yaw - shifts[f].yaw, -0.01, 1e-4);
    EXPECT_LT(step(shifts, f).norm(), 1e-4);
  }
}

TEST(FootShiftsTest, FloatingFootComesDownAndGoesBack) {
  std::vector<FootDemand> demands(frames);
  stand(demands, 25, 33, Eigen::Vector2d::Zero(), 0.0, -0.02);
  const std::vector<FootShift> shifts = solve_foot_shifts(demands, radius, free_course());
  EXPECT_NEAR(shifts[29].translation.y(), -0.02, 2e-3);
  EXPECT_LT(std::abs(shifts[10].translation.y()), 1e-3);
  EXPECT_LT(std::abs(shifts[50].translation.y()), 1e-3);
}

TEST(FootShiftsTest, ShiftBetweenTwoStandsIsSmooth) {
  std::vector<FootDemand> demands(frames);
  const Eigen::Vector2d slide(0.005, 0.0);
  stand(demands, 10, 22, slide);
  stand(demands, 34, 46, -slide);
  const std::vector<FootShift> shifts = solve_foot_shifts(demands, radius, free_course());
  for (std::size_t f = 10; f < 22; ++f) EXPECT_LT((step(shifts, f) + slide).norm(), 3e-5);
  for (std::size_t f = 34; f < 46; ++f) EXPECT_LT((step(shifts, f) - slide).norm(), 3e-5);
  // A foot that jumped from one stand's shift to the next would accelerate by centimetres a frame.
  EXPECT_LT(largest_acceleration(shifts), 0.008);
}

TEST(FootShiftsTest, LegIsNotDrawnOut) {
  std::vector<FootDemand> demands(frames);
  stand(demands, 10, 50, {0.005, 0.0});
  FootCourse course = free_course();
  const auto longest = [&](const std::vector<FootShift>& shifts) {
    double length = 0.0;
    for (std::size_t f = 0; f < frames; ++f)
      length = std::max(length, (course.centers[f] + shifts[f].translation - course.hips[f]).norm());
    return length;
  };
  ASSERT_GT(longest(solve_foot_shifts(demands, radius, course)), 0.902);
  course.longest_leg = 0.9;
  EXPECT_LT(longest(solve_foot_shifts(demands, radius, course)), 0.9015);
}

TEST(FootShiftsTest, FootThatIsHeldLooselyIsNotThrown) {
  std::vector<FootDemand> demands(frames);
  const Eigen::Vector2d slide(0.03, 0.0);
  for (std::size_t f = 28; f < 32; ++f) {
    for (const Eigen::Vector2d& p : sole) demands[f].hold(2.5e-4, slide, p, p);
  }
  FootCourse course = free_course();
  const double unlimited = largest_acceleration(solve_foot_shifts(demands, radius, course));
  course.largest_acceleration = 0.6 * unlimited;
  EXPECT_LT(largest_acceleration(solve_foot_shifts(demands, radius, course)), 0.75 * unlimited);
}

TEST(FootShiftsTest, TooShortMotionStays) {
  std::vector<FootDemand> demands(2);
  demands[0].hold(1.0, {0.1, 0.0}, {0.0, 0.0}, {0.0, 0.0});
  for (const FootShift& shift : solve_foot_shifts(demands, radius, free_course()))
    EXPECT_TRUE(shift.translation.isZero(0.0));
}

}  // namespace
}  // namespace reprise
