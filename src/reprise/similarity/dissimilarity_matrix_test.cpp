// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/dissimilarity_matrix.h"

#include <fstream>
#include <limits>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/io/hdf5.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;

constexpr float infinity = std::numeric_limits<float>::infinity();

// Exact, bounded and unknown entries in turn, at least one of each from three pairs on.
DissimilarityMatrix mixed(std::vector<std::string> names, std::vector<std::size_t> frame_counts) {
  DissimilarityMatrix matrix("vertex", "key", std::move(names), std::move(frame_counts));
  std::mt19937 random(1);
  std::uniform_real_distribution<float> value(0.1F, 0.5F);
  std::size_t count = 0;
  for (std::size_t a = 0; a < matrix.frame_count(); ++a) {
    for (std::size_t b = a + 1; b < matrix.frame_count(); ++b, ++count) {
      const float v = value(random);
      const float yaw = 10.0F * (value(random) - 0.3F);
      if (count % 3 == 0) matrix.set(a, b, v, yaw);
      if (count % 3 == 1) matrix.set(a, b, {.lower = 0.9F * v, .value = v, .yaw = yaw});
    }
  }
  return matrix;
}

TEST(DissimilarityMatrixTest, StartsUnknownWithAnExactDiagonal) {
  const DissimilarityMatrix matrix("vertex", "key", {"a", "b"}, {2, 3});
  EXPECT_EQ(matrix.pair_count(), 10U);
  EXPECT_EQ(matrix.unknown_count(), 10U);
  EXPECT_EQ(matrix.exact_count(), 0U);
  for (std::size_t a = 0; a < 5; ++a) {
    for (std::size_t b = 0; b < 5; ++b) {
      EXPECT_EQ(matrix.value(a, b), a == b ? 0.0F : infinity);
      EXPECT_EQ(matrix.lower_bound(a, b), 0.0F);
      EXPECT_EQ(matrix.is_exact(a, b), a == b);
      EXPECT_EQ(matrix.entry(a, b).is_exact(), a == b);
    }
  }
}

TEST(DissimilarityMatrixTest, IsSymmetricWithOppositeYaw) {
  const DissimilarityMatrix matrix = mixed({"a", "b"}, {4, 5});
  for (std::size_t a = 0; a < 9; ++a) {
    for (std::size_t b = 0; b < 9; ++b) {
      EXPECT_EQ(matrix.value(a, b), matrix.value(b, a));
      EXPECT_EQ(matrix.lower_bound(a, b), matrix.lower_bound(b, a));
      EXPECT_EQ(matrix.yaw(a, b), -matrix.yaw(b, a));
      const MatrixEntry expected{matrix.lower_bound(a, b), matrix.value(a, b), matrix.yaw(a, b)};
      EXPECT_EQ(matrix.entry(a, b), expected);
    }
  }
}

TEST(DissimilarityMatrixTest, KeepsEveryEntryApart) {
  DissimilarityMatrix matrix("vertex", "key", {"a", "b", "c"}, {3, 1, 4});
  const auto entry = [](std::size_t a, std::size_t b) {
    const auto v = static_cast<float>(10 * a + b);
    return MatrixEntry{.lower = v, .value = v + 0.5F, .yaw = v / 100.0F};
  };
  for (std::size_t a = 0; a < 8; ++a) {
    for (std::size_t b = a + 1; b < 8; ++b) matrix.set(a, b, entry(a, b));
  }
  for (std::size_t a = 0; a < 8; ++a) {
    for (std::size_t b = a + 1; b < 8; ++b) EXPECT_EQ(matrix.entry(a, b), entry(a, b));
  }
}

TEST(DissimilarityMatrixTest, CountsWhatIsExactAndWhatIsUnknown) {
  DissimilarityMatrix matrix = mixed({"a"}, {6});  // 15 pairs
  EXPECT_EQ(matrix.exact_count(), 5U);
  EXPECT_EQ(matrix.unknown_count(), 5U);
  matrix.set(0, 3, 0.25F, 0.0F);  // was unknown
  matrix.set(0, 2, 0.25F, 0.0F);  // was bounded
  EXPECT_EQ(matrix.exact_count(), 7U);
  EXPECT_EQ(matrix.unknown_count(), 4U);
  // Frames that look alike to the last bit: zero is a value like any other.
  matrix.set(0, 2, 0.0F, 0.0F);
  EXPECT_EQ(matrix.exact_count(), 7U);
}

TEST(DissimilarityMatrixTest, RefusesNamesWithoutFrameCounts) {
  EXPECT_THROW(DissimilarityMatrix("vertex", "k", {"a", "b"}, {1}), InvalidArgument);
}

class DissimilarityFile : public ::testing::Test {
 protected:
  // Message of the error that loading gives, or an empty text.
  std::string load_error() const {
    try {
      DissimilarityMatrix::load(path_);
    } catch (const FileError& error) {
      return error.what();
    }
    return "";
  }

  test::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "matrix.h5";
};

TEST_F(DissimilarityFile, GivesBackWhatWasSaved) {
  const DissimilarityMatrix saved = mixed({"a", "b"}, {5, 6});
  saved.save(path_);
  const DissimilarityMatrix loaded = DissimilarityMatrix::load(path_);
  EXPECT_EQ(loaded.metric(), saved.metric());
  EXPECT_EQ(loaded.key(), saved.key());
  EXPECT_EQ(loaded.clip_names(), saved.clip_names());
  EXPECT_EQ(loaded.clip_frame_counts(), saved.clip_frame_counts());
  ASSERT_EQ(loaded.frame_count(), saved.frame_count());
  for (std::size_t a = 0; a < saved.frame_count(); ++a) {
    for (std::size_t b = 0; b < saved.frame_count(); ++b) {
      EXPECT_EQ(loaded.entry(a, b), saved.entry(a, b));
    }
  }
}

TEST_F(DissimilarityFile, HoldsMatricesWithoutPairs) {
  DissimilarityMatrix("vertex", "k", {}, {}).save(path_);
  EXPECT_EQ(DissimilarityMatrix::load(path_).frame_count(), 0U);
  DissimilarityMatrix("vertex", "k", {"a"}, {1}).save(path_);
  EXPECT_EQ(DissimilarityMatrix::load(path_).frame_count(), 1U);
}

TEST_F(DissimilarityFile, SaysWhatIsWrongWithIt) {
  // Missing.
  EXPECT_THAT(load_error(), HasSubstr("matrix.h5"));
  // Not HDF5.
  std::ofstream(path_) << "hello";
  EXPECT_THAT(load_error(), HasSubstr("matrix.h5"));
  // HDF5 of somebody else.
  Hdf5File::create(path_).finish();
  EXPECT_THAT(load_error(), HasSubstr("not a dissimilarity matrix"));
  // Of a later version, or of the one without lower bounds.
  for (const int version : {99, 1}) {
    Hdf5File file = Hdf5File::create(path_);
    file.write_text("signature", "reprise dissimilarity matrix");
    file.write_integer("version", version);
    file.finish();
    EXPECT_THAT(load_error(), HasSubstr(fmt::format("version {}, expected 2", version)));
  }
  // Arrays that are not of the size the clips ask for, and values that no metric gives.
  const auto write_bounds = [&](std::uint64_t frames, const std::vector<float>& lower_bounds,
                                const std::vector<float>& values, const std::vector<float>& yaws) {
    Hdf5File file = Hdf5File::create(path_);
    file.write_text("signature", "reprise dissimilarity matrix");
    file.write_integer("version", 2);
    file.write_text("metric", "vertex");
    file.write_text("key", "k");
    file.write_integer("clip_count", 1);
    file.write_text_dataset("clip_names", std::vector<std::string>{"a"});
    file.write<std::uint64_t>("clip_frame_counts", {1}, std::vector<std::uint64_t>{frames});
    file.write<float>("lower_bounds", {lower_bounds.size()}, lower_bounds);
    file.write<float>("values", {values.size()}, values);
    file.write<float>("yaws", {yaws.size()}, yaws);
    file.finish();
  };
  const auto write = [&](std::uint64_t frames, const std::vector<float>& values,
                         const std::vector<float>& yaws) { write_bounds(frames, values, values, yaws); };
  write(3, {1, 2, 3}, {0, 0, 0});
  EXPECT_EQ(load_error(), "");
  write(4, {1, 2, 3}, {0, 0, 0});
  EXPECT_THAT(load_error(), HasSubstr("lower_bounds: expected an array of shape (6), found (3)"));
  write_bounds(3, {1, 2, 3}, {1, 2}, {0, 0, 0});
  EXPECT_THAT(load_error(), HasSubstr("values: expected an array of shape (3), found (2)"));
  write(3, {1, 2, 3}, {0, 0});
  EXPECT_THAT(load_error(), HasSubstr("yaws"));
  write(std::numeric_limits<std::uint64_t>::max(), {1, 2, 3}, {0, 0, 0});
  EXPECT_THAT(load_error(), HasSubstr("clip_frame_counts"));
  write(3, {1, -2, 3}, {0, 0, 0});
  EXPECT_THAT(load_error(), HasSubstr("entry 1"));
  write(3, {1, 2, std::numeric_limits<float>::quiet_NaN()}, {0, 0, 0});
  EXPECT_THAT(load_error(), HasSubstr("entry 2"));
  write(3, {1, infinity, 3}, {0, 0, 0});
  EXPECT_THAT(load_error(), HasSubstr("lower_bounds, entry 1"));
  write_bounds(3, {1, 0, 2}, {1, infinity, 3}, {0, 0, 0});
  EXPECT_EQ(load_error(), "");
  write_bounds(3, {1, 2, 4}, {1, 2, 3}, {0, 0, 0});
  EXPECT_THAT(load_error(), HasSubstr("lower_bounds, entry 2"));
  write_bounds(3, {-1, 2, 3}, {1, 2, 3}, {0, 0, 0});
  EXPECT_THAT(load_error(), HasSubstr("lower_bounds, entry 0"));
  write_bounds(3, {1, std::numeric_limits<float>::quiet_NaN(), 3}, {1, 2, 3}, {0, 0, 0});
  EXPECT_THAT(load_error(), HasSubstr("lower_bounds, entry 1"));
  write_bounds(3, {1, 2}, {1, 2, 3}, {0, 0, 0});
  EXPECT_THAT(load_error(), HasSubstr("lower_bounds"));
  write(3, {1, 2, 3}, {0, 0, 9});
  EXPECT_THAT(load_error(), HasSubstr("expected an angle"));
  // Truncated anywhere.
  mixed({"b"}, {6}).save(path_);
  const auto size = std::filesystem::file_size(path_);
  for (std::uintmax_t left = size - 1; left > 0; left -= std::min<std::uintmax_t>(left, 97)) {
    std::filesystem::resize_file(path_, left);
    EXPECT_THAT(load_error(), HasSubstr("matrix.h5"));
  }
}

TEST_F(DissimilarityFile, IsNotWrittenIntoAMissingFolder) {
  const DissimilarityMatrix matrix = mixed({"b"}, {6});
  EXPECT_THROW(matrix.save(folder_ / "missing" / "matrix.h5"), FileError);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "missing"));
}

}  // namespace
}  // namespace reprise
