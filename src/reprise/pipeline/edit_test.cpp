// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/edit.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/editing/vertex_selection.h"
#include "reprise/synthetic/figure/figure.h"

namespace reprise {
namespace {

using testing::HasSubstr;

const PerformanceDatabase& performer() {
  static const PerformanceDatabase database = make_figure({.voxel_size = 0.05});
  return database;
}

class EditStageTest : public testing::Test {
 protected:
  EditStageTest() {
    std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    options_.script = std::filesystem::path(testing::TempDir()) / ("edit_stage_" + name + ".json");
  }
  ~EditStageTest() override { std::filesystem::remove(options_.script); }

  EditResult run(const std::string& steps) const {
    std::ofstream(options_.script)
        << R"({"format": "reprise edit", "version": 1, "model": "laplacian", "steps": [)" << steps << "]}";
    return run_edit(performer(), options_);
  }
  Positions captured(const std::string& frame) const {
    const FrameId id = performer().parse_frame(frame);
    return performer().clip(id.clip_idx).frame(id.frame_idx);
  }

  EditStageOptions options_;
};

const std::string two_steps = R"(
  {"frame": "walk:9", "anchors": [{"part": "torso"}], "handles": [{"joint": "left_hand", "move": [0, 0.1, 0]}]},
  {"handles": [{"joint": "right_hand", "move": [0, 0.1, 0]}]})";

TEST_F(EditStageTest, MakesAStillOfEveryEditedFrame) {
  const EditResult result = run(two_steps + R"(,
    {"frame": "stand:4", "anchors": [{"part": "torso"}], "handles": [{"joint": "left_hand", "to": [0.4, 1, 0.3]}]})");
  const MeshSequence& stills = result.animation;
  ASSERT_EQ(stills.frame_count(), 2U);
  EXPECT_EQ(stills.name(), "edit");
  EXPECT_EQ(stills.origins()[0], (FrameOrigin{.clip = "walk", .frame_idx = 9}));
  EXPECT_EQ(stills.origins()[1], (FrameOrigin{.clip = "stand", .frame_idx = 4}));
  EXPECT_TRUE(stills.has_colors());
  EXPECT_EQ(result.report["steps"].size(), 3U);
  EXPECT_EQ(result.before_after.frame_count(), 4U);
  EXPECT_EQ(Positions(result.before_after.frame(2)), captured("stand:4"));
  EXPECT_EQ(Positions(result.before_after.frame(3)), Positions(stills.frame(1)));
  // Handles of the first step stay where they are in the second.
  const FrameId walk = performer().parse_frame("walk:9");
  for (const std::string joint : {"left_hand", "right_hand"}) {
    for (const std::int32_t v : select_vertices(performer(), walk, {.joint = joint})) {
      EXPECT_NEAR(stills.frame(0)(v, 1), captured("walk:9")(v, 1) + 0.1F, 0.01F) << joint;
    }
  }
}

TEST_F(EditStageTest, ShowsEveryStepIfAsked) {
  options_.show_steps = true;
  options_.name = "session";
  const EditResult result = run(two_steps);
  ASSERT_EQ(result.animation.frame_count(), 3U);
  EXPECT_EQ(result.animation.name(), "session");
  EXPECT_EQ(Positions(result.animation.frame(0)), captured("walk:9"));
  EXPECT_NE(Positions(result.animation.frame(1)), Positions(result.animation.frame(2)));
  EXPECT_EQ(Positions(result.animation.frame(2)), Positions(result.before_after.frame(1)));
}

TEST_F(EditStageTest, SpreadsEditsOverTheClip) {
  options_.window = 0.2;
  const EditResult result = run(two_steps);
  const std::size_t walk = performer().clip_idx("walk");
  EXPECT_EQ(result.animation.frame_count(), performer().clip(walk).frame_count());
  EXPECT_EQ(result.animation.name(), "walk");
  EXPECT_EQ(Positions(result.animation.frame(9)), Positions(result.before_after.frame(1)));
  EXPECT_EQ(Positions(result.animation.frame(20)), captured("walk:20"));
  EXPECT_EQ(result.report["changed_frames"], 9U);
  EXPECT_GT(result.report["pop_ratio"].get<double>(), 0.0);
}

TEST_F(EditStageTest, RefusesWhatCannotBeDone) {
  const auto refuses = [&](const std::string& what, const std::string& steps) {
    SCOPED_TRACE(what);
    try {
      run(steps);
      ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(what));
    }
  };
  const std::string in_two_clips = two_steps + R"(, {"frame": "stand:4", "handles": [{"vertices": [1]}]})";
  refuses("steps[1]: vertex", R"({"frame": "walk:9", "handles": [{"name": "a", "vertices": [1, 2]}]},
                               {"handles": [{"name": "b", "vertices": [2, 3]}]})");
  options_.window = 0.5;
  refuses("one clip: found walk:9 and stand:4", in_two_clips);
  options_.show_steps = true;
  refuses("stills", two_steps);
  options_.window = -0.5;
  refuses("window", two_steps);
  options_ = {.script = options_.script, .model = EditModel::part};
  refuses("reprise model learn", two_steps);
}

}  // namespace
}  // namespace reprise
