// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The file of a graph: round trips, and everything that can be wrong with one.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/graph/graph_test_support.h"

namespace reprise {
namespace {

using test::CapturedLog;
using test::Json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using GraphFile = test::GraphTest;

void expect_identical(const std::vector<Transition>& a, const std::vector<Transition>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(std::tie(a[i].source_clip, a[i].target_clip, a[i].m, a[i].n, a[i].half_window,
                       a[i].source_from_target.yaw, a[i].distortion, a[i].peak_acceleration, a[i].cost),
              std::tie(b[i].source_clip, b[i].target_clip, b[i].m, b[i].n, b[i].half_window,
                       b[i].source_from_target.yaw, b[i].distortion, b[i].peak_acceleration, b[i].cost));
    EXPECT_EQ(a[i].source_from_target.translation, b[i].source_from_target.translation);
  }
}

TEST_F(GraphFile, GivesBackWhatWasSavedToTheLastBit) {
  graph_.options = {.transitions_per_pair = 7,
                    .criterion = WindowCriterion::paper_sum,
                    .acceleration_weight = 0.1,
                    .profile = BlendProfile::linear,
                    .max_pop_ratio = 0.7};
  graph_.kept = {graph_.transitions[1], graph_.transitions[2]};
  graph_.added = {graph_.transitions[3]};
  graph_.pruning = Pruning::both_ends;
  graph_.removed = {{.source_clip = "walk", .target_clip = "stroll"},
                    {.source_clip = "str*", .target_clip = "*"},
                    {.source_clip = "stroll", .target_clip = "stroll", .m = 5, .n = 30, .within = 4}};
  save_graph(graph_, path_);
  const SurfaceMotionGraph loaded = load_graph(path_);
  EXPECT_EQ(loaded.database_hash, graph_.database_hash);
  EXPECT_EQ(loaded.metric, graph_.metric);
  EXPECT_EQ(loaded.removed, graph_.removed);
  EXPECT_EQ(loaded.options.transitions_per_pair, 7);
  EXPECT_EQ(loaded.options.criterion, WindowCriterion::paper_sum);
  EXPECT_EQ(loaded.options.profile, BlendProfile::linear);
  EXPECT_EQ(loaded.options.acceleration_weight, 0.1);
  ASSERT_EQ(loaded.clips.size(), graph_.clips.size());
  for (std::size_t c = 0; c < loaded.clips.size(); ++c) {
    EXPECT_EQ(loaded.clips[c].name, graph_.clips[c].name);
    EXPECT_EQ(loaded.clips[c].frame_count, graph_.clips[c].frame_count);
    EXPECT_EQ(loaded.clips[c].frames_per_second, graph_.clips[c].frames_per_second);
  }
  EXPECT_EQ(loaded.options.max_pop_ratio, 0.7);
  EXPECT_EQ(loaded.captured_acceleration, graph_.captured_acceleration);
  EXPECT_GT(loaded.captured_acceleration, 0.0);
  EXPECT_EQ(loaded.pruning, Pruning::both_ends);
  expect_identical(loaded.transitions, graph_.transitions);
  expect_identical(loaded.kept, graph_.kept);
  expect_identical(loaded.added, graph_.added);
  const std::string first = read_text_file(path_);
  save_graph(loaded, path_);
  EXPECT_EQ(read_text_file(path_), first);
}

TEST_F(GraphFile, NamesClipsAndReadsTopDown) {
  save_graph(graph_, path_);
  const Json json = Json::parse(read_text_file(path_));
  EXPECT_EQ(json.begin().key(), "format");
  EXPECT_EQ(json["transitions"][0]["source"], "walk");
}

TEST_F(GraphFile, WithoutEditsHasNone) {
  EXPECT_EQ(load_error([](Json& json) {
              for (const char* name : {"removed", "protected", "added", "pruning"}) json.erase(name);
            }),
            "");
  const SurfaceMotionGraph loaded = load_graph(path_);
  EXPECT_TRUE(loaded.removed.empty());
  EXPECT_TRUE(loaded.kept.empty());
  EXPECT_TRUE(loaded.added.empty());
  EXPECT_EQ(loaded.pruning, Pruning::none);
}

TEST_F(GraphFile, KnowsThatThereIsNoLimitOnPops) {
  graph_.options.max_pop_ratio = std::numeric_limits<double>::infinity();
  EXPECT_EQ(load_error([](Json& json) { EXPECT_TRUE(json["options"]["max_pop_ratio"].is_null()); }), "");
  EXPECT_EQ(load_graph(path_).options.max_pop_ratio, std::numeric_limits<double>::infinity());
}

TEST_F(GraphFile, OfVersionOneIsRead) {
  EXPECT_EQ(load_error([](Json& json) {
              json["version"] = 1;
              for (const char* name : {"protected", "added", "pruning", "captured_acceleration"})
                json.erase(name);
              json["options"].erase("max_pop_ratio");
              json["removed"] = {{{"source", "walk"}, {"m", 12}, {"target", "stroll"}, {"n", 20}}};
            }),
            "");
  const SurfaceMotionGraph loaded = load_graph(path_);
  expect_identical(loaded.transitions, graph_.transitions);
  EXPECT_EQ(loaded.options.max_pop_ratio, std::numeric_limits<double>::infinity());
  EXPECT_EQ(loaded.captured_acceleration, 0.0);
  EXPECT_EQ(loaded.removed, (std::vector<EdgePattern>{{.source_clip = "walk",
                                                       .target_clip = "stroll",
                                                       .m = 12,
                                                       .n = 20,
                                                       .within = graph_.options.separation}}));
}

TEST_F(GraphFile, ErrorsSayWhere) {
  // Missing file.
  EXPECT_THROW(load_graph(folder_ / "none.json"), FileError);
  // Not JSON: line and column of the trouble.
  EXPECT_THAT(load_error("{\n  \"format\": oops\n}"), HasSubstr("graph.json:line 2, column 13: is not JSON"));
  EXPECT_THAT(load_error(""), HasSubstr("line 1, column 1: is not JSON"));
  EXPECT_THAT(load_error("{\"format\": 1e999}"), HasSubstr("is not JSON"));
  const std::string whole = changed([](Json&) {});
  for (std::size_t length = 1; length + 2 < whole.size(); length += 101) {
    EXPECT_THAT(load_error(whole.substr(0, length)), HasSubstr("is not JSON")) << length;
  }
  // JSON of somebody else.
  for (const char* text : {"[]", "3", "{}", "{\"format\": \"gltf\"}", "{\"format\": 3}"}) {
    EXPECT_THAT(load_error(text), HasSubstr("is not a surface motion graph")) << text;
  }
  // A later version.
  EXPECT_THAT(load_error([](Json& json) { json["version"] = 3; }),
              HasSubstr("version 3, this program reads up to version 2"));
  EXPECT_THAT(load_error([](Json& json) { json["version"] = "one"; }),
              HasSubstr("version: expected an integer, found string \"one\""));
}

TEST_F(GraphFile, ErrorsNameEveryMissingField) {
  for (const char* name :
       {"version", "database_hash", "metric", "captured_acceleration", "options", "clips", "transitions"}) {
    EXPECT_THAT(load_error([&](Json& json) { json.erase(name); }),
                HasSubstr(std::string("graph.json:") + name + ": expected this field, found none"));
  }
  const Json whole = Json::parse(changed([](Json&) {}));
  for (const auto& [name, value] : whole["options"].items()) {
    EXPECT_THAT(load_error([&](Json& json) { json["options"].erase(name); }),
                HasSubstr(":options." + name + ": expected"));
    EXPECT_THAT(load_error([&](Json& json) { json["options"][name] = Json::array(); }),
                HasSubstr(":options." + name + ": expected"));
  }
  for (const auto& [name, value] : whole["clips"][0].items()) {
    EXPECT_THAT(load_error([&](Json& json) { json["clips"][1].erase(name); }),
                HasSubstr(":clips[1]." + name + ": expected"));
    EXPECT_THAT(load_error([&](Json& json) { json["clips"][1][name] = Json::array(); }),
                HasSubstr(":clips[1]." + name + ": expected"));
  }
  for (const auto& [name, value] : whole["transitions"][0].items()) {
    EXPECT_THAT(load_error([&](Json& json) { json["transitions"][2].erase(name); }),
                HasSubstr(":transitions[2]." + name + ": expected"));
    EXPECT_THAT(load_error([&](Json& json) { json["transitions"][2][name] = true; }),
                HasSubstr(":transitions[2]." + name + ": expected"));
  }
  EXPECT_THAT(load_error([](Json& json) {
                json["removed"] = {{{"source", "walk"}}};
              }),
              HasSubstr(":removed[0].target: expected this field"));
  EXPECT_THAT(load_error([](Json& json) {
                json["removed"] = {{{"source", "walk"}, {"target", "walk"}, {"m", 3}}};
              }),
              HasSubstr(":removed[0].n: expected this field"));
  EXPECT_THAT(load_error([](Json& json) { json["removed"] = "none"; }),
              HasSubstr("removed: expected a list, found string"));
  EXPECT_THAT(load_error([](Json& json) { json["clips"][0] = 3; }),
              HasSubstr("clips[0]: expected an object, found number 3"));
}

TEST_F(GraphFile, ErrorsNameValuesOutOfRange) {
  // Options.
  EXPECT_THAT(load_error([](Json& json) { json["options"]["criterion"] = "best"; }),
              HasSubstr("options.criterion: expected one of blend_speed, paper_sum, found 'best'"));
  EXPECT_THAT(load_error([](Json& json) { json["options"]["profile"] = "cubic"; }),
              HasSubstr("expected one of linear, smooth"));
  EXPECT_THAT(load_error([](Json& json) { json["options"]["separation"] = 0; }),
              HasSubstr("options.separation: expected an integer from 1"));
  EXPECT_THAT(load_error([](Json& json) { json["options"]["min_half_window"] = 30; }),
              HasSubstr("options: max_half_window is 24"));
  EXPECT_THAT(load_error([](Json& json) { json["options"]["acceleration_weight"] = -1; }),
              HasSubstr("expected a number from 0"));
  // Clips.
  EXPECT_THAT(load_error([](Json& json) { json["clips"][1]["name"] = "walk"; }),
              HasSubstr("clips[1].name: there is a clip 'walk' already"));
  EXPECT_THAT(load_error([](Json& json) { json["clips"][1]["name"] = ""; }),
              HasSubstr("clips[1].name: expected a name"));
  EXPECT_THAT(load_error([](Json& json) { json["clips"][0]["frame_count"] = 0; }),
              HasSubstr("expected an integer from 1, found 0"));
  EXPECT_THAT(load_error([](Json& json) { json["clips"][0]["frame_count"] = 18446744073709551615ULL; }),
              HasSubstr("found 18446744073709551615"));
  EXPECT_THAT(load_error([](Json& json) { json["clips"][0]["frame_count"] = 12.5; }),
              HasSubstr("expected an integer"));
  EXPECT_THAT(load_error([](Json& json) { json["clips"][0]["frames_per_second"] = 0; }),
              HasSubstr("expected a rate above 0"));
  // Transitions.
  EXPECT_THAT(load_error([](Json& json) { json["transitions"][0]["source"] = "wlak"; }),
              HasSubstr("transitions[0].source: there is no clip 'wlak'; did you mean 'walk'?"));
  EXPECT_THAT(load_error([](Json& json) { json["transitions"][0]["m"] = 50; }),
              HasSubstr("transitions[0].m: expected an integer from 0 to 49, found 50"));
  EXPECT_THAT(load_error([](Json& json) { json["transitions"][0]["n"] = -1; }),
              HasSubstr("transitions[0].n: expected"));
  EXPECT_THAT(
      load_error([](Json& json) {
        json["transitions"][0]["m"] = 4;
        json["transitions"][0]["half_window"] = 5;
      }),
      AllOf(HasSubstr("transitions[0].half_window: expected at most 4, found 5"), HasSubstr("'walk'")));
  EXPECT_THAT(load_error([](Json& json) {
                json["transitions"][0]["translation"] = {1, 2, 3};
              }),
              HasSubstr("transitions[0].translation: expected two numbers (x, z), found 3"));
  EXPECT_THAT(load_error([](Json& json) {
                json["transitions"][0]["translation"] = {1, "a"};
              }),
              HasSubstr("transitions[0].translation[1]: expected a number"));
  EXPECT_THAT(load_error([](Json& json) { json["transitions"][0]["cost"] = -0.5; }),
              HasSubstr("expected a number from 0"));
  EXPECT_THAT(load_error([](Json& json) { json["options"]["max_pop_ratio"] = 0; }),
              HasSubstr("options: max_pop_ratio is 0, expected a number above 0"));
  EXPECT_THAT(load_error([](Json& json) { json["captured_acceleration"] = -1; }),
              HasSubstr("captured_acceleration: expected a number from 0"));
  // Edits.
  EXPECT_THAT(load_error([](Json& json) { json["pruning"] = "all"; }),
              HasSubstr("pruning: expected one of none, dead_ends, both_ends, found 'all'"));
  for (const char* name : {"protected", "added"}) {
    EXPECT_THAT(load_error([&](Json& json) {
                  json[name] = Json::array({json["transitions"][0]});
                  json[name][0]["half_window"] = 60;
                }),
                HasSubstr(std::string(name) + "[0].half_window: expected at most"));
  }
  EXPECT_THAT(load_error([](Json& json) {
                json["removed"] = {{{"source", "*"}, {"m", 1}, {"target", "walk"}, {"n", 2}}};
              }),
              HasSubstr("removed[0].source: there is no clip '*'"));
  EXPECT_THAT(load_error([](Json& json) {
                json["removed"] = {{{"source", "walk"}, {"m", 1}, {"target", "walk"}, {"n", 50}}};
              }),
              HasSubstr("removed[0].n: expected an integer from 0 to 49"));
  EXPECT_THAT(
      load_error([](Json& json) {
        json["removed"] = {{{"source", "walk"}, {"m", 1}, {"target", "walk"}, {"n", 2}, {"within", 0}}};
      }),
      HasSubstr("removed[0].within: expected an integer from 1"));
  // Removed edges.
  EXPECT_THAT(load_error([](Json& json) {
                json["removed"] = {{{"source", "walk"}, {"target", "strol"}}};
              }),
              HasSubstr("removed[0].target: there is no clip 'strol'; did you mean 'stroll'?"));
}

TEST_F(GraphFile, WithAMisspeltFieldLoadsWithAWarning) {
  const test::CapturedLog log;
  EXPECT_EQ(load_error([](Json& json) { json["remvoed"] = Json::array(); }), "");
  EXPECT_THAT(log.text(), AllOf(HasSubstr("unknown field 'remvoed'"), HasSubstr("did you mean 'removed'?")));
}

TEST_F(GraphFile, IsNotSavedByHalves) {
  EXPECT_THROW(save_graph(graph_, folder_ / "none" / "graph.json"), FileError);
  write_text_file(path_, "old");
  SurfaceMotionGraph broken = graph_;
  broken.transitions.front().source_clip = 99;
  EXPECT_ANY_THROW(save_graph(broken, path_));
  EXPECT_EQ(read_text_file(path_), "old");
}

// A damaged file is an error or loads as a graph whose every part can be used: never a crash.
class DamagedGraphFile : public test::GraphTest {
 protected:
  void SetUp() override {
    graph_.transitions.resize(3);
    graph_.kept = {graph_.transitions[0]};
    graph_.added = {graph_.transitions[1]};
    graph_.removed = {{.source_clip = "walk", .target_clip = "*"},
                      {.source_clip = "walk", .target_clip = "stroll", .m = 12, .n = 20, .within = 6}};
    graph_.pruning = Pruning::dead_ends;
    save_graph(graph_, path_);
    whole_ = Json::parse(read_text_file(path_));
  }

  // True if it loads.
  bool survives(const std::string& text) const {
    write_text_file(path_, text);
    try {
      const SurfaceMotionGraph loaded = load_graph(path_);
      (void)loaded.active_transitions();
      save_graph(loaded, folder_ / "again.json");
      EXPECT_NO_THROW(load_graph(folder_ / "again.json"));
      return true;
    } catch (const FileError&) {
      return false;
    }
  }

  // Calls visit with the whole file after each change that `change` makes at one of its values.
  template <typename Change, typename Visit>
  void at_every_value(const Change& change, const Visit& visit) const {
    const Json flat = whole_.flatten();
    for (const auto& [pointer, value] : flat.items()) {
      // The value and everything it stands in.
      for (Json::json_pointer at(pointer); !at.empty(); at = at.parent_pointer()) {
        Json changed = whole_;
        change(changed, at);
        visit(changed);
      }
    }
  }

  Json whole_;
};

TEST_F(DamagedGraphFile, CutShort) {
  const std::string text = whole_.dump();
  for (std::size_t length = 0; length < text.size(); ++length) {
    EXPECT_FALSE(survives(text.substr(0, length))) << length;
  }
  EXPECT_TRUE(survives(text));
}

TEST_F(DamagedGraphFile, WithoutAField) {
  int loaded = 0;
  int refused = 0;
  at_every_value(
      [](Json& json, const Json::json_pointer& at) {
        Json& parent = json[at.parent_pointer()];
        if (parent.is_array()) {
          parent.erase(static_cast<std::size_t>(std::stoul(at.back())));
        } else {
          parent.erase(at.back());
        }
      },
      [&](const Json& json) { ++(survives(json.dump()) ? loaded : refused); });
  EXPECT_GT(loaded, 0);
  EXPECT_GT(refused, 20);
}

TEST_F(DamagedGraphFile, WithValuesOfAnotherKind) {
  int refused = 0;
  for (const Json& value : {Json(nullptr), Json(-1), Json(1e300), Json(99999), Json("*"), Json(""),
                            Json::array(), Json::object(), Json(true)}) {
    at_every_value([&](Json& json, const Json::json_pointer& at) { json[at] = value; },
                   [&](const Json& json) { refused += survives(json.dump()) ? 0 : 1; });
  }
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace reprise
