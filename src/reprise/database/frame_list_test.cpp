// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/database/frame_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

PerformanceDatabase database() {
  return test::database_of({test::walk("run-up", 12), test::walk("3-1", 5), test::walk("walk", 100)});
}

std::vector<std::size_t> indices(const std::string& text, std::size_t clip_idx) {
  std::vector<std::size_t> found;
  for (const FrameId& frame : parse_frames(database(), text)) {
    EXPECT_EQ(frame.clip_idx, clip_idx) << text;
    found.push_back(frame.frame_idx);
  }
  return found;
}

TEST(FrameList, NamesFramesRangesAndClips) {
  EXPECT_THAT(indices("walk:0", 2), ElementsAre(0));
  EXPECT_THAT(indices("walk:99", 2), ElementsAre(99));
  EXPECT_THAT(indices("walk:7-9", 2), ElementsAre(7, 8, 9));
  EXPECT_THAT(indices("walk:7-7", 2), ElementsAre(7));
  EXPECT_THAT(indices("walk:10-40:10", 2), ElementsAre(10, 20, 30, 40));
  EXPECT_THAT(indices("walk:10-39:10", 2), ElementsAre(10, 20, 30));
  EXPECT_THAT(indices("walk:90-99:1000", 2), ElementsAre(90));
  EXPECT_THAT(indices("walk:90-99:99999999999999999999", 2), ElementsAre(90));
  // A clip may have a dash or look like a range.
  EXPECT_THAT(indices("3-1", 1), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(indices("3-1:3-4", 1), ElementsAre(3, 4));
  EXPECT_EQ(indices("run-up", 0).size(), 12U);
}

TEST(FrameList, BadTextsAreQuoted) {
  const PerformanceDatabase clips = database();
  const auto message = [&](const std::string& text, const std::string& expected) {
    EXPECT_THAT([&] { parse_frames(clips, text); }, ThrowsMessage<InvalidArgument>(HasSubstr(expected)))
        << text;
  };
  message("walkk:3", "did you mean 'walk'?");
  message("", "there is no clip ''");
  message(":3", "there is no clip ''");
  for (const char* text : {"walk:", "walk:x", "walk:-3", "walk:3-", "walk:3-5-7", "walk:3-5:", "walk:3-5:0",
                           "walk:3-5:-1", "walk:3-5:1:1", "walk: 3", "walk:+3", "walk:3.0", "walk:1e1"}) {
    message(text, std::string("'") + text + "' names no frames");
  }
  for (const char* text : {"walk:3:2", "walk:3:1", "walk:3:"}) message(text, "step and no range");
  message("walk:5-3", "'walk:5-3': the range ends before it begins");
  message("walk:100", "'walk:100': clip 'walk' has frames 0 to 99");
  message("walk:0-100", "frames 0 to 99");
  message("walk:0-99999999999999999999", "frames 0 to 99");
  EXPECT_THROW(parse_frames(PerformanceDatabase(), "walk"), InvalidArgument);
}

}  // namespace
}  // namespace reprise
