// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/graph/surface_motion_graph.h"

#include <functional>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/similarity/vertex_metric.h"
#include "support/shapes.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using Json = nlohmann::ordered_json;

PerformanceDatabase walks() {
  PerformanceDatabase database;
  database.add(test::walk("walk", 50));
  database.add(test::walk("stroll", 40, 0.02, 26.0, 5.0));
  return database;
}

SurfaceMotionGraph graph_of(const PerformanceDatabase& database) {
  const DissimilarityMatrix matrix = vertex_dissimilarity(database);
  return build_graph(database, matrix.metric(), find_transitions(database, matrix));
}

std::string argument_error(const std::function<void()>& call) {
  try {
    call();
  } catch (const InvalidArgument& error) {
    return error.what();
  }
  return "";
}

// Warnings logged while it lives.
class CapturedLog {
 public:
  CapturedLog() : before_(spdlog::default_logger()) {
    spdlog::set_default_logger(
        std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(text_)));
  }
  ~CapturedLog() { spdlog::set_default_logger(before_); }
  CapturedLog(const CapturedLog&) = delete;
  CapturedLog& operator=(const CapturedLog&) = delete;
  std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
  std::shared_ptr<spdlog::logger> before_;
};

class GraphTest : public ::testing::Test {
 protected:
  // The saved graph with a change, as text.
  std::string changed(const std::function<void(Json&)>& change) const {
    save_graph(graph_, path_);
    Json json = Json::parse(read_text_file(path_));
    change(json);
    return json.dump(2);
  }
  // Message of the error that loading this text gives, or an empty text.
  std::string load_error(const std::string& text) const {
    write_text_file(path_, text);
    try {
      load_graph(path_);
    } catch (const FileError& error) {
      return error.what();
    }
    return "";
  }
  std::string load_error(const std::function<void(Json&)>& change) const {
    return load_error(changed(change));
  }

  PerformanceDatabase database_ = walks();
  SurfaceMotionGraph graph_ = graph_of(database_);
  test::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "graph.json";
};

TEST_F(GraphTest, KnowsItsDatabase) {
  EXPECT_EQ(graph_.database_hash, database_.content_hash());
  EXPECT_EQ(graph_.metric, "vertex");
  ASSERT_EQ(graph_.clips.size(), 2U);
  EXPECT_EQ(graph_.clips[1].name, "stroll");
  EXPECT_EQ(graph_.clips[1].frame_count, 40);
  EXPECT_FALSE(graph_.transitions.empty());
  EXPECT_NO_THROW(check_graph_fits(graph_, database_));
}

TEST_F(GraphTest, RemovingAPairRemovesItsTransitionsOneWay) {
  graph_.removed = {{.source_clip = "walk", .target_clip = "stroll"}};
  std::size_t others = 0;
  for (const Transition& t : graph_.transitions) {
    const bool is_meant = t.source_clip == 0 && t.target_clip == 1;
    EXPECT_EQ(graph_.is_removed(t), is_meant);
    others += is_meant ? 0 : 1;
  }
  EXPECT_EQ(graph_.active_transitions().size(), others);
  EXPECT_LT(others, graph_.transitions.size());
}

TEST_F(GraphTest, RemovingOneTransitionRemovesJustThatOneAlsoWhenItMovesALittle) {
  for (const Transition& meant : graph_.transitions) {
    graph_.removed = {parse_edge(to_string(meant, graph_), graph_)};
    EXPECT_TRUE(graph_.is_removed(meant));
    EXPECT_EQ(graph_.active_transitions().size(), graph_.transitions.size() - 1);
    Transition moved = meant;
    moved.m += graph_.options.separation - 1;
    moved.n -= graph_.options.separation - 1;
    EXPECT_TRUE(graph_.is_removed(moved));
    moved.m += 1;
    EXPECT_FALSE(graph_.is_removed(moved));
  }
}

TEST_F(GraphTest, ParsesEdges) {
  EXPECT_EQ(parse_edge("walk->stroll", graph_),
            (RemovedEdge{.source_clip = "walk", .target_clip = "stroll"}));
  EXPECT_EQ(parse_edge(" walk -> walk ", graph_),
            (RemovedEdge{.source_clip = "walk", .target_clip = "walk"}));
  EXPECT_EQ(parse_edge("walk:12->stroll:30", graph_),
            (RemovedEdge{.source_clip = "walk", .target_clip = "stroll", .m = 12, .n = 30}));
  graph_.clips[0].name = "walk->run";
  EXPECT_EQ(parse_edge("walk->run:3->stroll:4", graph_),
            (RemovedEdge{.source_clip = "walk->run", .target_clip = "stroll", .m = 3, .n = 4}));
}

TEST_F(GraphTest, SaysWhatIsWrongWithAnEdge) {
  const auto error = [&](const std::string& text) {
    return argument_error([&] { parse_edge(text, graph_); });
  };
  EXPECT_THAT(error("walk"), HasSubstr("expected CLIP->CLIP"));
  EXPECT_THAT(error(""), HasSubstr("expected CLIP->CLIP"));
  EXPECT_THAT(error("wlak->stroll"), HasSubstr("did you mean 'walk'?"));
  EXPECT_THAT(error("walk->xyzzyxyzzy"), HasSubstr("the clips are walk, stroll"));
  EXPECT_THAT(error("walk:3->stroll"), HasSubstr("frame of one clip only"));
  EXPECT_THAT(error("walk->stroll:3"), HasSubstr("frame of one clip only"));
  EXPECT_THAT(error("walk:50->stroll:3"), HasSubstr("frames 0 to 49, asked for '50'"));
  EXPECT_THAT(error("walk:5->stroll:-3"), HasSubstr("asked for '-3'"));
  EXPECT_THAT(error("walk:->stroll:3"), HasSubstr("asked for ''"));
  EXPECT_THAT(error("walk:5x->stroll:3"), HasSubstr("asked for '5x'"));
}

TEST_F(GraphTest, FileGivesBackWhatWasSavedToTheLastBit) {
  graph_.options = {.transitions_per_pair = 7,
                    .criterion = WindowCriterion::paper_sum,
                    .acceleration_weight = 0.1,
                    .profile = BlendProfile::linear};
  graph_.removed = {{.source_clip = "walk", .target_clip = "stroll"},
                    {.source_clip = "stroll", .target_clip = "stroll", .m = 5, .n = 30}};
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
  ASSERT_EQ(loaded.transitions.size(), graph_.transitions.size());
  for (std::size_t i = 0; i < loaded.transitions.size(); ++i) {
    const Transition& a = loaded.transitions[i];
    const Transition& b = graph_.transitions[i];
    EXPECT_EQ(std::tie(a.source_clip, a.target_clip, a.m, a.n, a.half_window, a.source_from_target.yaw,
                       a.distortion, a.peak_acceleration, a.cost),
              std::tie(b.source_clip, b.target_clip, b.m, b.n, b.half_window, b.source_from_target.yaw,
                       b.distortion, b.peak_acceleration, b.cost));
    EXPECT_EQ(a.source_from_target.translation, b.source_from_target.translation);
  }
  const std::string first = read_text_file(path_);
  save_graph(loaded, path_);
  EXPECT_EQ(read_text_file(path_), first);
}

TEST_F(GraphTest, FileNamesClipsAndReadsTopDown) {
  save_graph(graph_, path_);
  const Json json = Json::parse(read_text_file(path_));
  EXPECT_EQ(json.begin().key(), "format");
  EXPECT_EQ(json["transitions"][0]["source"], "walk");
}

TEST_F(GraphTest, FileWithoutRemovedEdgesHasNone) {
  EXPECT_EQ(load_error([](Json& json) { json.erase("removed"); }), "");
  EXPECT_TRUE(load_graph(path_).removed.empty());
}

TEST_F(GraphTest, FileErrorsSayWhere) {
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
  EXPECT_THAT(load_error([](Json& json) { json["version"] = 2; }),
              HasSubstr("version 2, this program reads up to version 1"));
  EXPECT_THAT(load_error([](Json& json) { json["version"] = "one"; }),
              HasSubstr("version: expected an integer, found string \"one\""));
}

TEST_F(GraphTest, FileErrorsNameEveryMissingField) {
  for (const char* name : {"version", "database_hash", "metric", "options", "clips", "transitions"}) {
    EXPECT_THAT(load_error([&](Json& json) { json.erase(name); }),
                HasSubstr(std::string("graph.json:") + name + ": expected this field, found none"));
  }
  const Json whole = Json::parse(changed([](Json&) {}));
  for (const auto& [name, value] : whole["options"].items()) {
    EXPECT_THAT(load_error([&](Json& json) { json["options"].erase(name); }),
                HasSubstr(":options." + name + ": expected"));
    EXPECT_THAT(load_error([&](Json& json) { json["options"][name] = nullptr; }),
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

TEST_F(GraphTest, FileErrorsNameValuesOutOfRange) {
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
  // Removed edges.
  EXPECT_THAT(load_error([](Json& json) {
                json["removed"] = {{{"source", "walk"}, {"target", "strol"}}};
              }),
              HasSubstr("removed[0].target: there is no clip 'strol'; did you mean 'stroll'?"));
}

TEST_F(GraphTest, FileWithAMisspeltFieldLoadsWithAWarning) {
  const CapturedLog log;
  EXPECT_EQ(load_error([](Json& json) { json["remvoed"] = Json::array(); }), "");
  EXPECT_THAT(log.text(), AllOf(HasSubstr("unknown field 'remvoed'"), HasSubstr("did you mean 'removed'?")));
}

TEST_F(GraphTest, IsNotSavedByHalves) {
  EXPECT_THROW(save_graph(graph_, folder_ / "none" / "graph.json"), FileError);
  write_text_file(path_, "old");
  SurfaceMotionGraph broken = graph_;
  broken.transitions.front().source_clip = 99;
  EXPECT_ANY_THROW(save_graph(broken, path_));
  EXPECT_EQ(read_text_file(path_), "old");
}

TEST_F(GraphTest, SaysWhyItDoesNotFitAnotherDatabase) {
  const auto error = [&](std::vector<MeshSequence> clips) {
    PerformanceDatabase other;
    for (MeshSequence& clip : clips) other.add(std::move(clip));
    return argument_error([&] { check_graph_fits(graph_, other); });
  };
  const MeshSequence walk = database_.clip(0);
  const MeshSequence stroll = database_.clip(1);
  EXPECT_EQ(error({walk, stroll}), "");
  EXPECT_THAT(error({walk}), HasSubstr("it has a clip 'stroll', the database has walk"));
  EXPECT_THAT(error({stroll, walk}), HasSubstr("has the clips walk, stroll, the database has stroll, walk"));
  EXPECT_THAT(error({walk, stroll, test::walk("run", 5)}), HasSubstr("the database has walk, stroll, run"));
  EXPECT_THAT(error({walk, test::walk("stroll", 39)}),
              HasSubstr("its clip 'stroll' has 40 frames at 25 a second, the database's 39"));
  EXPECT_THAT(error({walk, test::walk("stroll", 40, 0.03)}), HasSubstr("other contents of the same clips"));
}

}  // namespace
}  // namespace reprise
