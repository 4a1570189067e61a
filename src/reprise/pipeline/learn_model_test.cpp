// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "model learn", and what other stages do with a learnt model.

#include "reprise/pipeline/learn_model.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/database/learnt_model_test_support.h"
#include "reprise/io/database_file.h"
#include "reprise/io/markup_file.h"
#include "reprise/io/sequence_writer.h"
#include "reprise/pipeline/import.h"
#include "reprise/pipeline/inspect.h"
#include "reprise/synthetic/figure/figure.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;
using Model = LearnModelOptions::Model;
namespace fs = std::filesystem;

const PerformanceDatabase& figure() {
  static const PerformanceDatabase made = make_figure({.voxel_size = 0.06});
  return made;
}

// Few examples: the laws here do not need more.
LearnModelOptions quick(Model model = Model::both) {
  return {.model = model, .selection = {.count = 8}};
}

bool names_clip(const LearntModel& model, const std::string& clip) {
  return std::ranges::any_of(model.parts, [&](const LearntPart& learnt) {
    return std::ranges::any_of(learnt.examples,
                               [&](const std::string& frame) { return frame.starts_with(clip + ":"); });
  });
}

class LearnModelStage : public testing::Test {
 protected:
  LearnModelStage() { save_database(figure(), file_, "a note"); }

  const test::TemporaryFolder folder_;
  const fs::path file_ = folder_ / "f.reprise";
};

TEST_F(LearnModelStage, ReplacesTheFileOrWritesAnotherWithEverythingItHeld) {
  const std::string before = read_text_file(file_);
  const LearnModelResult result = learn_models(file_, quick(), folder_ / "g.reprise");
  EXPECT_EQ(read_text_file(file_), before);
  const PerformanceDatabase written = load_database(folder_ / "g.reprise");
  test::expect_equal(written.models(), result.models);
  EXPECT_EQ(written.content_hash(), figure().content_hash());
  EXPECT_EQ(written.appearance_hash(), figure().appearance_hash());
  EXPECT_TRUE(written.markup() && written.truth(0) != nullptr);
  EXPECT_EQ(DatabaseReader(folder_ / "g.reprise").note(), "a note");
  learn_models(file_, quick());
  EXPECT_EQ(read_text_file(file_), read_text_file(folder_ / "g.reprise"));

  const std::vector<std::string> names = {"torso", "head", "left_arm", "right_arm", "left_leg", "right_leg"};
  ASSERT_EQ(result.models.part.parts.size(), names.size());
  ASSERT_EQ(result.models.whole.parts.size(), 1U);
  const nlohmann::json& parts = result.report["models"]["part"]["parts"];
  for (std::size_t p = 0; p < names.size(); ++p) {
    const LearntPart& learnt = result.models.part.parts[p];
    EXPECT_EQ(learnt.part.name, names[p]);
    EXPECT_LE(learnt.examples.size(), 8U);
    EXPECT_LT(static_cast<std::size_t>(learnt.component_count()), learnt.examples.size());
    EXPECT_GE(learnt.kept_variance(), 0.99);
    EXPECT_EQ(parts[p]["examples"], learnt.examples.size());
    EXPECT_EQ(parts[p]["components"], learnt.component_count());
    EXPECT_GT(parts[p]["covering_radius"].get<double>(), 0.0);
    EXPECT_LT(parts[p]["covering_radius"].get<double>(), 0.2);
  }
  const nlohmann::json info = describe_database(file_);
  EXPECT_EQ(info["format_version"], database_format_version);
  EXPECT_EQ(info["models"]["part"]["parts"].size(), names.size());
  EXPECT_EQ(info["models"]["whole"]["parts"][0]["name"], "body");
  EXPECT_TRUE(describe_database(folder_ / "g.reprise")["models"]["part"]["parts"][0]["vertices"] ==
              result.models.part.parts[0].part.vertices.size());
}

TEST_F(LearnModelStage, MoreExamplesCoverMoreAndMoreVarianceTakesMoreComponents) {
  const auto body = [&](const LearnModelOptions& options) {
    return learn_models(figure(), options).report["models"]["whole"]["parts"][0];
  };
  LearnModelOptions options = quick(Model::whole);
  const nlohmann::json few = body(options);
  options.selection.count = 16;
  const nlohmann::json more = body(options);
  EXPECT_LT(more["covering_radius"].get<double>(), few["covering_radius"].get<double>());
  options.learning.kept_variance = 0.8;
  const nlohmann::json coarse = body(options);
  EXPECT_LT(coarse["components"].get<int>(), more["components"].get<int>());
  EXPECT_LT(coarse["kept_variance"].get<double>(), more["kept_variance"].get<double>());
  options.learning.most_components = 1;
  EXPECT_EQ(body(options)["components"], 1);
}

TEST_F(LearnModelStage, IsTheSameForAnyNumberOfThreads) {
  const auto learn_on = [](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return learn_models(figure(), quick()).models;
  };
  test::expect_equal(learn_on(1), learn_on(3));
}

TEST_F(LearnModelStage, AWrittenListOfExamplesLearnsTheSameAgain) {
  const fs::path list = folder_ / "list.json";
  const LearnModelResult chosen = learn_models(file_, quick(), folder_ / "g.reprise", list);
  LearnModelOptions options = quick();
  options.examples = list;
  options.selection.count = 1;  // a list is taken whole
  const LearnModelResult listed = learn_models(figure(), options);
  test::expect_equal(listed.models, chosen.models);
  for (const char* model : {"part", "whole"}) {
    EXPECT_EQ(listed.report["models"][model]["parts"], chosen.report["models"][model]["parts"]);
  }
}

TEST_F(LearnModelStage, NothingIsLearntFromClipsHeldOut) {
  LearnModelOptions options = quick();
  ASSERT_TRUE(names_clip(learn_models(figure(), options).models.part, "wave"));
  options.without = {"wave", "jog"};
  const LearnModelResult result = learn_models(figure(), options);
  for (const LearntModel& model : {result.models.part, result.models.whole}) {
    EXPECT_FALSE(names_clip(model, "wave") || names_clip(model, "jog"));
  }
  EXPECT_EQ(result.report["held_out"], nlohmann::json({"wave", "jog"}));
  options.without = {"wvae"};
  EXPECT_THAT([&] { (void)learn_models(figure(), options); },
              ThrowsMessage<InvalidArgument>(HasSubstr("did you mean 'wave'")));
  options.without = figure().clip_names();
  EXPECT_THAT([&] { (void)learn_models(figure(), options); },
              ThrowsMessage<InvalidArgument>(AllOf(HasSubstr("'torso'"), HasSubstr("no frame is left"))));
}

TEST_F(LearnModelStage, LearningOneModelKeepsTheOther) {
  PerformanceDatabase database = figure();
  database.set_models(learn_models(database, quick(Model::part)).models);
  EXPECT_TRUE(database.models().whole.parts.empty());
  const LearntModel parts = database.models().part;
  const LearnModelResult result = learn_models(database, quick(Model::whole));
  test::expect_equal(result.models.part, parts);
  EXPECT_EQ(result.models.whole.parts.size(), 1U);
  EXPECT_TRUE(result.report["models"]["part"].is_null());
}

TEST_F(LearnModelStage, WithoutMarkupTheWholeBodyIsLearntOnItsFirstFrame) {
  PerformanceDatabase database = figure();
  database.set_markup(std::nullopt);
  for (const Model model : {Model::both, Model::part}) {
    EXPECT_THAT([&] { (void)learn_models(database, quick(model)); },
                ThrowsMessage<InvalidArgument>(
                    AllOf(HasSubstr("no markup"), HasSubstr("reprise markup"), HasSubstr("--model whole"))));
  }
  const LearnModelResult result = learn_models(database, quick(Model::whole));
  EXPECT_EQ(result.models.whole.reference, Positions(database.clip(0).frame(0)));
  EXPECT_TRUE(result.models.part.parts.empty());
  EXPECT_THROW((void)learn_models(PerformanceDatabase(), quick(Model::whole)), InvalidArgument);
}

TEST_F(LearnModelStage, PartsComeFromTheMarkupFromItsJointsOrFromAFile) {
  LearnModelOptions options = quick(Model::part);
  options.selection.count = 3;
  options.scheme = PartScheme::limbs;
  const LearntModel limbs = learn_models(figure(), options).models.part;
  const auto shin =
      std::ranges::find(limbs.parts, "left_shin", [](const LearntPart& learnt) { return learnt.part.name; });
  ASSERT_NE(shin, limbs.parts.end());
  EXPECT_EQ(limbs.parts[static_cast<std::size_t>(shin->part.parent)].part.name, "left_thigh");

  // A markup without parts gets six; a file is as good as the database's own.
  PerformanceDatabase database = figure();
  Markup markup = *database.markup();
  markup.parts.clear();
  database.set_markup(markup);
  const LearntModel six =
      learn_models(database, {.model = Model::part, .selection = {.count = 3}}).models.part;
  EXPECT_EQ(six.parts.size(), 6U);
  write_markup_file(figure(), folder_ / "markup.json");
  database.set_markup(std::nullopt);
  const LearnModelResult filed = learn_models(
      database, {.model = Model::part, .parts = folder_ / "markup.json", .selection = {.count = 3}});
  test::expect_equal(filed.models.part, six);
}

TEST_F(LearnModelStage, APartThatDoesNotOverlapItsParentIsNamedWithItsFile) {
  Markup markup = *figure().markup();
  ASSERT_EQ(markup.parts[4].name, "left_leg");
  markup.parts[4].parent = 1;  // the head
  PerformanceDatabase database = figure();
  database.set_markup(markup);
  EXPECT_THAT([&] { (void)learn_models(database, quick()); },
              ThrowsMessage<InvalidArgument>(AllOf(HasSubstr("'left_leg'"), HasSubstr("'head'"))));
  write_markup_file(database, folder_ / "apart.json");
  LearnModelOptions options = quick();
  options.parts = folder_ / "apart.json";
  EXPECT_THAT([&] { (void)learn_models(figure(), options); },
              ThrowsMessage<FileError>(AllOf(HasSubstr("apart.json"), HasSubstr("'left_leg'"))));
}

TEST_F(LearnModelStage, AListSaysWhichPartItLeavesWithoutExamples) {
  const auto with_list = [&](const std::string& contents, Model model = Model::both) {
    write_text_file(folder_ / "list.json",
                    R"({"format": "reprise examples", "version": 1, )" + contents + "}");
    LearnModelOptions options = quick(model);
    options.examples = folder_ / "list.json";
    options.without = {"jog"};
    return [this, options] { (void)learn_models(figure(), options); };
  };
  EXPECT_NO_THROW(with_list(R"("frames": ["walk:0-20:5", "stand:0"])")());
  // A list for some parts only; the whole body is one of them.
  EXPECT_THAT(
      with_list(R"("parts": {"torso": ["walk:0"], "head": ["walk:0"]})"),
      ThrowsMessage<FileError>(AllOf(HasSubstr("list.json"), HasSubstr("no example for part 'left_arm'"))));
  EXPECT_NO_THROW(with_list(R"("parts": {"body": ["walk:0", "walk:9"]})", Model::whole)());
  EXPECT_THAT(with_list(R"("parts": {"tail": ["walk:0"]})"),
              ThrowsMessage<FileError>(HasSubstr("no part 'tail'")));
  EXPECT_THAT(with_list(R"("frames": [])"), ThrowsMessage<FileError>(HasSubstr("list.json")));
  EXPECT_THAT(with_list(R"("frames": ["walk:0", "jog:3"])"),
              ThrowsMessage<FileError>(AllOf(HasSubstr("jog:3"), HasSubstr("held out"))));
  // One example is a shape without freedom.
  LearnModelOptions options = quick(Model::whole);
  options.selection.count = 1;
  EXPECT_EQ(learn_models(figure(), options).models.whole.parts[0].component_count(), 0);
}

TEST_F(LearnModelStage, RefusesWhatCannotBeBeforeItWrites) {
  const std::string before = read_text_file(file_);
  EXPECT_THAT([&] { (void)learn_models(file_, quick(), file_); },
              ThrowsMessage<InvalidArgument>(HasSubstr("not written over")));
  EXPECT_THROW((void)learn_models(file_, quick(), folder_ / "nowhere" / "g.reprise"), FileError);
  EXPECT_THROW((void)learn_models(file_, quick(), folder_ / "g.txt"), InvalidArgument);
  LearnModelOptions options = quick();
  options.selection.count = 0;
  EXPECT_THROW((void)learn_models(file_, options), InvalidArgument);
  options = quick();
  options.learning.kept_variance = 1.5;
  EXPECT_THROW((void)learn_models(file_, options), InvalidArgument);
  EXPECT_EQ(read_text_file(file_), before);
}

TEST_F(LearnModelStage, CommandsThatRewriteADatabaseKeepItsModels) {
  const LearntModels models = learn_models(file_, quick()).models;
  mark_up(file_, {.parts = PartScheme::limbs}, folder_ / "limbs.reprise");
  test::expect_equal(load_database(folder_ / "limbs.reprise").models(), models);
  mark_up(file_, {.write_json = folder_ / "markup.json"}, {});
  mark_up(file_, {.file = folder_ / "markup.json"}, folder_ / "again.reprise");
  test::expect_equal(load_database(folder_ / "again.reprise").models(), models);
  write_sequence(figure().clip(0), folder_ / "stand.pc2", SequenceFormat::pc2);
  const std::string source =
      "late=" + (folder_ / "stand.pc2").string() + ",topology=" + (folder_ / "stand.ply").string();
  import_sequences(file_, {.sequences = {parse_import_sequence(source)}, .append = true});
  const PerformanceDatabase longer = load_database(file_);
  EXPECT_EQ(longer.clip_names().back(), "late");
  test::expect_equal(longer.models(), models);
}

}  // namespace
}  // namespace reprise
