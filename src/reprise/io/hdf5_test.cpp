// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/hdf5.h"

#include <numeric>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/io/io_test_support.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(Hdf5, AttributesTextsAndArraysComeBack) {
  const test::TemporaryFolder folder;
  const std::vector<float> values = {1.0F, -2.5F, 3e-9F, 4e20F, 5.0F, 6.0F};
  const std::vector<std::string> names = {"crane", "", "jumping é"};
  {
    Hdf5File file = Hdf5File::create(folder / "a.h5");
    file.write_integer("count", -7);
    file.write_number("rate", 0.1);
    file.write_text("title", "Größe");
    file.write_text("empty", "");
    Hdf5Group group = file.create_group("group");
    group.write<float>("values", {2, 3}, values);
    group.write_text_dataset("names", std::span<const std::string>(names));
    group.write_text_dataset("text", std::string("one text"));
    file.finish();
  }
  const Hdf5File file = Hdf5File::open(folder / "a.h5");
  EXPECT_EQ(file.read_integer("count"), -7);
  EXPECT_EQ(file.read_number("rate"), 0.1);
  EXPECT_EQ(file.read_text("title"), "Größe");
  EXPECT_EQ(file.read_text("empty"), "");
  EXPECT_FALSE(file.has_attribute("missing"));
  EXPECT_THAT(file.children(), ElementsAre("group"));
  const Hdf5Group group = file.group("group");
  EXPECT_THAT(group.children(), ElementsAre("names", "text", "values"));
  EXPECT_TRUE(group.is_dataset("values"));
  EXPECT_FALSE(file.is_dataset("group"));
  EXPECT_EQ(group.dataset("values").read<float>(), values);
  EXPECT_EQ(group.dataset("names").read_texts(), names);
  EXPECT_THAT(group.dataset("text").read_texts(), ElementsAre("one text"));
}

TEST(Hdf5, NumbersConvertBetweenTypes) {
  const test::TemporaryFolder folder;
  {
    Hdf5File file = Hdf5File::create(folder / "a.h5");
    const std::vector<double> values = {0.5, 1.0, 2.0};
    file.write<double>("values", {3}, values);
    file.finish();
  }
  const Hdf5Dataset dataset = Hdf5File::open(folder / "a.h5").dataset("values");  // outlives the file object
  EXPECT_EQ(dataset.type(), Hdf5Type::float64);
  EXPECT_THAT(dataset.read<float>(), ElementsAre(0.5F, 1.0F, 2.0F));
}

TEST(Hdf5, BlocksAreReadWhereTheyWereWrittenForEveryKindOfChunk) {
  const test::TemporaryFolder folder;
  const std::vector<Hdf5DatasetOptions> kinds = {{.chunk_rows = 1, .growable = true},
                                                 {.chunk_rows = 4, .growable = true, .deflate = 1},
                                                 {.chunk_rows = 2, .growable = true, .checksum = true}};
  std::vector<std::int32_t> all(std::size_t{7} * 5);
  std::iota(all.begin(), all.end(), 100);
  for (const Hdf5DatasetOptions& kind : kinds) {
    {
      Hdf5File file = Hdf5File::create(folder / "a.h5");
      Hdf5Dataset dataset = file.create_dataset("values", Hdf5Type::int32, {0, 5}, kind);
      for (std::size_t row = 0; row < 7; ++row) {
        dataset.resize_rows(row + 1);
        dataset.write<std::int32_t>({row, 0}, {1, 5}, std::span(all).subspan(row * 5, 5));
      }
      file.finish();
    }
    const Hdf5Dataset dataset = Hdf5File::open(folder / "a.h5").dataset("values");
    EXPECT_EQ(dataset.shape(), (Hdf5Shape{7, 5}));
    EXPECT_EQ(dataset.read<std::int32_t>(), all);
    std::vector<std::int32_t> column(3);
    dataset.read<std::int32_t>({2, 4}, {3, 1}, std::span(column));
    EXPECT_THAT(column, ElementsAre(114, 119, 124));
    EXPECT_THROW(dataset.read<std::int32_t>({5, 4}, {3, 1}, std::span(column)), FileError);
    EXPECT_THROW(dataset.read<std::int32_t>({2, 4}, {2, 1}, std::span(column)), InvalidArgument);
  }
}

TEST(Hdf5, ErrorsNameTheFileThePlaceAndTheReason) {
  const test::TemporaryFolder folder;
  EXPECT_THAT([&] { Hdf5File::open(folder / "none.h5"); },
              ThrowsMessage<FileError>(HasSubstr("no such file")));
  {
    Hdf5File file = Hdf5File::create(folder / "a.h5");
    file.write_text("title", "a");
    file.write_text_dataset("text", std::string("b"));
    file.create_group("group");
    file.finish();
  }
  const Hdf5File file = Hdf5File::open(folder / "a.h5");
  EXPECT_THAT([&] { static_cast<void>(file.group("nothing")); },
              ThrowsMessage<FileError>(AllOf(HasSubstr("a.h5:/nothing"), HasSubstr("HDF5: "))));
  EXPECT_THAT([&] { static_cast<void>(file.dataset("group")); },
              ThrowsMessage<FileError>(HasSubstr("/group")));
  EXPECT_THAT([&] { static_cast<void>(file.read_integer("title")); },
              ThrowsMessage<FileError>(HasSubstr("'title' is not one integer")));
  EXPECT_THAT([&] { static_cast<void>(file.read_integer("nothing")); },
              ThrowsMessage<FileError>(HasSubstr("'nothing'")));
  EXPECT_THAT([&] { static_cast<void>(file.dataset("text").read<float>()); },
              ThrowsMessage<FileError>(HasSubstr("expected an array of numbers")));
  EXPECT_THAT([&] { file.dataset("text").check_shape({3}); },
              ThrowsMessage<FileError>(AllOf(HasSubstr("(3)"), HasSubstr("found ()"))));
}

TEST(Hdf5, ArrayLargerThanItsFileIsRefused) {
  const test::TemporaryFolder folder;
  {
    Hdf5File file = Hdf5File::create(folder / "a.h5");
    file.create_dataset("huge", Hdf5Type::float64, {std::size_t{1} << 50, 1},
                        {.chunk_rows = 1, .growable = true});
    file.finish();
  }
  const Hdf5File file = Hdf5File::open(folder / "a.h5");
  EXPECT_THAT([&] { static_cast<void>(file.dataset("huge")); },
              ThrowsMessage<FileError>(HasSubstr("more than")));
}

TEST(Hdf5, FailedWritesAreReportedByFinishAndTheFileCloses) {
  const test::TemporaryFolder folder;
  const std::vector<double> values(100000, 1.0);
  const test::FullDisk full(10000);
  Hdf5File file = Hdf5File::create(folder / "a.h5");
  file.write<double>("values", {values.size()}, values);
  EXPECT_THROW(file.check_writes(), FileError);
  EXPECT_THAT([&] { file.finish(); }, ThrowsMessage<FileError>(HasSubstr("cannot be written")));
}

TEST(Hdf5, ThreadsMayReadOneFileAtATime) {
  const test::TemporaryFolder folder;
  std::vector<std::int32_t> values(1000);
  std::iota(values.begin(), values.end(), 0);
  {
    Hdf5File file = Hdf5File::create(folder / "a.h5");
    file.create_dataset("values", Hdf5Type::int32, {1000}, {.chunk_rows = 10})
        .write<std::int32_t>({0}, {1000}, std::span<const std::int32_t>(values));
    file.finish();
  }
  const Hdf5File file = Hdf5File::open(folder / "a.h5");
  const Hdf5Dataset dataset = file.dataset("values");
  std::array<bool, 4> correct{};
  {
    std::vector<std::jthread> threads;
    for (std::size_t t = 0; t < 4; ++t) {
      threads.emplace_back([&, t] {
        bool all = true;
        for (std::size_t i = t; i < 1000; i += 4) {
          std::int32_t value = -1;
          dataset.read<std::int32_t>({i}, {1}, std::span(&value, 1));
          const bool has = file.has("values") && !file.has("nothing");
          all = all && has && value == static_cast<std::int32_t>(i);
        }
        correct[t] = all;
      });
    }
  }
  EXPECT_THAT(correct, testing::Each(true));
}

}  // namespace
}  // namespace reprise
