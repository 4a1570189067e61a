// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/database_file.h"

#include <cmath>
#include <fstream>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/hdf5.h"
#include "reprise/io/io_test_support.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;
namespace fs = std::filesystem;

void write_bytes(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

// Two clips on one topology, with everything a clip can have.
PerformanceDatabase rich_database() {
  MeshSequence first = test::dressed_walk("walk", 5, true, true);
  first.set_origins(
      {{.clip = "a", .frame_idx = 3},
       {.clip = "a", .frame_idx = 4, .partner_clip = "b", .partner_frame_idx = 7, .partner_weight = 0.25},
       {.clip = "a", .frame_idx = 5, .partner_clip = "a", .partner_frame_idx = 8, .partner_weight = 0.75},
       {.clip = "b", .frame_idx = 9},
       {.clip = "b", .frame_idx = 10}});
  MeshSequence second = test::dressed_walk("another walk é", 3);
  PerformanceDatabase database;
  database.add(std::move(first));
  database.add(std::move(second));
  return database;
}

// The database of tests/fixtures/database_v1.reprise.
PerformanceDatabase fixture_database() {
  const test::Shape shape = test::sphere(0);
  Topology topology = *shape.topology;
  topology.uvs = {{0.0F, 0.0F}, {1.0F, 0.0F}, {0.5F, 1.0F}};
  topology.triangle_uvs.assign(topology.triangles.size(), {0, 1, 2});
  const auto shared = std::make_shared<const Topology>(std::move(topology));
  PerformanceDatabase database;
  for (const char* name : {"rise", "blend"}) {
    MeshSequence clip(name, shared, 3, 25.0);
    for (std::size_t f = 0; f < 3; ++f) {
      clip.frame(f) = shape.positions;
      clip.frame(f).col(1).array() += 0.125F * static_cast<float>(f);
    }
    if (clip.name() == "rise") {
      std::vector<Color> colors;
      for (std::uint8_t i = 0; i < 18; ++i) colors.push_back({i, 100, 200});
      clip.set_colors(std::move(colors));
      for (std::size_t f = 0; f < 3; ++f) clip.mutable_normals(f).col(1).setOnes();
    } else {
      clip.set_colors({{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12}, {13, 14, 15}, {16, 17, 18}});
      clip.set_origins({{.clip = "rise", .frame_idx = 0},
                        {.clip = "rise",
                         .frame_idx = 1,
                         .partner_clip = "fall",
                         .partner_frame_idx = 4,
                         .partner_weight = 0.5},
                        {.clip = "fall", .frame_idx = 5}});
    }
    database.add(std::move(clip));
  }
  return database;
}

const fs::path& fixture_path() {
  static const fs::path path = fs::path(REPRISE_SOURCE_DIR) / "tests/fixtures/database_v1.reprise";
  return path;
}

TEST(DatabaseFixture, Version1StillLoads) {
  const PerformanceDatabase expected = fixture_database();
  const PerformanceDatabase found = load_database(fixture_path());
  ASSERT_EQ(found.clip_names(), expected.clip_names());
  for (std::size_t c = 0; c < 2; ++c) test::expect_equal(found.clip(c), expected.clip(c));
  const DatabaseReader reader(fixture_path());
  EXPECT_EQ(reader.note(), "{\"made\": \"for the tests\"}");
  EXPECT_EQ(reader.format_version(), 1);
  EXPECT_FALSE(reader.markup() || reader.clips()[0].has_truth || reader.topology()->texture);
}

TEST(DatabaseFile, FramesThatAreNoSurfaceAreShownButNotWorkedOn) {
  const test::TemporaryFolder folder;
  PerformanceDatabase database = fixture_database();
  MeshSequence bad = database.clip(0);
  bad.set_name("bad");
  bad.frame(1)(3, 1) = std::numeric_limits<float>::quiet_NaN();
  database.add(bad);
  save_database(database, folder / "a.reprise");
  const DatabaseReader reader(folder / "a.reprise");
  EXPECT_TRUE(std::isnan(reader.read_frame(2, 1).positions(3, 1)));
  EXPECT_EQ(reader.read_clip(0).frame_count(), database.clip(0).frame_count());
  const auto names_the_place =
      ThrowsMessage<FileError>(AllOf(HasSubstr("clip 'bad', frame 1"), HasSubstr("vertex 3")));
  EXPECT_THAT([&] { (void)reader.read_clip(2); }, names_the_place);
  EXPECT_THAT([&] { (void)load_database(folder / "a.reprise"); }, names_the_place);
}

TEST(DatabaseFile, EverythingComesBackAsItWas) {
  const test::TemporaryFolder folder;
  const PerformanceDatabase database = rich_database();
  save_database(database, folder / "a.reprise");
  EXPECT_THAT(test::entries(folder.path()), ElementsAre("a.reprise"));
  const PerformanceDatabase loaded = load_database(folder / "a.reprise");
  ASSERT_EQ(loaded.clip_names(), database.clip_names());  // in the order of adding, not of the alphabet
  for (std::size_t c = 0; c < database.clips().size(); ++c)
    test::expect_equal(loaded.clip(c), database.clip(c));
  EXPECT_EQ(loaded.content_hash(), database.content_hash());
}

TEST(DatabaseFile, FramesReadOneByOneAreThoseOfTheClip) {
  const test::TemporaryFolder folder;
  const PerformanceDatabase database = rich_database();
  save_database(database, folder / "a.reprise");
  const DatabaseReader reader(folder / "a.reprise");
  ASSERT_EQ(reader.clips().size(), 2U);
  EXPECT_TRUE(reader.clips()[0].has_normals && reader.clips()[0].has_colors && reader.clips()[0].has_origins);
  EXPECT_TRUE(!reader.clips()[1].has_normals && reader.clips()[1].has_colors &&
              !reader.clips()[1].has_origins);
  for (std::size_t c = 0; c < 2; ++c) {
    ASSERT_EQ(reader.clips()[c].frame_count, database.clip(c).frame_count());
    for (std::size_t f = 0; f < database.clip(c).frame_count(); ++f) {
      const Mesh found = reader.read_frame(c, f);
      const Mesh expected = database.clip(c).mesh(f);
      EXPECT_EQ(found.topology, reader.topology());
      EXPECT_EQ(found.positions, expected.positions);
      EXPECT_EQ(found.normals, expected.normals);
      EXPECT_EQ(found.colors, expected.colors);
    }
  }
  EXPECT_THROW(reader.read_frame(0, 5), InvalidArgument);
  EXPECT_THROW(reader.read_frame(2, 0), InvalidArgument);
  EXPECT_THROW(reader.read_clip(2), InvalidArgument);
}

TEST(DatabaseFile, ColorsThatNeverChangeAreStoredOnceWhateverTheWriterWasGiven) {
  const test::TemporaryFolder folder;
  MeshSequence clip = test::dressed_walk("walk", 4);
  std::vector<Color> repeated;
  for (std::size_t f = 0; f < 4; ++f)
    repeated.insert(repeated.end(), clip.colors(0).begin(), clip.colors(0).end());
  clip.set_colors(repeated);
  MeshSequence late = clip;  // changes in the last frame alone
  late.set_name("late");
  repeated.back() = {1, 1, 1};
  late.set_colors(repeated);
  DatabaseWriter writer(folder / "a.reprise", clip.topology());
  writer.write_clip(clip);
  writer.write_clip(late);
  writer.commit();
  const DatabaseReader reader(folder / "a.reprise");
  EXPECT_FALSE(reader.read_clip(0).has_colors_per_frame());
  EXPECT_TRUE(std::ranges::equal(reader.read_clip(0).colors(3), clip.colors(3)));
  test::expect_equal(reader.read_clip(1), late);
}

TEST(DatabaseFile, TheSameContentGivesTheSameBytes) {
  const test::TemporaryFolder folder;
  save_database(rich_database(), folder / "a.reprise");
  save_database(rich_database(), folder / "b.reprise");
  EXPECT_EQ(read_text_file(folder / "a.reprise"), read_text_file(folder / "b.reprise"));
}

TEST(DatabaseFile, NoteComesBackAndMayBeMissing) {
  const test::TemporaryFolder folder;
  const MeshSequence clip = test::walk("walk", 2);
  const std::string note = "{\"cost\": 1.5, \"name\": \"é\"}\n" + std::string(100000, 'x');
  for (const std::string& text : {note, std::string()}) {
    DatabaseWriter writer(folder / "a.reprise", clip.topology());
    writer.write_clip(clip);
    writer.set_note(text);
    writer.commit();
    EXPECT_EQ(DatabaseReader(folder / "a.reprise").note(), text);
  }
}

TEST(DatabaseFile, NothingAppearsBeforeCommitAndAnOlderFileStays) {
  const test::TemporaryFolder folder;
  const MeshSequence clip = test::walk("walk", 2);
  {
    DatabaseWriter writer(folder / "a.reprise", clip.topology());
    writer.write_clip(clip);
    EXPECT_FALSE(fs::exists(folder / "a.reprise"));
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
  save_database(rich_database(), folder / "a.reprise");
  const std::string before = read_text_file(folder / "a.reprise");
  {
    DatabaseWriter writer(folder / "a.reprise", clip.topology());
    writer.write_clip(clip);
  }
  EXPECT_EQ(read_text_file(folder / "a.reprise"), before);
  EXPECT_THAT(test::entries(folder.path()), ElementsAre("a.reprise"));
}

TEST(DatabaseFile, NeverReplacesAForeignFile) {
  const test::TemporaryFolder folder;
  write_bytes(folder / "thesis.txt", "years of work");
  EXPECT_THROW(save_database(rich_database(), folder / "thesis.txt"), FileError);
  EXPECT_EQ(read_text_file(folder / "thesis.txt"), "years of work");
  Hdf5File::create(folder / "other.h5").finish();
  EXPECT_THROW(save_database(rich_database(), folder / "other.h5"), FileError);
  fs::create_directory(folder / "folder");
  EXPECT_THROW(save_database(rich_database(), folder / "folder"), FileError);
  EXPECT_THROW(save_database(rich_database(), folder / "missing" / "a.reprise"), FileError);
}

TEST(DatabaseFile, ReadingSaysWhatIsWrongWithAFile) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "a.reprise";
  const auto open = [&] { DatabaseReader reader(path); };
  EXPECT_THAT(open, ThrowsMessage<FileError>(HasSubstr("no such file")));
  fs::create_directory(path);
  EXPECT_THAT(open, ThrowsMessage<FileError>(HasSubstr("not a file")));
  fs::remove(path);
  write_bytes(path, "");
  EXPECT_THAT(open, ThrowsMessage<FileError>(HasSubstr("empty")));
  write_bytes(path, "solid cube");
  EXPECT_THAT(open, ThrowsMessage<FileError>(HasSubstr("not a Reprise database")));
  Hdf5File::create(path).finish();
  EXPECT_THAT(open, ThrowsMessage<FileError>(HasSubstr("HDF5 file but not a Reprise")));
  fs::remove(path);

  save_database(rich_database(), path);
  const std::string bytes = read_text_file(path);
  write_bytes(path, bytes.substr(0, bytes.size() - 1));
  EXPECT_THAT(open,
              ThrowsMessage<FileError>(AllOf(HasSubstr("truncated"), HasSubstr(std::to_string(bytes.size())),
                                             HasSubstr(std::to_string(bytes.size() - 1)))));
  std::string later = bytes;
  later.replace(later.find("version 2"), 9, "version 4");
  write_bytes(path, later);
  EXPECT_THAT(open, ThrowsMessage<FileError>(AllOf(HasSubstr("version 4"), HasSubstr("up to 3"))));
}

TEST(DatabaseFile, AnyTruncationIsAnErrorNeverACrash) {
  const test::TemporaryFolder folder;
  save_database(fixture_database(), folder / "a.reprise");
  const std::string bytes = read_text_file(folder / "a.reprise");
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 40) {
    write_bytes(folder / "b.reprise", bytes.substr(0, size));
    EXPECT_THROW(load_database(folder / "b.reprise"), FileError) << size;
  }
}

// A flipped bit in numbers goes unnoticed, one in the structure must be an error.
TEST(DatabaseFile, DamageIsAnErrorOrAWholeDatabaseNeverACrash) {
  const test::TemporaryFolder folder;
  save_database(fixture_database(), folder / "a.reprise");
  const std::string bytes = read_text_file(folder / "a.reprise");
  int refused = 0;
  int tried = 0;
  for (std::size_t at = 0; at < bytes.size(); at += 23) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 8)));
    write_bytes(folder / "b.reprise", damaged);
    ++tried;
    try {
      const PerformanceDatabase database = load_database(folder / "b.reprise");
      EXPECT_EQ(database.frame_count(), 6U) << at;
    } catch (const FileError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, tried / 4);
}

TEST(DatabaseFile, ArraysOfWrongShapeAreNamed) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "a.reprise";
  const auto write = [&](const Hdf5Shape& positions_shape, std::int32_t corner, std::int64_t index) {
    Hdf5File file = Hdf5File::create(path, 512);
    file.write_text("format", "Reprise performance database");
    file.write_integer("clip_count", 1);
    {
      Hdf5Group topology = file.create_group("topology");
      topology.write_integer("vertex_count", 3);
      const std::vector<std::int32_t> triangle = {0, 1, corner};
      topology.write<std::int32_t>("triangles", {1, 3}, triangle);
      Hdf5Group clip = file.create_group("clips").create_group("walk");
      clip.write_integer("index", index);
      clip.write_integer("frame_count", 2);
      clip.write_number("frames_per_second", 25.0);
      std::vector<float> values(positions_shape[0] * positions_shape[1] * positions_shape[2]);
      // One vertex on each axis: a triangle with an area.
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = i / 3 % 3 == i % 3 ? 1.0F : 0.0F;
      clip.write<float>("positions", positions_shape, values);
    }
    file.finish();
    std::fstream stream(path, std::ios::binary | std::ios::in | std::ios::out);
    stream << "REPRISE DATABASE\nversion 1\nbytes " << fs::file_size(path) << '\n';
  };
  const auto open = [&] { load_database(path); };
  write({2, 3, 3}, 2, 0);
  EXPECT_NO_THROW(open());
  write({2, 4, 3}, 2, 0);
  EXPECT_THAT(open, ThrowsMessage<FileError>(AllOf(HasSubstr("/clips/walk/positions"), HasSubstr("(2, 3, 3)"),
                                                   HasSubstr("(2, 4, 3)"))));
  write({1, 3, 3}, 2, 0);
  EXPECT_THAT(open, ThrowsMessage<FileError>(HasSubstr("(1, 3, 3)")));
  write({2, 3, 3}, 9, 0);
  EXPECT_THAT(open, ThrowsMessage<FileError>(HasSubstr("vertex 9")));
  write({2, 3, 3}, 2, 1);
  EXPECT_THAT(open, ThrowsMessage<FileError>(HasSubstr("index")));
}

TEST(DatabaseFile, FullDiskAtAnyPointIsAnErrorAndLeavesTheOlderFile) {
  const test::TemporaryFolder folder;
  const PerformanceDatabase database = rich_database();
  save_database(database, folder / "whole.reprise");
  const std::size_t size = fs::file_size(folder / "whole.reprise");
  fs::remove(folder / "whole.reprise");
  save_database(fixture_database(), folder / "a.reprise");
  const std::string before = read_text_file(folder / "a.reprise");
  for (int step = 0; step < 60; ++step) {
    const std::size_t limit = size * static_cast<std::size_t>(step) / 60;
    const test::FullDisk full(limit);
    EXPECT_THAT(
        [&] { save_database(database, folder / "a.reprise"); },
        ThrowsMessage<FileError>(AllOf(HasSubstr("a.reprise: cannot be written"), HasSubstr("too large"))))
        << limit;
    EXPECT_THAT(test::entries(folder.path()), ElementsAre("a.reprise")) << limit;
  }
  EXPECT_EQ(read_text_file(folder / "a.reprise"), before);
  save_database(database, folder / "a.reprise");  // and the library is as good as new
  EXPECT_EQ(load_database(folder / "a.reprise").frame_count(), database.frame_count());
}

TEST(DatabaseWriter, RefusesWhatDoesNotFit) {
  const test::TemporaryFolder folder;
  const MeshSequence clip = test::dressed_walk("walk", 2, false, true);
  const Mesh mesh = clip.mesh(0);
  DatabaseWriter writer(folder / "a.reprise", clip.topology());
  // Names and rates.
  for (const char* name : {"", "a:b", "a/b", "."})
    EXPECT_THROW(writer.begin_clip(name, 25.0), InvalidArgument);
  EXPECT_THROW(writer.begin_clip("a", 0.0), InvalidArgument);
  // Frames before a clip, another topology, missing positions.
  EXPECT_THROW(writer.append(mesh), InvalidArgument);
  writer.begin_clip("a", 25.0);
  Mesh other = mesh;
  other.topology = test::sphere(1).topology;
  EXPECT_THROW(writer.append(other), InvalidArgument);
  other = mesh;
  other.positions.resize(3, 3);
  EXPECT_THROW(writer.append(other), InvalidArgument);
  // Frames of one clip all have normals and colours, or none.
  writer.append(mesh);
  other = mesh;
  other.normals.resize(0, 3);
  EXPECT_THROW(writer.append(other), InvalidArgument);
  other = mesh;
  other.colors.clear();
  EXPECT_THROW(writer.append(other), InvalidArgument);
  // A taken name, origins that do not match, a clip without frames.
  EXPECT_THROW(writer.begin_clip("a", 25.0), InvalidArgument);
  writer.set_origins(std::vector<FrameOrigin>(2));
  EXPECT_THROW(writer.begin_clip("b", 25.0), InvalidArgument);
  writer.set_origins({});
  writer.begin_clip("b", 25.0);
  EXPECT_THROW(writer.commit(), InvalidArgument);
  writer.append(mesh);
  writer.commit();
  EXPECT_THROW(writer.begin_clip("c", 25.0), InvalidArgument);
  EXPECT_EQ(load_database(folder / "a.reprise").clip_names(), (std::vector<std::string>{"a", "b"}));
}

}  // namespace
}  // namespace reprise
