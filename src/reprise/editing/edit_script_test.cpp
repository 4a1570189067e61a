// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/editing/edit_script.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/editing/vertex_selection.h"
#include "reprise/synthetic/figure/figure.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

const PerformanceDatabase& performer() {
  static const PerformanceDatabase database = make_figure({.voxel_size = 0.05});
  return database;
}

class EditScriptTest : public testing::Test {
 protected:
  EditScriptTest() {
    std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    path_ = std::filesystem::path(testing::TempDir()) / ("edit_script_" + name + ".json");
  }
  ~EditScriptTest() override { std::filesystem::remove(path_); }

  EditScript read_text(const std::string& text, const std::string& frame = {}) const {
    std::ofstream(path_) << text;
    return read_edit_script(path_, performer(), frame);
  }
  // The text inside of the outermost braces, behind format and version.
  EditScript read(const std::string& fields, const std::string& frame = {}) const {
    return read_text(R"({"format": "reprise edit", "version": 1, )" + fields + "}", frame);
  }
  EditScript read_handle(const std::string& fields) const {
    return read(R"("frame": "walk:9", "steps": [{"handles": [{)" + fields + "}]}]");
  }

  PositionsView frame() const { return performer().clip(performer().clip_idx("walk")).frame(9); }

  std::filesystem::path path_;
};

TEST_F(EditScriptTest, ReadsAllThatASessionCanDo) {
  const EditScript script = read(R"(
    "model": "whole", "window": 0.25, "frame": "walk:9",
    "steps": [
      {"anchors": [{"joint": "pelvis"}, {"name": "toe", "vertices": [7, 3, 7], "weight": 2}],
       "handles": [{"joint": "left_hand", "move": [0.1, 0.2, 0.3], "turn": {"axis": [0, 2, 0], "degrees": 90}},
                   {"name": "crown", "part": "head", "weight": 0.5}]},
      {"handles": [{"name": "left_hand", "move": [0, 0, 1]}]},
      {"frame": "stand:4", "handles": [{"vertices": [5], "to": [1, 2, 3]}]}
    ])");
  EXPECT_EQ(script.model, EditModel::whole);
  EXPECT_EQ(script.window, 0.25);
  ASSERT_EQ(script.steps.size(), 3U);
  const FrameId walk{performer().clip_idx("walk"), 9};
  const ScriptStep& first = script.steps[0];
  EXPECT_EQ(first.frame, walk);
  ASSERT_TRUE(first.anchors.has_value());
  EXPECT_EQ((*first.anchors)[0].vertices, select_vertices(performer(), walk, {.joint = "pelvis"}));
  EXPECT_EQ((*first.anchors)[1], (Handle{.name = "toe", .vertices = {3, 7}, .weight = 2.0}));
  ASSERT_EQ(first.drags.size(), 2U);
  EXPECT_EQ(first.drags[0].handle.name, "left_hand");
  EXPECT_EQ(first.drags[0].displacement, Vector3d(0.1, 0.2, 0.3));
  EXPECT_LT((first.drags[0].rotation * Vector3d::UnitZ() - Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_EQ(first.drags[1].handle.name, "crown");
  EXPECT_EQ(first.drags[1].handle.weight, 0.5);
  EXPECT_EQ(first.drags[1].displacement, Vector3d::Zero());

  const ScriptStep& second = script.steps[1];
  EXPECT_EQ(second.frame, walk);
  EXPECT_FALSE(second.anchors.has_value());
  EXPECT_EQ(second.drags[0].handle, first.drags[0].handle) << "a name alone means the handle of before";
  EXPECT_EQ(second.drags[0].displacement, Vector3d(0.0, 0.0, 1.0));

  const ScriptStep& third = script.steps[2];
  const FrameId stand{performer().clip_idx("stand"), 4};
  EXPECT_EQ(third.frame, stand);
  const Vector3d at = performer().clip(stand.clip_idx).frame(4).row(5).transpose().cast<double>();
  EXPECT_LT((at + third.drags[0].displacement - Vector3d(1.0, 2.0, 3.0)).norm(), 1e-6);
}

TEST_F(EditScriptTest, TheCallersFrameStandsInForTheFiles) {
  const std::string steps = R"("steps": [{"handles": [{"vertices": [1]}]}])";
  EXPECT_EQ(read(steps, "walk:7").steps[0].frame.frame_idx, 7U);
  EXPECT_EQ(read(R"("frame": "walk:9", )" + steps).steps[0].frame.frame_idx, 9U);
  EXPECT_EQ(read(R"("frame": "walk:9", )" + steps, "walk:7").steps[0].frame.frame_idx, 7U);
  const std::string own = R"("steps": [{"frame": "walk:3", "handles": [{"vertices": [1]}]}])";
  EXPECT_EQ(read(own, "walk:7").steps[0].frame.frame_idx, 3U);
  EXPECT_THROW(read(steps, "walk:70000"), InvalidArgument);
}

TEST_F(EditScriptTest, ChoosesWhatMeetsAllThatIsGiven) {
  const FrameId walk{performer().clip_idx("walk"), 9};
  const auto part = select_vertices(performer(), walk, {.part = "left_arm"});
  ASSERT_FALSE(part.empty());
  const Vector3d place = frame().row(part.front()).transpose().cast<double>();
  const auto near = select_vertices(performer(), walk, {.near = place, .radius = 0.2});
  const auto both = select_vertices(performer(), walk, {.part = "left_arm", .near = place, .radius = 0.2});
  std::vector<std::int32_t> expected;
  std::ranges::set_intersection(part, near, std::back_inserter(expected));
  EXPECT_EQ(both, expected);
  for (Eigen::Index v = 0; v < frame().rows(); ++v) {
    const double distance = (frame().row(v).transpose().cast<double>() - place).norm();
    EXPECT_EQ(std::ranges::binary_search(near, static_cast<std::int32_t>(v)), distance <= 0.2) << v;
  }
}

TEST_F(EditScriptTest, ErrorsNameTheFileAndTheField) {
  const auto refuses = [&](const std::string& place, const std::string& what, const auto& attempt) {
    SCOPED_TRACE(place + ": " + what);
    try {
      attempt();
      ADD_FAILURE() << "nothing was thrown";
    } catch (const FileError& error) {
      EXPECT_EQ(error.path(), path_);
      EXPECT_THAT(error.what(), HasSubstr(place));
      EXPECT_THAT(error.what(), HasSubstr(what));
    }
  };
  const std::string handle = "steps[0].handles[0]";
  refuses("", "expected \"format\"", [&] { read_text(R"({"format": "reprise markup", "version": 1})"); });
  refuses("line 1", "JSON", [&] { read_text("{"); });
  refuses("version", "version 2",
          [&] { read_text(R"({"format": "reprise edit", "version": 2, "steps": []})"); });
  refuses("model", "expected part, whole", [&] { read(R"("model": "prat", "steps": [])"); });
  refuses("window", "from 0", [&] { read(R"("window": -1, "steps": [])"); });
  refuses("frame", "did you mean 'walk'", [&] { read(R"("frame": "wlak:1", "steps": [])"); });
  refuses("steps", "at least one step", [&] { read(R"("steps": [])"); });
  refuses("steps", "expected this field", [&] { read(R"("frame": "walk:1")"); });
  refuses("steps[0]", "names no frame", [&] { read(R"("steps": [{"handles": [{"vertices": [1]}]}])"); });
  refuses("steps[0]", "nothing is held", [&] { read(R"("frame": "walk:1", "steps": [{}])"); });
  refuses("steps[0].frame", "asked for 99999",
          [&] { read(R"("steps": [{"frame": "walk:99999", "handles": []}])"); });
  refuses("steps[2]", "in two places", [&] {
    read(R"("steps": [{"frame": "walk:1", "handles": [{"vertices": [1]}]},
                      {"frame": "walk:2", "handles": [{"vertices": [1]}]},
                      {"frame": "walk:1", "handles": [{"vertices": [1]}]}])");
  });
  refuses(handle, "no vertex is chosen", [&] { read_handle(R"("name": "a", "move": [0, 0, 1])"); });
  refuses(handle, "did you mean 'left_hand'", [&] { read_handle(R"("joint": "left_hnad")"); });
  refuses(handle, "did you mean 'left_arm'", [&] { read_handle(R"("part": "left_amr")"); });
  refuses(handle, "the nearest is", [&] { read_handle(R"("near": [0, 50, 0])"); });
  refuses(handle + ".vertices", "at least one", [&] { read_handle(R"("vertices": [])"); });
  refuses(handle + ".vertices[1]", "integer", [&] { read_handle(R"("vertices": [1, -2])"); });
  refuses(handle + ".vertices[0]", "integer", [&] { read_handle(R"("vertices": [1.5])"); });
  refuses(handle + ".vertices[0]", "integer", [&] { read_handle(R"("vertices": [999999])"); });
  refuses(handle + ".radius", "near", [&] { read_handle(R"("vertices": [1], "radius": 0.1)"); });
  refuses(handle + ".radius", "above 0", [&] { read_handle(R"("near": [0, 1, 0], "radius": 0)"); });
  refuses(handle + ".weight", "above 0", [&] { read_handle(R"("vertices": [1], "weight": 0)"); });
  refuses(handle + ".name", "empty", [&] { read_handle(R"("vertices": [1], "name": "")"); });
  refuses(handle + ".move", "three numbers", [&] { read_handle(R"("vertices": [1], "move": [0, 1])"); });
  refuses(handle + ".move[1]", "number", [&] { read_handle(R"("vertices": [1], "move": [0, "1", 2])"); });
  refuses(handle + ".move", "metres", [&] { read_handle(R"("vertices": [1], "move": [0, 1e9, 2])"); });
  refuses(handle, "found both",
          [&] { read_handle(R"("vertices": [1], "move": [0, 0, 1], "to": [0, 0, 1])"); });
  refuses(handle + ".turn.axis", "direction",
          [&] { read_handle(R"("vertices": [1], "turn": {"axis": [0, 0, 0], "degrees": 3})"); });
  refuses(handle + ".turn.degrees", "expected this field",
          [&] { read_handle(R"("vertices": [1], "turn": {"axis": [0, 0, 1]})"); });
  refuses("steps[0].handles[1]", "drags 'a' twice", [&] {
    read(R"("frame": "walk:1", "steps": [{"handles": [{"name": "a", "vertices": [1]},
                                                     {"name": "a", "vertices": [2]}]}])");
  });
  refuses("steps[0].anchors[1]", "is taken", [&] {
    read(R"("frame": "walk:1", "steps": [{"anchors": [{"name": "a", "vertices": [1]},
                                                     {"name": "a", "vertices": [2]}]}])");
  });
}

TEST_F(EditScriptTest, WithoutAMarkupThereAreNoJoints) {
  const PerformanceDatabase bare = test::database_of({test::walk("walk", 4)});
  EXPECT_THROW(select_vertices(bare, {0, 0}, {.joint = "left_hand"}), InvalidArgument);
  EXPECT_THROW(select_vertices(bare, {0, 0}, {.part = "left_arm"}), InvalidArgument);
  EXPECT_THROW(select_vertices(bare, {0, 0}, {}), InvalidArgument);
  EXPECT_THROW(select_vertices(bare, {0, 9}, {.vertices = {1}}), InvalidArgument);
  EXPECT_EQ(select_vertices(bare, {0, 0}, {.vertices = {4, 2}}), (std::vector<std::int32_t>{2, 4}));
}

// Any damage is a `FileError` or reads as some other script.
TEST_F(EditScriptTest, DamagedFilesAreRefusedOrRead) {
  const std::string whole =
      R"({"format": "reprise edit", "version": 1, "frame": "walk:9", "window": 0.5, "steps": [
    {"anchors": [{"part": "torso"}], "handles": [{"joint": "left_hand", "move": [0.1, 0.2, 0.3],
    "turn": {"axis": [0, 1, 0], "degrees": 45}}, {"near": [0, 1, 0], "radius": 0.5, "to": [0, 1, 1]}]}]})";
  std::mt19937 random(7);
  int refused = 0;
  for (int attempt = 0; attempt < 400; ++attempt) {
    std::string text = whole;
    for (int change = 0; change <= attempt % 3; ++change) {
      const std::size_t at = random() % text.size();
      switch (random() % 3) {
        case 0:
          text.erase(at, 1 + random() % 12);
          break;
        case 1:
          text[at] = static_cast<char>(random() % 256);
          break;
        default:
          text.insert(at, text.substr(random() % text.size(), 1 + random() % 12));
      }
    }
    try {
      for (const ScriptStep& step : read_text(text).steps) {
        for (const ScriptedDrag& drag : step.drags) {
          EXPECT_FALSE(drag.handle.vertices.empty());
          EXPECT_TRUE(drag.displacement.allFinite() && drag.rotation.coeffs().allFinite());
        }
      }
    } catch (const FileError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace reprise
