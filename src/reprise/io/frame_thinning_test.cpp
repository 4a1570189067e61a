// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/frame_thinning.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/shapes.h"

namespace reprise {
namespace {

using ::testing::ElementsAre;

TEST(FrameThinning, KeepsAllFramesThatFit) {
  EXPECT_EQ(thin_frames(test::walk("walk", 40), 40).size(), 40U);
  EXPECT_THAT(thin_frames(test::walk("one", 1), 2), ElementsAre(0));
}

TEST(FrameThinning, KeepsAsManyAsFitAndBothEnds) {
  const MeshSequence clip = test::walk("walk", 60);
  for (const std::size_t most : {2U, 3U, 17U, 59U}) {
    const auto kept = thin_frames(clip, most);
    EXPECT_EQ(kept.size(), most);
    EXPECT_EQ(kept.front(), 0U);
    EXPECT_EQ(kept.back(), 59U);
  }
}

TEST(FrameThinning, StraightMotionGivesUpItsFramesAndTurnsKeepTheirs) {
  const test::Shape shape = test::sphere(1);
  MeshSequence clip("turns", shape.topology, 31, 25.0);
  for (std::size_t f = 0; f < 31; ++f) {
    clip.frame(f) = shape.positions;
    // Straight on to frame 12, back to frame 20, on again: only the turns say anything.
    const auto time = static_cast<float>(f);
    const float x = f <= 12 ? time : (f <= 20 ? 24.0F - time : time - 16.0F);
    clip.frame(f).col(0).array() += 0.125F * x;
  }
  const auto kept = thin_frames(clip, 4);
  EXPECT_THAT(kept, ElementsAre(0, 12, 20, 30));
  EXPECT_LT(thinning_error(clip, kept), 1e-6);
}

TEST(FrameThinning, IsNearerToTheMotionThanEverySecondFrame) {
  MeshSequence clip = test::walk("walk", 101);
  for (std::size_t f = 40; f < 101; ++f)
    clip.frame(f) = Positions(std::as_const(clip).frame(40));  // then it stands
  std::vector<std::size_t> every_second;
  for (std::size_t f = 0; f < 101; f += 2) every_second.push_back(f);
  EXPECT_LT(thinning_error(clip, thin_frames(clip, 51)), 0.1 * thinning_error(clip, every_second));
}

}  // namespace
}  // namespace reprise
