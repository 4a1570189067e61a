// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <atomic>
#include <csignal>
#include <fstream>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/hash.h"
#include "reprise/core/interrupt.h"
#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"
#include "reprise/core/random.h"
#include "reprise/core/text.h"
#include "support/test_data.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

std::size_t entry_count(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

// Lowers the largest size of a file the process may write, as a full disk would; the limit also holds for
// root.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &old_limit_);
    rlimit limit = old_limit_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_limit_);
    std::signal(SIGXFSZ, old_handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  void (*old_handler_)(int);
  rlimit old_limit_{};
};

class Interruption {
 public:
  Interruption() { set_interrupted(true); }
  ~Interruption() { set_interrupted(false); }
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
};

TEST(AtomicOutput, FileAppearsOnCommitAndNotBefore) {
  const test::TemporaryFolder folder;
  const fs::path target = folder / "clip.pc2";
  AtomicOutput output(target, AtomicOutput::Kind::file);
  EXPECT_EQ(output.path().parent_path(), target.parent_path());
  EXPECT_EQ(output.path().extension(), target.extension());
  std::ofstream(output.path()) << "new";
  EXPECT_FALSE(fs::exists(target));
  output.commit();
  EXPECT_EQ(read_text_file(target), "new");
  EXPECT_EQ(entry_count(folder.path()), 1U);
}

TEST(AtomicOutput, WithoutCommitTheOlderResultStaysAndNothingElse) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "clip.pc2";
  const fs::path frames = folder / "frames";
  write_text_file(file, "old");
  fs::create_directory(frames);
  write_text_file(frames / "0.obj", "old");
  {
    const AtomicOutput file_output(file, AtomicOutput::Kind::file);
    const AtomicOutput directory_output(frames, AtomicOutput::Kind::directory);
    std::ofstream(file_output.path()) << "new";
    write_text_file(directory_output.path() / "0.obj", "new");
  }
  EXPECT_EQ(read_text_file(file), "old");
  EXPECT_EQ(read_text_file(frames / "0.obj"), "old");
  EXPECT_EQ(entry_count(folder.path()), 2U);
}

TEST(AtomicOutput, CommitReplacesAnOlderDirectoryAsAWhole) {
  const test::TemporaryFolder folder;
  const fs::path target = folder / "frames";
  fs::create_directory(target);
  write_text_file(target / "old.obj", "old");
  AtomicOutput output(target / "", AtomicOutput::Kind::directory);
  write_text_file(output.path() / "new.obj", "new");
  output.commit();
  EXPECT_EQ(read_text_file(target / "new.obj"), "new");
  EXPECT_FALSE(fs::exists(target / "old.obj"));
  EXPECT_EQ(entry_count(folder.path()), 1U);
}

TEST(AtomicOutput, FailedCommitKeepsTheOlderDirectory) {
  const test::TemporaryFolder folder;
  const fs::path target = folder / "frames";
  fs::create_directory(target);
  write_text_file(target / "old.obj", "old");
  {
    AtomicOutput output(target, AtomicOutput::Kind::directory);
    fs::remove_all(output.path());
    EXPECT_THROW(output.commit(), FileError);
  }
  EXPECT_EQ(read_text_file(target / "old.obj"), "old");
  EXPECT_EQ(entry_count(folder.path()), 1U);
}

TEST(AtomicOutput, SymbolicLinkIsFollowed) {
  const test::TemporaryFolder folder;
  fs::create_directory(folder / "elsewhere");
  write_text_file(folder / "elsewhere/clip.pc2", "old");
  fs::create_symlink("elsewhere/clip.pc2", folder / "clip.pc2");
  write_text_file(folder / "clip.pc2", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "clip.pc2"));
  EXPECT_EQ(read_text_file(folder / "elsewhere/clip.pc2"), "new");
}

TEST(AtomicOutput, TwoOutputsToOneTargetDoNotDisturbEachOther) {
  const test::TemporaryFolder folder;
  AtomicOutput first(folder / "a.txt", AtomicOutput::Kind::file);
  AtomicOutput second(folder / "a.txt", AtomicOutput::Kind::file);
  std::ofstream(first.path()) << "first";
  std::ofstream(second.path()) << "second";
  first.commit();
  EXPECT_EQ(read_text_file(folder / "a.txt"), "first");
  second.commit();
  EXPECT_EQ(read_text_file(folder / "a.txt"), "second");
}

TEST(AtomicOutput, RefusesWhatCannotBeReplaced) {
  const test::TemporaryFolder folder;
  const auto open = [](const fs::path& target, AtomicOutput::Kind kind) {
    return [=] { const AtomicOutput output(target, kind); };
  };
  // Parent folder missing.
  EXPECT_THAT(open(folder / "missing/a.txt", AtomicOutput::Kind::file),
              ThrowsMessage<FileError>(AllOf(StartsWith((folder / "missing/a.txt").string() + ": "),
                                             HasSubstr((folder / "missing").string()))));
  // A folder where a file is to be written.
  EXPECT_THAT(open(folder.path(), AtomicOutput::Kind::file),
              ThrowsMessage<FileError>(HasSubstr("a folder where a file")));
  // A file where a folder is to be written.
  write_text_file(folder / "file", "old");
  EXPECT_THAT(open(folder / "file", AtomicOutput::Kind::directory),
              ThrowsMessage<FileError>(HasSubstr("a file where a folder")));
  // A device.
  EXPECT_THAT(open("/dev/null", AtomicOutput::Kind::file),
              ThrowsMessage<FileError>(StartsWith("/dev/null: ")));
  // No name at all.
  EXPECT_THROW(write_text_file("", "text"), FileError);
  EXPECT_EQ(entry_count(folder.path()), 1U);
}

TEST(TextFile, ReadsWhatWasWritten) {
  const test::TemporaryFolder folder;
  for (const std::string& text : {std::string(), std::string("a\r\nb\n"), std::string("\0\xff", 2)}) {
    write_text_file(folder / "a.txt", text);
    EXPECT_EQ(read_text_file(folder / "a.txt"), text);
  }
}

TEST(TextFile, FullDiskIsAnErrorThatKeepsTheOlderFile) {
  const test::TemporaryFolder folder;
  write_text_file(folder / "a.txt", "old");
  {
    const FileSizeLimit limit(1000);
    EXPECT_THAT(
        [&] { write_text_file(folder / "a.txt", std::string(100'000, 'x')); },
        ThrowsMessage<FileError>(StartsWith((folder / "a.txt").string() + ": cannot be written: File too")));
    // Little text reaches the disk only when the file is closed.
    const FileSizeLimit smaller_limit(10);
    EXPECT_THROW(write_text_file(folder / "a.txt", std::string(100, 'x')), FileError);
  }
  EXPECT_EQ(read_text_file(folder / "a.txt"), "old");
  EXPECT_EQ(entry_count(folder.path()), 1U);
}

TEST(TextFile, ReadingNamesTheFileAndTheReason) {
  const test::TemporaryFolder folder;
  EXPECT_THAT([&] { read_text_file(folder / "missing"); },
              ThrowsMessage<FileError>((folder / "missing").string() +
                                       ": cannot be read: No such file or directory"));
  EXPECT_THAT([&] { read_text_file(folder.path()); }, ThrowsMessage<FileError>(HasSubstr("it is a folder")));
  // Opens, but reading its first byte fails.
  EXPECT_THAT([] { read_text_file("/proc/self/mem"); },
              ThrowsMessage<FileError>(HasSubstr("Input/output error")));
}

TEST(FileError, MessageReadsPathPlaceWhat) {
  const FileError without_place("a/b.obj", "expected a number, found 'x'");
  EXPECT_STREQ(without_place.what(), "a/b.obj: expected a number, found 'x'");
  EXPECT_EQ(without_place.path(), "a/b.obj");
  const FileError with_place("a/b.obj", "17", "expected a number, found 'x'");
  EXPECT_STREQ(with_place.what(), "a/b.obj:17: expected a number, found 'x'");
  EXPECT_EQ(with_place.path(), "a/b.obj");
}

TEST(NaturalLess, OrdersNumbersByValue) {
  std::vector<std::string> names = {"f10.obj", "f2.obj", "g1.obj",
                                    "f.obj",   "f1.obj", "f100000000000000000000.obj"};
  std::ranges::sort(names, natural_less);
  EXPECT_THAT(names,
              ElementsAre("f.obj", "f1.obj", "f2.obj", "f10.obj", "f100000000000000000000.obj", "g1.obj"));
}

TEST(NaturalLess, IsAStrictTotalOrder) {
  // All words of up to four letters over a digit zero, a digit, a letter before the digits and one after
  // them.
  std::vector<std::string> words = {""};
  for (std::size_t first = 0, length = 0; length < 4; ++length) {
    const std::size_t last = words.size();
    for (; first < last; ++first) {
      for (const char letter : {'0', '7', '.', 'a'}) words.push_back(words[first] + letter);
    }
  }
  ASSERT_EQ(words.size(), 341U);
  for (const std::string& a : words) {
    for (const std::string& b : words) {
      ASSERT_EQ(natural_less(a, b) + natural_less(b, a), a == b ? 0 : 1) << a << " and " << b;
    }
  }
  // A relation of which exactly one direction holds for every pair is transitive if sorting puts every word
  // before all that follow it.
  std::ranges::sort(words, natural_less);
  for (std::size_t i = 0; i < words.size(); ++i) {
    for (std::size_t j = i + 1; j < words.size(); ++j) {
      ASSERT_TRUE(natural_less(words[i], words[j])) << words[i] << " and " << words[j];
    }
  }
}

TEST(NearestWord, OffersALikelyTypoOnly) {
  const std::vector<std::string> words = {"crane", "jumping", "walk"};
  EXPECT_EQ(nearest_word("jmuping", words), "jumping");
  EXPECT_EQ(nearest_word("wlk", words), "walk");
  EXPECT_EQ(nearest_word("crane", words), "crane");
  EXPECT_EQ(nearest_word("somersault", words), "");
  EXPECT_EQ(nearest_word("crane", {}), "");
}

TEST(NearestWord, MayDifferInAThirdOfTheLettersOrTwo) {
  const std::vector<std::string> words = {"abcdefghijkl"};
  EXPECT_EQ(nearest_word("....efghijkl", words), words[0]);
  EXPECT_EQ(nearest_word(".....fghijkl", words), "");
  EXPECT_EQ(nearest_word("..c", std::vector<std::string>{"abc"}), "abc");
  EXPECT_EQ(nearest_word("...", std::vector<std::string>{"abc"}), "");
}

TEST(ContentHash, EqualInputsGiveEqualHashes) {
  const std::vector<float> values = {1.0F, 2.0F};
  const auto hash = [&] {
    return ContentHash().add("text").add(std::span<const float>(values)).add_number(0.25).hex();
  };
  EXPECT_EQ(hash(), hash());
  EXPECT_EQ(hash().size(), 32U);
  EXPECT_EQ(hash().find_first_not_of("0123456789abcdef"), std::string::npos);
}

TEST(ContentHash, DependsOnWhereOneInputEnds) {
  EXPECT_NE(ContentHash().add("ab").add("c").hex(), ContentHash().add("a").add("bc").hex());
  EXPECT_NE(ContentHash().add("").add("a").hex(), ContentHash().add("a").add("").hex());
  const std::vector<float> values = {1.0F, 2.0F, 3.0F};
  const std::span<const float> all(values);
  EXPECT_NE(ContentHash().add(all.first(2)).add(all.last(1)).hex(),
            ContentHash().add(all.first(1)).add(all.last(2)).hex());
}

TEST(ContentHash, DependsOnOrderAndEveryByte) {
  EXPECT_NE(ContentHash().add("a").add("b").hex(), ContentHash().add("b").add("a").hex());
  EXPECT_NE(ContentHash().add_number(0.0).hex(), ContentHash().add_number(5e-324).hex());
}

TEST(Interrupt, ProgressThrowsCancelledOnceTheUserHasAskedToStop) {
  Progress progress("test", 3);
  EXPECT_NO_THROW(progress.advance());
  {
    const Interruption interruption;
    EXPECT_THROW(progress.advance(), Cancelled);
    EXPECT_THROW(throw_if_interrupted(), Cancelled);
  }
  EXPECT_NO_THROW(progress.advance());
}

TEST(Interrupt, SignalRaisesTheFlag) {
  install_interrupt_handler();
  ASSERT_FALSE(interrupted());
  std::raise(SIGINT);
  EXPECT_TRUE(interrupted());
  set_interrupted(false);
  EXPECT_NO_THROW(throw_if_interrupted());
  std::signal(SIGTERM, SIG_DFL);
}

TEST(InterruptDeathTest, SecondSignalEndsTheProcess) {
  EXPECT_EXIT(
      {
        install_interrupt_handler();
        std::raise(SIGINT);
        std::raise(SIGINT);
      },
      testing::KilledBySignal(SIGINT), "");
}

TEST(ParallelFor, CallsTheBodyOnceForEveryIndex) {
  std::vector<int> calls(1000, 0);
  parallel_for(10, calls.size(), [&](std::size_t i) { ++calls[i]; });
  parallel_for(5, 5, [&](std::size_t i) { ++calls[i]; });
  EXPECT_EQ(std::count(calls.begin(), calls.begin() + 10, 0), 10);
  EXPECT_EQ(std::count(calls.begin() + 10, calls.end(), 1), 990);
}

TEST(ParallelFor, PassesExceptionsOn) {
  const auto loop = [] {
    parallel_for(0, 100, [](std::size_t i) {
      if (i == 37) throw InvalidArgument("thirty-seven");
    });
  };
  EXPECT_THAT(loop, ThrowsMessage<InvalidArgument>("thirty-seven"));
}

TEST(ParallelFor, StopsWhenTheUserAsksTo) {
  const Interruption interruption;
  Progress progress("test", 100);
  EXPECT_THROW(parallel_for(0, 100, [&](std::size_t) { progress.advance(); }), Cancelled);
}

TEST(RandomField, NormalNumbersHaveTheirMoments) {
  const RandomField random(11);
  double sum = 0.0;
  double squares = 0.0;
  double product = 0.0;
  constexpr int count = 100000;
  for (std::uint64_t k = 0; k < count; ++k) {
    const auto [a, b] = random.normal_pair(k, 3);
    sum += a + b;
    squares += a * a + b * b;
    product += a * b;
  }
  // Five standard errors of 2 x 10^5 numbers.
  EXPECT_NEAR(sum / (2 * count), 0.0, 0.011);
  EXPECT_NEAR(squares / (2 * count), 1.0, 0.016);
  EXPECT_NEAR(product / count, 0.0, 0.016);
}

TEST(RandomField, KeysSeedsAndBranchesGiveOtherNumbersAndTheSameOnesAgain) {
  const RandomField random(5);
  EXPECT_EQ(random.uniform(7, 9), RandomField(5).uniform(7, 9));
  std::set<double> numbers;
  for (std::uint64_t k = 0; k < 1000; ++k) {
    for (const double x : {random.uniform(k), random.uniform(0, k + 1), random.branch(k).uniform(0),
                           RandomField(k + 6).uniform(0)}) {
      EXPECT_GT(x, 0.0);
      EXPECT_LT(x, 1.0);
      numbers.insert(x);
    }
  }
  EXPECT_EQ(numbers.size(), 4000U);
}

}  // namespace
}  // namespace reprise
