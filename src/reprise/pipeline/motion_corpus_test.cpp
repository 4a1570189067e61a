// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/motion_corpus.h"

#include <functional>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "support/test_data.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

class MotionCorpus : public testing::Test {
 protected:
  MotionCorpus() {
    for (const char* folder : {"amc", "asf", "bvh"}) fs::create_directory(folder_ / folder);
    for (const char* file :
         {"amc/07_01.amc", "amc/35_17.amc", "asf/07.asf", "bvh/07_12.bvh", "bvh/07_01.bvh"}) {
      write_text_file(folder_ / file, "");
    }
  }

  std::vector<CorpusTrial> read(const std::string& text) const {
    write_text_file(folder_ / "index.csv", text);
    return read_corpus(folder_ / "index.csv");
  }
  std::string complaint(const std::string& text) const {
    try {
      read(text);
    } catch (const FileError& error) {
      return error.what();
    }
    return {};
  }

  const test::TemporaryFolder folder_;
};

TEST_F(MotionCorpus, ReadsFieldsWithCommasAndFindsTheMotions) {
  const auto corpus = read(
      "trial,subject,class,description,frames,fps,tier\r\n"
      "07_01,07,walk,\"walk, then \"\"stop\"\"\",316,60,core\r\n"
      "\r\n"
      "35_17,,run,run,100,,run\r\n"
      "07_12,07,walk,brisk walk,263,120,core\r\n");
  ASSERT_EQ(corpus.size(), 3U);
  EXPECT_EQ(corpus[0].description, "walk, then \"stop\"");
  EXPECT_EQ(corpus[0].frames, 316U);
  EXPECT_EQ(corpus[0].tier, "core");
  EXPECT_EQ(corpus[0].source.motion, folder_ / "amc" / "07_01.amc");  // before a BVH of the same name
  EXPECT_EQ(corpus[0].source.skeleton, folder_ / "asf" / "07.asf");
  EXPECT_EQ(corpus[0].source.frames_per_second, 60.0);
  EXPECT_EQ(corpus[1].source.skeleton, folder_ / "asf" / "35.asf");  // the subject is in the name
  EXPECT_EQ(corpus[1].source.frames_per_second, 120.0);
  EXPECT_EQ(corpus[2].source.motion, folder_ / "bvh" / "07_12.bvh");
  EXPECT_TRUE(corpus[2].source.skeleton.empty());
}

TEST_F(MotionCorpus, NamesTheLineOfWhatIsWrong) {
  EXPECT_THAT(complaint("name,class\n07_01,walk\n"), HasSubstr("column 'trial'"));
  EXPECT_THAT(complaint("trial,class\n07_01\n"), HasSubstr("line 2: expected 2 fields"));
  EXPECT_THAT(complaint("trial,class\n07_01,\"walk\n"), HasSubstr("line 2: a quote"));
  EXPECT_THAT(complaint("trial\n07_01\n07_01\n"), HasSubstr("line 3: trial '07_01' is listed twice"));
  EXPECT_THAT(complaint("trial\n99_01\n"), HasSubstr("99_01.amc"));
  EXPECT_THAT(complaint("trial\n../x\n"), HasSubstr("no name of a trial"));
  EXPECT_THAT(complaint("trial,frames\n07_01,many\n"), HasSubstr("frames: expected a positive number"));
  EXPECT_THAT(complaint("trial,fps\n07_01,-1\n"), HasSubstr("fps: expected a positive number"));
  EXPECT_THAT(complaint("trial\n"), HasSubstr("lists no trials"));
  EXPECT_THROW(read_corpus(folder_ / "nowhere.csv"), FileError);
}

TEST_F(MotionCorpus, ChoosesByTierAndName) {
  const auto corpus = read("trial,tier\n07_01,core\n07_12,core\n35_17,run\n");
  const auto names = [](const std::vector<CorpusTrial>& trials) {
    std::vector<std::string> all;
    for (const CorpusTrial& trial : trials) all.push_back(trial.trial);
    return all;
  };
  EXPECT_THAT(names(chosen_trials(corpus, {}, {})), testing::ElementsAre("07_01", "07_12", "35_17"));
  EXPECT_THAT(names(chosen_trials(corpus, {"run"}, {})), testing::ElementsAre("35_17"));
  EXPECT_THAT(names(chosen_trials(corpus, {}, {"35_17", "07_01"})), testing::ElementsAre("07_01", "35_17"));
  EXPECT_THAT([&] { chosen_trials(corpus, {"rum"}, {}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("'run'")));
  EXPECT_THAT([&] { chosen_trials(corpus, {}, {"07_11"}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("did you mean '07_01'?")));
  EXPECT_THROW(chosen_trials(corpus, {"run"}, {"07_01"}), InvalidArgument);
}

TEST(MotionCorpusOfCmu, HasEveryTrialOfItsReadme) {
  REPRISE_REQUIRE_DATA();
  const auto corpus = read_corpus(test::data_folder() / "cmu" / "index.csv");
  ASSERT_EQ(corpus.size(), 131U);
  std::map<std::string, int> classes;
  std::map<std::string, int> kinds;
  for (const CorpusTrial& trial : corpus) {
    ++classes[trial.motion_class];
    ++kinds[trial.source.motion.extension().string()];
    EXPECT_TRUE(trial.source.skeleton.empty() || fs::exists(trial.source.skeleton)) << trial.trial;
  }
  EXPECT_EQ(classes["walk"], 100);
  EXPECT_EQ(classes["run"], 31);
  EXPECT_EQ(kinds[".amc"], 130);
  // 89 walks and 30 runs
  EXPECT_EQ(chosen_trials(corpus, {"core", "core-stop"}, {}).size(), 119U);
}

}  // namespace
}  // namespace reprise
