// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/sequence_reader.h"

#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/io/dfaust.h"
#include "reprise/io/frame_files.h"
#include "reprise/io/hdf5.h"
#include "reprise/io/pc2.h"
#include "support/test_data.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const FileError& error) {
    return error.what();
  }
  return "no FileError was thrown";
}

std::string open_error(const SequenceSource& source) {
  return message_of([&] { open_sequence(source); });
}

// A triangle whose first vertex is (frame, 0, 0).
std::string obj_frame(double frame, const std::string& faces = "f 1 2 3\n") {
  return fmt::format("v {} 0 0\nv 0 1 0\nv 0 0 1\n{}", frame, faces);
}

std::string ply_frame(double frame) {
  return fmt::format(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n{} 0 0\n0 1 0\n0 0 1\n3 0 1 2\n",
      frame);
}

// What `obj_frame` and `ply_frame` say, of frames 0 to count - 1.
std::vector<float> triangle_frames(int count) {
  std::vector<float> values;
  for (int f = 0; f < count; ++f) {
    values.insert(values.end(), {static_cast<float>(f), 0, 0, 0, 1, 0, 0, 0, 1});
  }
  return values;
}

void append(std::string& bytes, std::uint32_t value, std::endian order) {
  for (int i = 0; i < 4; ++i) {
    const int shift = 8 * (order == std::endian::little ? i : 3 - i);
    bytes += static_cast<char>(value >> shift & 0xff);
  }
}

std::string pc2_file(std::int32_t vertices, const std::vector<float>& values) {
  std::string bytes("POINTCACHE2\0", 12);
  const auto add = [&](std::uint32_t value) { append(bytes, value, std::endian::little); };
  add(1);
  add(static_cast<std::uint32_t>(vertices));
  add(std::bit_cast<std::uint32_t>(0.0f));
  add(std::bit_cast<std::uint32_t>(1.0f));
  add(static_cast<std::uint32_t>(values.size()) / 3 / static_cast<std::uint32_t>(vertices));
  for (const float value : values) add(std::bit_cast<std::uint32_t>(value));
  return bytes;
}

std::string mdd_file(std::int32_t vertices, const std::vector<float>& times,
                     const std::vector<float>& values) {
  std::string bytes;
  const auto add = [&](std::uint32_t value) { append(bytes, value, std::endian::big); };
  add(static_cast<std::uint32_t>(times.size()));
  add(static_cast<std::uint32_t>(vertices));
  for (const float time : times) add(std::bit_cast<std::uint32_t>(time));
  for (const float value : values) add(std::bit_cast<std::uint32_t>(value));
  return bytes;
}

TEST(FolderReader, FramesComeInTheOrderOfTheirNumbers) {
  for (const std::string extension : {"obj", "ply", "OBJ"}) {
    const TemporaryFolder folder;
    for (const int frame : {8, 9, 10, 11}) {
      write_text_file(folder / fmt::format("take2_{}.{}", frame, extension),
                      extension == "ply" ? ply_frame(frame) : obj_frame(frame));
    }
    write_text_file(folder / "README.md", "not a frame");
    write_text_file(folder / "._take2_7.obj", "not a frame either");
    const auto reader = open_sequence({.path = folder.path()});
    ASSERT_EQ(reader->frame_count(), 4u);
    EXPECT_EQ(reader->frames_per_second(), std::nullopt);
    for (std::size_t i = 0; i < 4; ++i) {
      const Mesh mesh = reader->read(i);
      EXPECT_EQ(mesh.positions(0, 0), static_cast<float>(8 + i));
      EXPECT_EQ(mesh.topology, reader->topology());
      EXPECT_EQ(reader->frame_bytes(i), fs::file_size(reader->frame_name(i)));
    }
    EXPECT_THAT(reader->frame_name(2), HasSubstr("take2_10." + extension));
    EXPECT_THROW(reader->read(4), InvalidArgument);
  }
}

TEST(FolderReader, PaddedAndUnpaddedNumbersMix) {
  const TemporaryFolder folder;
  for (const char* name : {"099.obj", "100.obj", "0101.obj"}) write_text_file(folder / name, obj_frame(1));
  EXPECT_EQ(open_sequence({.path = folder.path()})->frame_count(), 3u);
}

TEST(FolderReader, ASingleFileNeedsNoNumber) {
  const TemporaryFolder folder;
  write_text_file(folder / "statue.ply", ply_frame(1));
  EXPECT_EQ(open_sequence({.path = folder.path()})->frame_count(), 1u);
}

TEST(FolderReader, PositionsAreScaledToMetres) {
  const TemporaryFolder folder;
  write_text_file(folder / "0.obj", obj_frame(175));
  EXPECT_FLOAT_EQ(open_sequence({.path = folder.path(), .scale = 0.01})->read(0).positions(0, 0), 1.75f);
}

TEST(FolderReader, ColoursAndNormalsMayChangeFromFrameToFrame) {
  const TemporaryFolder folder;
  write_text_file(folder / "0.obj",
                  "v 1 0 0 1 0 0\nv 0 1 0 1 0 0\nv 0 0 1 1 0 0\nvn 0 0 1\nf 1//1 2//1 3//1\n");
  write_text_file(folder / "1.obj",
                  "v 1 0 0 0 1 0\nv 0 1 0 0 1 0\nv 0 0 1 0 1 0\nvn 0 1 0\nf 1//1 2//1 3//1\n");
  const auto reader = open_sequence({.path = folder.path()});
  EXPECT_EQ(reader->read(0).colors[2], (Color{255, 0, 0}));
  EXPECT_EQ(reader->read(1).colors[2], (Color{0, 255, 0}));
  EXPECT_EQ(reader->read(0).normals.row(1), Eigen::RowVector3f(0, 0, 1));
  EXPECT_EQ(reader->read(1).normals.row(1), Eigen::RowVector3f(0, 1, 0));
}

TEST(FolderReader, SameFacesWrittenDifferentlyAreTheSame) {
  const TemporaryFolder folder;
  write_text_file(folder / "0.obj", obj_frame(1, "f 1 2 3\n"));
  write_text_file(folder / "1.obj", obj_frame(2, "g body\nf -3 -2 -1"));
  EXPECT_EQ(open_sequence({.path = folder.path()})->read(1).positions(0, 0), 2.0f);
}

TEST(FolderErrors, EveryUnusableFolderIsNamedWithItsReason) {
  // Missing path.
  EXPECT_THAT(open_error({.path = "/no/such/folder"}), HasSubstr("/no/such/folder: does not exist"));
  {  // Empty folder, and one without frames.
    const TemporaryFolder folder;
    EXPECT_THAT(open_error({.path = folder.path()}), HasSubstr("holds no frames"));
    write_text_file(folder / "README.md", "");
    EXPECT_THAT(open_error({.path = folder.path()}), HasSubstr("holds no frames"));
    // A folder of point caches.
    write_text_file(folder / "walk.pc2", "");
    EXPECT_THAT(open_error({.path = folder.path()}), HasSubstr("walk.pc2 is a sequence itself"));
  }
  {  // A gap in the numbering.
    const TemporaryFolder folder;
    for (const char* name : {"f_0008.obj", "f_0009.obj", "f_0012.obj"})
      write_text_file(folder / name, obj_frame(1));
    EXPECT_THAT(open_error({.path = folder.path()}),
                HasSubstr("frame f_0010.obj is missing between f_0009.obj and f_0012.obj"));
  }
  {  // Files of several kinds.
    const TemporaryFolder folder;
    write_text_file(folder / "f_0.obj", obj_frame(1));
    write_text_file(folder / "f_1.ply", ply_frame(1));
    EXPECT_THAT(open_error({.path = folder.path()}),
                AllOf(HasSubstr("several kinds"), HasSubstr("f_0.obj"), HasSubstr("f_1.ply")));
  }
  {  // Several sequences.
    const TemporaryFolder folder;
    for (const char* name : {"run_0.obj", "run_1.obj", "walk_0.obj"})
      write_text_file(folder / name, obj_frame(1));
    EXPECT_THAT(open_error({.path = folder.path()}), AllOf(HasSubstr("run_0.obj"), HasSubstr("walk_0.obj")));
  }
  {  // Two numbers that vary.
    const TemporaryFolder folder;
    for (const char* name : {"take1_0.obj", "take1_1.obj", "take2_0.obj"})
      write_text_file(folder / name, obj_frame(1));
    EXPECT_THAT(open_error({.path = folder.path()}), HasSubstr("differ in several numbers"));
  }
  {  // One number twice.
    const TemporaryFolder folder;
    for (const char* name : {"f_1.obj", "f_01.obj"}) write_text_file(folder / name, obj_frame(1));
    EXPECT_THAT(open_error({.path = folder.path()}), HasSubstr("holds frame 1 twice"));
  }
  {  // A number beyond reason.
    const TemporaryFolder folder;
    write_text_file(folder / "f_1234567890123456789012345.obj", obj_frame(1));
    EXPECT_THAT(open_error({.path = folder.path()}), HasSubstr("more than 18 digits"));
  }
}

TEST(FolderErrors, EveryUnusableFrameIsNamedWithItsReason) {
  const TemporaryFolder folder;
  for (int i = 0; i < 3; ++i) write_text_file(folder / fmt::format("f_{}.obj", i), obj_frame(1 + i));
  const auto reader = open_sequence({.path = folder.path()});
  const auto error_of = [&](const std::string& text) {
    write_text_file(folder / "f_2.obj", text);
    return message_of([&] { reader->read(2); });
  };
  // Another vertex count: both frames and the difference.
  EXPECT_THAT(error_of("v 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 1\nf 1 2 3\n"),
              AllOf(HasSubstr("f_0.obj has 3 vertices"), HasSubstr("f_2.obj has 4")));
  // Other faces: both frames and the first difference.
  EXPECT_THAT(error_of(obj_frame(1, "f 1 3 2\n")),
              AllOf(HasSubstr("triangle 0 is (0, 1, 2) in f_0.obj"), HasSubstr("(0, 2, 1) in f_2.obj")));
  EXPECT_THAT(error_of(obj_frame(1, "f 1 2 3\nf 3 2 1\n")),
              AllOf(HasSubstr("f_0.obj has 1 triangles"), HasSubstr("f_2.obj has 2")));
  // Colours or normals in some frames only.
  EXPECT_THAT(error_of("v 1 0 0 1 0 0\nv 0 1 0 1 0 0\nv 0 0 1 1 0 0\nf 1 2 3\n"),
              HasSubstr("f_2.obj has vertex colours, f_0.obj has none"));
  EXPECT_THAT(error_of(obj_frame(1, "vn 0 0 1\nf 1//1 2//1 3//1\n")), HasSubstr("f_2.obj has normals"));
  // NaN, infinite and degenerate frames.
  EXPECT_THAT(error_of("v nan 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n"),
              AllOf(HasSubstr("f_2.obj"), HasSubstr("vertex 0")));
  EXPECT_THAT(error_of("v 0 0 0\nv 0 1e300 0\nv 0 0 1\nf 1 2 3\n"), HasSubstr("vertex 1"));
  EXPECT_THAT(error_of("v 0 0 0\nv 0 1 0\nv 0 2 0\nf 1 2 3\n"),
              AllOf(HasSubstr("f_2.obj"), HasSubstr("area")));
  // A truncated and an empty file.
  EXPECT_THAT(error_of("v 1 0 0\nv 0 1"), AllOf(HasSubstr("f_2.obj:2:"), HasSubstr("the end of the line")));
  EXPECT_THAT(error_of(""), HasSubstr("f_2.obj: has no vertices"));
  // A frame that has gone, or is a folder.
  fs::remove(folder / "f_2.obj");
  EXPECT_THAT(message_of([&] { reader->read(2); }), HasSubstr("f_2.obj: cannot be read: No such file"));
  EXPECT_THAT(message_of([&] { reader->frame_bytes(2); }), HasSubstr("f_2.obj: cannot be read"));
  fs::create_directory(folder / "f_2.obj");
  EXPECT_THAT(message_of([&] { reader->read(2); }), HasSubstr("f_2.obj: is a folder"));
  // The others are as readable as before.
  EXPECT_EQ(reader->read(1).positions(0, 0), 2.0f);
}

TEST(FolderErrors, AnUnreadableFrameIsReported) {
  if (geteuid() == 0) GTEST_SKIP() << "everything is readable for this user";
  const TemporaryFolder folder;
  write_text_file(folder / "0.obj", obj_frame(1));
  fs::permissions(folder / "0.obj", fs::perms::none);
  EXPECT_THAT(open_error({.path = folder.path()}), HasSubstr("Permission denied"));
}

TEST(PointCache, Pc2AndMddDeliverTheFramesTheyHold) {
  const TemporaryFolder folder;
  write_text_file(folder / "faces.obj", "v 0 0 0 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n");
  const std::vector<float> values = triangle_frames(4);
  write_text_file(folder / "a.pc2", pc2_file(3, values));
  write_text_file(folder / "a.MDD", mdd_file(3, {0.0f, 0.04f, 0.08f, 0.12f}, values));
  for (const char* name : {"a.pc2", "a.MDD"}) {
    const auto reader =
        open_sequence({.path = folder / name, .topology = folder / "faces.obj", .scale = 2.0});
    ASSERT_EQ(reader->frame_count(), 4u) << name;
    EXPECT_EQ(reader->frame_bytes(3), 36u);
    EXPECT_THAT(reader->frame_name(3), AllOf(HasSubstr(name), HasSubstr("frame 3")));
    for (std::size_t i = 0; i < 4; ++i) {
      const Mesh mesh = reader->read(i);
      EXPECT_EQ(mesh.positions.row(0), Eigen::RowVector3f(2.0f * static_cast<float>(i), 0, 0)) << name;
      EXPECT_EQ(mesh.positions.row(2), Eigen::RowVector3f(0, 0, 2)) << name;
      EXPECT_EQ(mesh.colors[0], (Color{255, 0, 0}));
    }
    EXPECT_THROW(reader->read(4), InvalidArgument);
  }
  EXPECT_EQ(open_sequence({.path = folder / "a.pc2", .topology = folder / "faces.obj"})->frames_per_second(),
            std::nullopt);
  EXPECT_EQ(open_sequence({.path = folder / "a.MDD", .topology = folder / "faces.obj"})->frames_per_second(),
            25.0);
}

TEST(PointCacheErrors, EveryUnusableFileIsNamedWithItsReason) {
  const TemporaryFolder folder;
  const fs::path faces = folder / "faces.obj";
  write_text_file(faces, obj_frame(0));
  std::vector<float> values = triangle_frames(3);
  values[18] = NAN;  // in the third frame
  std::fill(values.begin() + 9, values.begin() + 18, 0.0f);
  for (const auto& [name, bytes] : {std::pair<std::string, std::string>{"a.pc2", pc2_file(3, values)},
                                    {"a.mdd", mdd_file(3, {0, 1, 2}, values)}}) {
    const fs::path path = folder / name;
    write_text_file(path, bytes);
    // No topology, a missing one, and one that is no mesh.
    EXPECT_THAT(open_error({.path = path}), HasSubstr("holds positions alone"));
    EXPECT_THAT(open_error({.path = path, .topology = folder / "no.ply"}),
                HasSubstr("no.ply: cannot be read"));
    EXPECT_THAT(open_error({.path = path, .topology = path}), HasSubstr("is not a mesh"));
    // Another vertex count.
    const fs::path other = folder / "other.obj";
    write_text_file(other, "v 0 0 0\n" + obj_frame(0));
    EXPECT_THAT(open_error({.path = path, .topology = other}),
                AllOf(HasSubstr("has 3 vertices"), HasSubstr("other.obj has 4")));
    // Frames without area or with NaN, named by their number.
    const auto reader = open_sequence({.path = path, .topology = faces});
    EXPECT_NO_THROW(reader->read(0));
    EXPECT_THAT(message_of([&] { reader->read(1); }),
                AllOf(HasSubstr(name + ":frame 1:"), HasSubstr("area")));
    EXPECT_THAT(message_of([&] { reader->read(2); }),
                AllOf(HasSubstr(name + ":frame 2:"), HasSubstr("vertex 0")));
    // Truncated: while open, and before.
    write_text_file(folder / "cut", bytes.substr(0, bytes.size() - 4));
    fs::resize_file(path, bytes.size() - 4);
    EXPECT_THAT(message_of([&] { reader->read(2); }), HasSubstr("is truncated"));
    EXPECT_THAT(open_error({.path = path, .topology = faces}),
                AllOf(HasSubstr("is truncated"), HasSubstr(fmt::format("expected {} bytes", bytes.size())),
                      HasSubstr(fmt::format("found {}", bytes.size() - 4))));
    // Foreign contents, an empty file, and a folder of that name.
    write_text_file(path, obj_frame(0));
    EXPECT_THAT(open_error({.path = path, .topology = faces}), Not(HasSubstr("no FileError")));
    write_text_file(path, "");
    EXPECT_THAT(open_error({.path = path, .topology = faces}), Not(HasSubstr("no FileError")));
    fs::remove(path);
    EXPECT_THAT(open_error({.path = path, .topology = faces}), HasSubstr("does not exist"));
    fs::create_directory(path);
    EXPECT_THAT(open_error({.path = path, .topology = faces}), HasSubstr("holds no frames"));
  }
}

TEST(SequenceErrors, OtherFilesAreNoSequence) {
  const TemporaryFolder folder;
  write_text_file(folder / "a.txt", "");
  EXPECT_THAT(open_error({.path = folder / "a.txt"}), HasSubstr("is not a sequence"));
  write_text_file(folder / "a.obj", obj_frame(0));
  EXPECT_THAT(open_error({.path = folder / "a.obj"}), HasSubstr("is a single mesh"));
  for (const double scale : {0.0, -1.0, static_cast<double>(NAN), HUGE_VAL}) {
    EXPECT_THROW(open_sequence({.path = folder.path(), .scale = scale}), InvalidArgument);
  }
  EXPECT_THAT(message_of([&] { read_mesh(folder / "a.txt"); }), HasSubstr("is not a mesh"));
  EXPECT_THAT(message_of([&] { read_mesh(folder / "b.obj"); }), HasSubstr("b.obj: cannot be read"));
  EXPECT_THAT(message_of([&] { read_mesh(folder.path()); }), HasSubstr("is not a mesh"));
}

// Writes positions of F frames of N vertices in one of the layouts.
void write_dfaust_sequence(Hdf5File& file, const std::string& id, const DfaustLayout& layout,
                           std::size_t frames, std::size_t vertices) {
  Hdf5Shape shape(3);
  shape[layout.frame] = frames;
  shape[layout.vertex] = vertices;
  shape[layout.coordinate] = 3;
  std::vector<double> values(frames * vertices * 3);
  const std::array<std::size_t, 3> strides = {shape[1] * shape[2], shape[2], 1};
  for (std::size_t f = 0; f < frames; ++f) {
    for (std::size_t v = 0; v < vertices; ++v) {
      for (std::size_t k = 0; k < 3; ++k) {
        const double spread = v % 3 == k ? 0.5 : 0.0;
        values[f * strides[layout.frame] + v * strides[layout.vertex] + k * strides[layout.coordinate]] =
            static_cast<double>(100 * f + 10 * v + k) + spread;
      }
    }
  }
  file.write<double>(id, shape, values);
}

void write_dfaust_faces(Hdf5File& file) {
  const std::vector<std::uint32_t> faces = {0, 1, 2, 1, 4, 3, 2, 3, 4};
  file.write<std::uint32_t>("faces", {3, 3}, faces);
}

TEST(Dfaust, EveryLayoutDeliversTheSameFrames) {
  const TemporaryFolder folder;
  for (const DfaustLayout& layout : {DfaustLayout{0, 1, 2}, DfaustLayout{2, 0, 1}, DfaustLayout{0, 2, 1}}) {
    const fs::path path = folder / "a.hdf5";
    {
      Hdf5File file = Hdf5File::create(path);
      write_dfaust_faces(file);
      write_dfaust_sequence(file, "50002_jump", layout, 7, 5);
      file.finish();
    }
    const auto reader = open_sequence({.path = path});  // the only sequence needs no name
    ASSERT_EQ(reader->frame_count(), 7u);
    EXPECT_EQ(reader->topology()->vertex_count, 5);
    EXPECT_EQ(reader->topology()->triangles.size(), 3u);
    EXPECT_THAT(reader->frame_name(6), AllOf(HasSubstr("50002_jump"), HasSubstr("frame 6")));
    for (const std::size_t f : {6u, 0u, 3u}) {
      const Mesh mesh = reader->read(f);
      EXPECT_EQ(mesh.positions.row(4), Eigen::RowVector3f(100.0f * static_cast<float>(f) + 40.0f,
                                                          100.0f * static_cast<float>(f) + 41.5f,
                                                          100.0f * static_cast<float>(f) + 42.0f));
    }
  }
}

TEST(Dfaust, ShapesAreReadByTheVerticesTheFacesUse) {
  using Layouts = std::vector<DfaustLayout>;
  EXPECT_EQ(dfaust_layouts({6890, 3, 250}, 6890), (Layouts{{2, 0, 1}}));
  EXPECT_EQ(dfaust_layouts({250, 6890, 3}, 6890), (Layouts{{0, 1, 2}}));
  EXPECT_EQ(dfaust_layouts({250, 3, 6890}, 6890), (Layouts{{0, 2, 1}}));
  // More frames than vertices, and frames of three.
  EXPECT_EQ(dfaust_layouts({100, 3, 250}, 100), (Layouts{{2, 0, 1}}));
  EXPECT_EQ(dfaust_layouts({3, 100, 3}, 100), (Layouts{{0, 1, 2}}));
  // Unused vertices at the end leave a doubt.
  EXPECT_EQ(dfaust_layouts({100, 3, 250}, 99).size(), 2u);
  EXPECT_TRUE(dfaust_layouts({250, 6890, 4}, 6890).empty());
  EXPECT_TRUE(dfaust_layouts({250, 100, 3}, 6890).empty());
}

TEST(Dfaust, DoubtsAreSettledByTheOtherSequencesOrReported) {
  const TemporaryFolder folder;
  {  // The faces use 5 of 6 vertices: (6, 3, 8) may have 6 or 8.
    Hdf5File file = Hdf5File::create(folder / "doubt.h5");
    write_dfaust_faces(file);
    write_dfaust_sequence(file, "a", {2, 0, 1}, 8, 6);
    file.finish();
  }
  EXPECT_THAT(open_error({.path = folder / "doubt.h5"}),
              AllOf(HasSubstr("ambiguous"), HasSubstr("(6, 3, 8)")));
  {
    Hdf5File file = Hdf5File::create(folder / "settled.h5");
    write_dfaust_faces(file);
    write_dfaust_sequence(file, "a", {2, 0, 1}, 8, 6);
    write_dfaust_sequence(file, "b", {2, 0, 1}, 9, 6);
    file.finish();
  }
  EXPECT_EQ(open_sequence({.path = folder / "settled.h5", .sequence_id = "a"})->frame_count(), 8u);
  // A topology file settles it as well.
  write_text_file(folder / "faces.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\n" + obj_frame(0));
  {
    Hdf5File file = Hdf5File::create(folder / "no_faces.h5");
    write_dfaust_sequence(file, "a", {2, 0, 1}, 8, 6);
    file.finish();
  }
  EXPECT_THAT(open_error({.path = folder / "no_faces.h5"}), HasSubstr("holds no faces"));
  EXPECT_EQ(open_sequence({.path = folder / "no_faces.h5", .topology = folder / "faces.obj"})->frame_count(),
            8u);
}

TEST(DfaustErrors, EveryUnusableFileIsNamedWithItsReason) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.h5";
  // No HDF5 file, an empty one, and one cut short.
  write_text_file(path, "solid cube");
  EXPECT_THAT(open_error({.path = path}), HasSubstr("a.h5"));
  write_text_file(path, "");
  EXPECT_THAT(open_error({.path = path}), HasSubstr("a.h5"));
  {
    Hdf5File file = Hdf5File::create(path);
    write_dfaust_faces(file);
    write_dfaust_sequence(file, "50002_jump", {0, 1, 2}, 300, 5);
    write_dfaust_sequence(file, "50002_run", {0, 1, 2}, 3, 5);
    file.write<float>("50002_small", {2, 4, 3}, std::vector<float>(24));
    file.write<float>("50002_still", {1, 5, 3}, std::vector<float>(15));
    file.finish();
  }
  // An unknown sequence, and none named: lists those there are.
  EXPECT_THAT(open_error({.path = path, .sequence_id = "50002_jmp"}),
              AllOf(HasSubstr("no sequence '50002_jmp'"), HasSubstr("50002_jump, 50002_run"),
                    HasSubstr("did you mean 50002_jump")));
  EXPECT_THAT(open_error({.path = path}),
              AllOf(HasSubstr("several sequences"), HasSubstr("50002_jump, 50002_run")));
  // Fewer vertices than the faces use.
  EXPECT_THAT(open_error({.path = path, .sequence_id = "50002_small"}), HasSubstr("at least 5 vertices"));
  // A frame without area.
  EXPECT_THAT(message_of([&] { open_sequence({.path = path, .sequence_id = "50002_still"})->read(0); }),
              AllOf(HasSubstr("frame 0"), HasSubstr("area")));
  fs::resize_file(path, fs::file_size(path) / 2);
  EXPECT_THAT(message_of([&] { open_sequence({.path = path, .sequence_id = "50002_jump"})->read(299); }),
              HasSubstr("a.h5"));
  // Faces that are none, and no sequence beside them.
  const auto error_with_faces = [&](const Hdf5Shape& shape, const std::vector<std::int32_t>& faces) {
    {
      Hdf5File file = Hdf5File::create(path);
      file.write<std::int32_t>("faces", shape, faces);
      if (faces.size() != 6) write_dfaust_sequence(file, "a", {0, 1, 2}, 2, 5);
      file.finish();
    }
    return open_error({.path = path});
  };
  EXPECT_THAT(error_with_faces({1, 2}, {0, 1}), HasSubstr("(faces, 3)"));
  EXPECT_THAT(error_with_faces({1, 3}, {0, 1, -2}), HasSubstr("vertex index -2"));
  EXPECT_THAT(error_with_faces({1, 3}, {0, 1, 9}), HasSubstr("at least 10 vertices"));
  EXPECT_THAT(error_with_faces({2, 3}, {0, 1, 2, 0, 2, 3}), HasSubstr("holds no sequence"));
}

// Reading from all threads at once gives what reading one after another gives.
void expect_same_from_threads(const SequenceReader& reader, std::size_t count) {
  std::vector<Positions> parallel(count);
  parallel_for(0, 4 * count, [&](std::size_t i) {
    Mesh mesh = reader.read(i % count);
    if (i < count) parallel[i] = std::move(mesh.positions);
  });
  for (std::size_t i = 0; i < count; ++i)
    EXPECT_EQ(parallel[i], reader.read(i).positions) << reader.frame_name(i);
}

TEST(SequenceReader, ThreadsMayReadSideBySide) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "objs");
  for (int i = 0; i < 20; ++i) write_text_file(folder / "objs" / fmt::format("{}.obj", i), obj_frame(i + 1));
  expect_same_from_threads(*open_sequence({.path = folder / "objs"}), 20);
  write_text_file(folder / "a.pc2", pc2_file(3, triangle_frames(50)));
  expect_same_from_threads(*open_sequence({.path = folder / "a.pc2", .topology = folder / "objs" / "1.obj"}),
                           50);
  {
    Hdf5File file = Hdf5File::create(folder / "a.h5");
    write_dfaust_faces(file);
    write_dfaust_sequence(file, "a", {2, 0, 1}, 50, 5);
    file.finish();
  }
  expect_same_from_threads(*open_sequence({.path = folder / "a.h5"}), 50);
}

TEST(RealCaptures, EveryFrameOfTheArticulatedMeshesIsRead) {
  REPRISE_REQUIRE_DATA();
  std::vector<TopologyPtr> topologies;
  for (const auto& [name, frames] : {std::pair{"crane", 175u}, {"jumping", 150u}}) {
    const auto reader = open_sequence({.path = test::data_folder() / "ama" / name});
    ASSERT_EQ(reader->frame_count(), frames);
    EXPECT_EQ(reader->topology()->vertex_count, 10002);
    EXPECT_EQ(reader->topology()->triangles.size(), 20000u);
    std::vector<float> heights(frames);
    parallel_for(0, frames, [&](std::size_t i) {
      const Positions positions = reader->read(i).positions;
      heights[i] = positions.col(1).maxCoeff() - positions.col(1).minCoeff();
    });
    for (const float height : heights) {
      EXPECT_GT(height, 1.0f);
      EXPECT_LT(height, 2.5f);
    }
    topologies.push_back(reader->topology());
  }
  EXPECT_EQ(first_difference(*topologies[0], *topologies[1], "crane", "jumping"), "");
}

TEST(RealCaptures, PointCachesOfTheFashionClipsAreReadAndEqualTheirPlyFrames) {
  REPRISE_REQUIRE_DATA();
  const fs::path folder = test::data_folder() / "fashion";
  std::size_t frames = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (file_kind(entry.path()) != FileKind::pc2) continue;
    const auto reader = open_sequence({.path = entry.path(), .topology = folder / "topology.ply"});
    for (std::size_t i = 0; i < reader->frame_count(); ++i) EXPECT_EQ(reader->read(i).colors.size(), 3302u);
    frames += reader->frame_count();
  }
  EXPECT_EQ(frames, 659u);
  const auto cache = open_sequence({.path = folder / "walk.pc2", .topology = folder / "topology.ply"});
  const auto ply = open_sequence({.path = folder / "walk_ply"});
  ASSERT_EQ(cache->frame_count(), ply->frame_count());
  EXPECT_EQ(first_difference(*cache->topology(), *ply->topology(), "pc2", "ply"), "");
  for (std::size_t i = 0; i < ply->frame_count(); ++i) {
    const Mesh a = cache->read(i), b = ply->read(i);
    EXPECT_LE((a.positions - b.positions).cwiseAbs().maxCoeff(), 1e-6f) << i;
    EXPECT_EQ(a.colors, b.colors) << i;
  }
}

TEST(RealCaptures, TheGallopingHorseIsRead) {
  REPRISE_REQUIRE_DATA();
  const auto reader = open_sequence({.path = test::data_folder() / "horse_gallop"});
  ASSERT_EQ(reader->frame_count(), 48u);
  EXPECT_EQ(reader->topology()->vertex_count, 8431);
  for (std::size_t i = 0; i < reader->frame_count(); ++i) EXPECT_EQ(reader->read(i).positions.rows(), 8431);
}

}  // namespace
}  // namespace reprise
