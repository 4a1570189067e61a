// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Texture, markup and truth in the database file.

#include <filesystem>
#include <fstream>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/database_file.h"
#include "reprise/io/hdf5.h"
#include "reprise/io/io_test_support.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;
namespace fs = std::filesystem;

// The database of tests/fixtures/database_v2.reprise: everything a version 2 file can have, on six vertices.
PerformanceDatabase marked_database() {
  const test::Shape shape = test::sphere(0);
  Topology topology = *shape.topology;
  topology.uvs = {{0.0F, 0.0F}, {1.0F, 0.0F}, {0.5F, 1.0F}};
  topology.triangle_uvs.assign(topology.triangles.size(), {0, 1, 2});
  Image texture{.width = 3, .height = 2};
  for (std::uint8_t i = 0; i < 18; ++i) texture.rgb.push_back(static_cast<std::uint8_t>(13 * i));
  topology.texture = std::make_shared<const Image>(texture);
  const auto shared = std::make_shared<const Topology>(std::move(topology));
  PerformanceDatabase database;
  for (const char* name : {"rise", "stay"}) {
    MeshSequence clip(name, shared, 3, 25.0);
    for (std::size_t f = 0; f < 3; ++f) {
      clip.frame(f) = shape.positions;
      if (clip.name() == "rise") clip.frame(f).col(1).array() += 0.125F * static_cast<float>(f);
    }
    database.add(std::move(clip));
  }
  Markup markup;
  markup.skeleton.joints = {{.name = "pelvis", .parent = -1, .rest_position = {0, 1, 0.1}},
                            {.name = "left_thigh", .parent = 0, .rest_position = {0.1, 0.9, 0}},
                            {.name = "left_shin", .parent = 1, .rest_position = {0.1, 0.5, 1.0 / 3.0}}};
  markup.reference = shape.positions;
  markup.joint_of_vertex = {0, 1, 2, -1, 0, 2};
  markup.parts = {{.name = "torso", .parent = -1, .vertices = {0, 3, 4, 5}},
                  {.name = "left_leg", .parent = 0, .vertices = {1, 2, 5}}};
  markup.layers = {"skin", "skirt é"};
  markup.layer_of_vertex = {0, 0, 0, 1, 0, 1};
  database.set_markup(markup);
  ClipTruth truth;
  for (std::size_t f = 0; f < 3; ++f) {
    SkeletonPose pose = rest_pose(markup.skeleton);
    for (std::size_t j = 0; j < 3; ++j) {
      pose.position[j].y() += 0.125 * static_cast<double>(f);
      pose.rotation[j] = Eigen::AngleAxisd(0.1 * static_cast<double>(f * j), Eigen::Vector3d::UnitX());
    }
    truth.poses.push_back(pose);
    truth.contacts.push_back({f == 0, f < 2});
  }
  database.set_truth(0, truth);
  return database;
}

void expect_equal_performers(const PerformanceDatabase& a, const PerformanceDatabase& b) {
  ASSERT_EQ(a.clip_names(), b.clip_names());
  for (std::size_t c = 0; c < a.clips().size(); ++c) test::expect_equal(a.clip(c), b.clip(c));
  ASSERT_TRUE(a.topology()->texture && b.topology()->texture);
  EXPECT_EQ(*a.topology()->texture, *b.topology()->texture);

  ASSERT_TRUE(a.markup() && b.markup());
  const Markup& m = *a.markup();
  const Markup& n = *b.markup();
  ASSERT_EQ(m.skeleton.size(), n.skeleton.size());
  for (std::size_t j = 0; j < m.skeleton.joints.size(); ++j) {
    EXPECT_EQ(m.skeleton.joints[j].name, n.skeleton.joints[j].name);
    EXPECT_EQ(m.skeleton.joints[j].parent, n.skeleton.joints[j].parent);
    EXPECT_EQ(m.skeleton.joints[j].rest_position, n.skeleton.joints[j].rest_position);
  }
  EXPECT_EQ(m.reference, n.reference);
  EXPECT_EQ(m.joint_of_vertex, n.joint_of_vertex);
  ASSERT_EQ(m.parts.size(), n.parts.size());
  for (std::size_t p = 0; p < m.parts.size(); ++p) {
    EXPECT_EQ(m.parts[p].name, n.parts[p].name);
    EXPECT_EQ(m.parts[p].parent, n.parts[p].parent);
    EXPECT_EQ(m.parts[p].vertices, n.parts[p].vertices);
  }
  EXPECT_EQ(m.layers, n.layers);
  EXPECT_EQ(m.layer_of_vertex, n.layer_of_vertex);

  for (std::size_t c = 0; c < a.clips().size(); ++c) {
    const ClipTruth* s = a.truth(c);
    const ClipTruth* t = b.truth(c);
    ASSERT_EQ(s == nullptr, t == nullptr);
    if (s == nullptr) continue;
    EXPECT_EQ(s->contacts, t->contacts);
    ASSERT_EQ(s->poses.size(), t->poses.size());
    for (std::size_t f = 0; f < s->poses.size(); ++f) {
      EXPECT_EQ(s->poses[f].position, t->poses[f].position);
      for (std::size_t j = 0; j < s->poses[f].rotation.size(); ++j) {
        EXPECT_EQ(s->poses[f].rotation[j].coeffs(), t->poses[f].rotation[j].coeffs());
      }
    }
  }
}

TEST(DatabaseFixture, Version2StillLoads) {
  const fs::path path = fs::path(REPRISE_SOURCE_DIR) / "tests/fixtures/database_v2.reprise";
  expect_equal_performers(load_database(path), marked_database());
  EXPECT_EQ(DatabaseReader(path).format_version(), 2);
}

TEST(DatabaseMarkup, TextureMarkupAndTruthComeBackAsTheyWere) {
  const test::TemporaryFolder folder;
  save_database(marked_database(), folder / "a.reprise");
  expect_equal_performers(load_database(folder / "a.reprise"), marked_database());
  const DatabaseReader reader(folder / "a.reprise");
  EXPECT_TRUE(reader.clips()[0].has_truth && !reader.clips()[1].has_truth);
  EXPECT_FALSE(reader.read_truth(1));
  EXPECT_THROW((void)reader.read_truth(2), InvalidArgument);
}

TEST(DatabaseMarkup, PartsAndLayersMayBeMissing) {
  const test::TemporaryFolder folder;
  PerformanceDatabase database = marked_database();
  Markup bare = *database.markup();
  bare.parts.clear();
  bare.layers.clear();
  bare.layer_of_vertex.clear();
  database.set_markup(bare);
  save_database(database, folder / "a.reprise");
  expect_equal_performers(load_database(folder / "a.reprise"), database);
}

TEST(DatabaseMarkup, TheSameContentGivesTheSameBytes) {
  const test::TemporaryFolder folder;
  save_database(marked_database(), folder / "a.reprise");
  save_database(load_database(folder / "a.reprise"), folder / "b.reprise");
  EXPECT_EQ(read_text_file(folder / "a.reprise"), read_text_file(folder / "b.reprise"));
}

// A database on a single triangle whose markup and truth are written by `fill`.
void write_by_hand(const fs::path& path,
                   const std::function<void(Hdf5Group& root, Hdf5Group& topology, Hdf5Group& clip)>& fill) {
  Hdf5File file = Hdf5File::create(path, 512);
  file.write_text("format", "Reprise performance database");
  file.write_integer("clip_count", 1);
  {
    Hdf5Group topology = file.create_group("topology");
    topology.write_integer("vertex_count", 3);
    topology.write<std::int32_t>("triangles", {1, 3}, std::vector<std::int32_t>{0, 1, 2});
    topology.write<float>("uvs", {3, 2}, std::vector<float>(6));
    topology.write<std::int32_t>("triangle_uvs", {1, 3}, std::vector<std::int32_t>{0, 1, 2});
    Hdf5Group clip = file.create_group("clips").create_group("walk");
    clip.write_integer("index", 0);
    clip.write_integer("frame_count", 1);
    clip.write_number("frames_per_second", 25.0);
    clip.write<float>("positions", {1, 3, 3}, std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1});
    fill(file, topology, clip);
  }
  file.finish();
  std::fstream stream(path, std::ios::binary | std::ios::in | std::ios::out);
  stream << "REPRISE DATABASE\nversion 2\nbytes " << fs::file_size(path) << '\n';
}

struct HandMarkup {
  std::vector<std::string> names = {"pelvis", "thigh"};
  std::vector<std::int32_t> parents = {-1, 0};
  std::vector<double> positions = std::vector<double>(6);
  std::vector<float> reference = std::vector<float>(9);
  std::vector<std::int32_t> joint_of_vertex = {0, 1, -1};
  std::vector<std::int32_t> part_sizes = {2, 1};
  std::vector<std::int32_t> part_vertices = {0, 2, 1};
  std::vector<std::uint8_t> layer_of_vertex = {0, 0, 0};

  void write(Hdf5Group& root) const {
    Hdf5Group group = root.create_group("markup");
    group.write_text_dataset("joint_names", std::span<const std::string>(names));
    group.write<std::int32_t>("joint_parents", {parents.size()}, parents);
    group.write<double>("joint_positions", {positions.size() / 3, 3}, positions);
    group.write<float>("reference", {reference.size() / 3, 3}, reference);
    group.write<std::int32_t>("joint_of_vertex", {joint_of_vertex.size()}, joint_of_vertex);
    group.write_text_dataset("part_names", std::vector<std::string>{"torso", "leg"});
    group.write<std::int32_t>("part_parents", {2}, std::vector<std::int32_t>{-1, 0});
    group.write<std::int32_t>("part_sizes", {part_sizes.size()}, part_sizes);
    group.write<std::int32_t>("part_vertices", {part_vertices.size()}, part_vertices);
    group.write_text_dataset("layer_names", std::vector<std::string>{"skin"});
    group.write<std::uint8_t>("layer_of_vertex", {layer_of_vertex.size()}, layer_of_vertex);
  }
};

void write_truth_by_hand(Hdf5Group& clip, std::size_t joints, double w = 1.0, std::size_t frames = 1) {
  Hdf5Group group = clip.create_group("truth");
  std::vector<double> rotations(frames * joints * 4);
  for (std::size_t i = 0; i < frames * joints; ++i) rotations[4 * i] = w;
  group.write<double>("positions", {frames, joints, 3}, std::vector<double>(frames * joints * 3));
  group.write<double>("rotations", {frames, joints, 4}, rotations);
  group.write<std::uint8_t>("contacts", {frames, 2}, std::vector<std::uint8_t>(frames * 2));
}

TEST(DatabaseMarkup, DamagedOrMismatchingContentsAreNamed) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "a.reprise";
  const auto load = [&] { (void)load_database(path); };
  const auto with_markup = [&](const std::function<void(HandMarkup&)>& spoil) {
    HandMarkup markup;
    spoil(markup);
    write_by_hand(path, [&](Hdf5Group& root, Hdf5Group&, Hdf5Group& clip) {
      markup.write(root);
      write_truth_by_hand(clip, 2);
    });
  };
  const auto names = [&](const std::string& object, const std::string& what) {
    return ThrowsMessage<FileError>(AllOf(HasSubstr("a.reprise"), HasSubstr(object), HasSubstr(what)));
  };
  with_markup([](HandMarkup&) {});
  EXPECT_NO_THROW(load());
  // Counts that do not fit together.
  with_markup([](HandMarkup& m) { m.parents.pop_back(); });
  EXPECT_THAT(load, names("/markup/joint_parents", "(2)"));
  with_markup([](HandMarkup& m) { m.positions.resize(3); });
  EXPECT_THAT(load, names("/markup/joint_positions", "(2, 3)"));
  with_markup([](HandMarkup& m) { m.reference.resize(6); });
  EXPECT_THAT(load, names("/markup/reference", "(3, 3)"));
  with_markup([](HandMarkup& m) { m.joint_of_vertex.push_back(0); });
  EXPECT_THAT(load, names("/markup/joint_of_vertex", "(3)"));
  with_markup([](HandMarkup& m) { m.part_sizes = {2, 2}; });
  EXPECT_THAT(load, names("/markup/part_vertices", "(4)"));
  with_markup([](HandMarkup& m) { m.part_sizes = {4, -1}; });
  EXPECT_THAT(load, names("/markup", "a part has -1 vertices"));
  with_markup([](HandMarkup& m) { m.layer_of_vertex.pop_back(); });
  EXPECT_THAT(load, names("/markup/layer_of_vertex", "(3)"));
  // Contents that mean nothing.
  with_markup([](HandMarkup& m) { m.parents[1] = 5; });
  EXPECT_THAT(load, names("/markup", "thigh"));
  with_markup([](HandMarkup& m) { m.joint_of_vertex[1] = 2; });
  EXPECT_THAT(load, names("/markup", "vertex 1 is labelled with joint 2"));
  with_markup([](HandMarkup& m) { m.part_vertices[1] = 3; });
  EXPECT_THAT(load, names("/markup", "holds vertex 3"));
  with_markup([](HandMarkup& m) { m.layer_of_vertex[1] = 1; });
  EXPECT_THAT(load, names("/markup", "vertex 1 has the layer 1"));

  const auto with_truth = [&](const std::function<void(Hdf5Group&)>& fill) {
    write_by_hand(path, [&](Hdf5Group& root, Hdf5Group&, Hdf5Group& clip) {
      HandMarkup().write(root);
      fill(clip);
    });
  };
  with_truth([](Hdf5Group& clip) { write_truth_by_hand(clip, 3); });
  EXPECT_THAT(load, names("/clips/walk/truth/positions", "(1, 2, 3)"));
  with_truth([](Hdf5Group& clip) { write_truth_by_hand(clip, 2, 1.0, 2); });
  EXPECT_THAT(load, names("/clips/walk/truth/positions", "(1, 2, 3)"));
  with_truth([](Hdf5Group& clip) { write_truth_by_hand(clip, 2, 0.5); });
  EXPECT_THAT(load, names("/clips/walk/truth", "unit rotation for joint 'pelvis'"));
  // A truth without a skeleton.
  write_by_hand(path, [](Hdf5Group&, Hdf5Group&, Hdf5Group& clip) { write_truth_by_hand(clip, 2); });
  EXPECT_THAT(load, names("/clips/walk", "no skeleton"));
  // A texture that is no picture.
  write_by_hand(path, [](Hdf5Group&, Hdf5Group& topology, Hdf5Group&) {
    topology.write<std::uint8_t>("texture", {4}, std::vector<std::uint8_t>{1, 2, 3, 4});
  });
  EXPECT_THAT(load, names("/topology/texture", "PNG"));
}

// A flipped bit in numbers may go unnoticed; it must never be more than that.
TEST(DatabaseMarkup, DamageIsAnErrorOrAWholeDatabaseNeverACrash) {
  const test::TemporaryFolder folder;
  save_database(marked_database(), folder / "a.reprise");
  const std::string bytes = read_text_file(folder / "a.reprise");
  int refused = 0;
  int tried = 0;
  for (std::size_t at = 5; at < bytes.size(); at += 61) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 8)));
    std::ofstream(folder / "b.reprise", std::ios::binary) << damaged;
    ++tried;
    try {
      EXPECT_EQ(load_database(folder / "b.reprise").frame_count(), 6U) << at;
    } catch (const FileError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, tried / 4);
}

TEST(DatabaseWriter, RefusesMarkupAndTruthThatDoNotFit) {
  const test::TemporaryFolder folder;
  const PerformanceDatabase database = marked_database();
  const Markup& markup = *database.markup();
  const ClipTruth& truth = *database.truth(0);
  DatabaseWriter writer(folder / "a.reprise", database.topology());
  // Before a clip; before a markup.
  EXPECT_THROW(writer.set_truth(truth), InvalidArgument);
  writer.write_clip(database.clip(0));
  EXPECT_THAT([&] { writer.set_truth(truth); }, ThrowsMessage<InvalidArgument>(HasSubstr("needs a markup")));
  // A markup of another surface; a second one.
  Markup other = markup;
  other.joint_of_vertex.pop_back();
  EXPECT_THROW(writer.set_markup(other), InvalidArgument);
  writer.set_markup(markup);
  EXPECT_THAT([&] { writer.set_markup(markup); }, ThrowsMessage<InvalidArgument>(HasSubstr("once")));
  // A truth of other frames; a second one; frames after it.
  ClipTruth shorter = truth;
  shorter.poses.pop_back();
  EXPECT_THAT([&] { writer.set_truth(shorter); }, ThrowsMessage<InvalidArgument>(HasSubstr("'rise'")));
  writer.set_truth(truth);
  EXPECT_THAT([&] { writer.set_truth(truth); }, ThrowsMessage<InvalidArgument>(HasSubstr("already")));
  writer.append(database.clip(0).mesh(0));
  EXPECT_THAT([&] { writer.commit(); },
              ThrowsMessage<InvalidArgument>(HasSubstr("a truth of 3 frames for 4 frames")));
  EXPECT_FALSE(fs::exists(folder / "a.reprise"));
}

}  // namespace
}  // namespace reprise
