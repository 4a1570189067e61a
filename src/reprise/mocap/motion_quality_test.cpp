// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mocap/motion_quality.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/synthetic/figure/figure.h"

namespace reprise {
namespace {

constexpr double rate = 25.0;
constexpr FootContacts standing = {true, true};
constexpr FootContacts in_the_air = {false, false};

const PerformanceDatabase& figure() {
  static const PerformanceDatabase made = make_figure({.voxel_size = 0.06});
  return made;
}

const MotionQualityScale& scale() {
  static const MotionQualityScale made(figure(), find_joints(figure().markup()->skeleton, "the figure"));
  return made;
}

Positions first_frame() {
  return figure().clip(0).frame(0);
}

Positions moved(const Positions& frame, double x, double y, double z) {
  return frame.rowwise() + Eigen::RowVector3d(x, y, z).cast<float>();
}

TEST(MotionQuality, SolesAreThoseOfTheirSides) {
  const Markup& markup = *figure().markup();
  const auto& [left, right] = scale().soles();
  ASSERT_FALSE(left.empty());
  ASSERT_FALSE(right.empty());
  for (const auto& [sole, side] : {std::pair(left, "left_"), std::pair(right, "right_")}) {
    EXPECT_TRUE(std::ranges::is_sorted(sole));
    for (const std::int32_t v : sole) {
      const std::int32_t joint = markup.joint_of_vertex[static_cast<std::size_t>(v)];
      if (joint < 0) continue;
      EXPECT_THAT(markup.skeleton.joints[static_cast<std::size_t>(joint)].name, testing::StartsWith(side));
    }
  }
}

TEST(MotionQuality, SlideIsMeasuredOnlyOfFeetThatStand) {
  constexpr double step = 0.004;  // metres a frame
  MotionQualityMeter sliding(scale(), rate);
  MotionQualityMeter flying(scale(), rate);
  MotionQualityMeter limping(scale(), rate);
  for (int f = 0; f < 10; ++f) {
    const Positions frame = moved(first_frame(), 0.6 * step * f, 0.0, 0.8 * step * f);
    sliding.add(frame, false, standing);
    flying.add(frame, false, in_the_air);
    // Stands now and then, never from one frame to the next.
    limping.add(frame, false, f % 2 == 0 ? standing : in_the_air);
  }
  EXPECT_NEAR(sliding.quality().foot_drift, 100.0 * rate * step, 1e-3);
  EXPECT_EQ(flying.quality().foot_drift, 0.0);
  EXPECT_EQ(limping.quality().foot_drift, 0.0);
}

TEST(MotionQuality, FootThatRollsOverItsToesDoesNotSlide) {
  // About a line across below the lowest point of the left sole: what stays down stays where it is.
  const std::vector<std::int32_t>& sole = scale().soles()[0];
  const Positions start = first_frame();
  std::int32_t toe = sole.front();
  for (const std::int32_t v : sole) {
    if (start(v, 2) > start(toe, 2)) toe = v;
  }
  const Eigen::RowVector3f pivot(0.0F, start.col(1).minCoeff(), start(toe, 2));
  MotionQualityMeter meter(scale(), rate);
  for (int f = 0; f < 8; ++f) {
    const Eigen::Matrix3f turn =
        Eigen::AngleAxisf(0.12F * static_cast<float>(f), Eigen::Vector3f::UnitX()).toRotationMatrix();
    meter.add((((start.rowwise() - pivot) * turn.transpose()).rowwise() + pivot).eval(), false,
              {true, false});
  }
  // The heel passes 12 cm/s with its rise; what is left is the thickness of the sole that counts as down.
  EXPECT_LT(meter.quality().foot_drift, 9.0);
}

TEST(MotionQuality, HeightIsThatOfTheLowestPointOfFeetThatStand) {
  const Positions start = first_frame();
  const auto height_of = [&](double y) {
    MotionQualityMeter meter(scale(), rate);
    for (int f = 0; f < 3; ++f) meter.add(moved(start, 0.0, y, 0.0), false, standing);
    return meter.quality().foot_height;
  };
  EXPECT_NEAR(height_of(0.2), 20.0, 1.0);  // the figure's own soles lie within a centimetre of the ground
  EXPECT_NEAR(height_of(0.2) - height_of(0.1), 10.0, 1e-4);
  EXPECT_NEAR(height_of(-0.2), 20.0, 1.0);  // below the ground is as far from it as above
}

TEST(MotionQuality, PopIsWhatAcceleratesInsideTransitions) {
  constexpr double jump = 0.5;
  const Positions start = first_frame();
  const auto jumping = [&](bool is_blend) {
    MotionQualityMeter meter(scale(), rate);
    for (int f = 0; f < 12; ++f) {
      meter.add(moved(start, f < 6 ? 0.0 : jump, 0.0, 0.0), is_blend && f == 6, in_the_air);
    }
    return meter.quality();
  };
  const double expected = jump / scale().captured().acceleration_p99;
  EXPECT_NEAR(jumping(false).peak_ratio, expected, 1e-5 * expected);
  EXPECT_EQ(jumping(false).pop_ratio, 0.0);
  EXPECT_NEAR(jumping(true).pop_ratio, expected, 1e-5 * expected);
}

TEST(MotionQuality, EvenMotionDoesNotPop) {
  MotionQualityMeter meter(scale(), rate);
  for (int f = 0; f < 12; ++f) meter.add(moved(first_frame(), 0.05 * f, 0.0, 0.0), true, in_the_air);
  EXPECT_LT(meter.quality().pop_ratio, 1e-3);
}

TEST(MotionQuality, StretchScalesWithTheSurface) {
  const auto stretch_of = [](float factor) {
    MotionQualityMeter meter(scale(), rate);
    meter.add(factor * first_frame(), false, standing);
    return meter.quality().edge_stretch_p99;
  };
  EXPECT_NEAR(stretch_of(1.0F), 1.0, 3e-4);
  EXPECT_NEAR(stretch_of(1.7F), 1.7, 1e-3);
}

TEST(MotionQuality, CapturedFiguresAreThoseOfTheClips) {
  const Naturalness beside = [] {
    MeshSequence replay = figure().clip(0);
    std::vector<FrameOrigin> origins;
    for (std::size_t f = 0; f < replay.frame_count(); ++f) {
      origins.push_back({.clip = replay.name(), .frame_idx = static_cast<std::int32_t>(f)});
    }
    replay.set_origins(std::move(origins));
    return evaluate_naturalness(replay, figure());
  }();
  EXPECT_EQ(scale().captured().acceleration_p99, beside.captured_acceleration_p99);
  EXPECT_EQ(scale().captured().pop_ratio, beside.captured_pop_ratio);
  EXPECT_EQ(scale().captured().foot_drift, beside.captured_foot_drift);
  EXPECT_EQ(scale().captured().edge_stretch_p99, beside.captured_edge_stretch_p99);
}

TEST(MotionQuality, SurfaceWithoutMarkupIsRefused) {
  PerformanceDatabase plain;
  plain.add(figure().clip(0));
  EXPECT_THROW(MotionQualityScale(plain, find_joints(figure().markup()->skeleton, "the figure")),
               InvalidArgument);
}

}  // namespace
}  // namespace reprise
