// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/database/performance_database.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/database/learnt_model_test_support.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

Topology two_triangles() {
  return {.vertex_count = 4, .triangles = {{0, 1, 2}, {0, 2, 3}}};
}

MeshSequence clip(const std::string& name, std::size_t frame_count = 3, double rate = 25.0,
                  const Topology& topology = two_triangles()) {
  return {name, std::make_shared<const Topology>(topology), frame_count, rate};
}

PerformanceDatabase crane_and_jumping() {
  PerformanceDatabase database;
  database.add(clip("crane", 3));
  database.add(clip("jumping", 5));
  return database;
}

TEST(PerformanceDatabase, LaysClipsOneAfterTheOther) {
  const PerformanceDatabase database = crane_and_jumping();
  EXPECT_FALSE(database.empty());
  EXPECT_THAT(database.clip_names(), ElementsAre("crane", "jumping"));
  EXPECT_EQ(database.clip_idx("jumping"), 1U);
  EXPECT_EQ(database.clip(1).name(), "jumping");
  EXPECT_EQ(database.first_frame(0), 0U);
  EXPECT_EQ(database.first_frame(1), 3U);
  EXPECT_EQ(database.frame_count(), 8U);
  EXPECT_TRUE(PerformanceDatabase().empty());
}

TEST(PerformanceDatabase, EqualTopologiesBecomeOneSharedObject) {
  const PerformanceDatabase database = crane_and_jumping();
  EXPECT_EQ(database.clip(0).topology(), database.topology());
  EXPECT_EQ(database.clip(1).topology(), database.topology());
}

TEST(PerformanceDatabase, TextureCoordinatesOfAnyClipServeAll) {
  Topology textured = two_triangles();
  textured.uvs = {{0, 0}, {1, 0}, {1, 1}};
  textured.triangle_uvs = {{0, 1, 2}, {0, 1, 2}};
  for (const bool textured_first : {true, false}) {
    PerformanceDatabase database;
    database.add(clip("a", 3, 25.0, textured_first ? textured : two_triangles()));
    database.add(clip("b", 3, 25.0, textured_first ? two_triangles() : textured));
    EXPECT_TRUE(database.topology()->has_uvs());
    for (const MeshSequence& each : database.clips()) EXPECT_EQ(each.topology(), database.topology());
  }
}

TEST(PerformanceDatabase, ATextureGoesWithItsCoordinates) {
  Topology with_uvs = two_triangles();
  with_uvs.uvs = {{0, 0}, {1, 0}, {1, 1}};
  with_uvs.triangle_uvs = {{0, 1, 2}, {0, 1, 2}};
  Topology textured = with_uvs;
  textured.texture = std::make_shared<const Image>(Image{.width = 1, .height = 1, .rgb = {1, 2, 3}});
  Topology elsewhere = textured;
  elsewhere.uvs[0] = {0.5, 0.5};
  const auto texture_of = [](const Topology& first, const Topology& second) {
    PerformanceDatabase database;
    database.add(clip("a", 3, 25.0, first));
    database.add(clip("b", 3, 25.0, second));
    for (const MeshSequence& each : database.clips()) EXPECT_EQ(each.topology(), database.topology());
    return database.topology()->texture;
  };
  EXPECT_EQ(texture_of(textured, two_triangles()), textured.texture);
  EXPECT_EQ(texture_of(two_triangles(), textured), textured.texture);
  EXPECT_EQ(texture_of(with_uvs, textured), textured.texture);
  EXPECT_EQ(texture_of(textured, with_uvs), textured.texture);
  EXPECT_EQ(texture_of(with_uvs, elsewhere), nullptr);  // would be drawn with the wrong coordinates
}

// Two bones over the four vertices of `two_triangles`.
Markup two_bones() {
  Markup markup;
  markup.skeleton.joints = {{.name = "hip", .parent = -1, .rest_position = {0, 1, 0}},
                            {.name = "knee", .parent = 0, .rest_position = {0, 0.5, 0}}};
  markup.reference = Positions::Zero(4, 3);
  markup.joint_of_vertex = {0, 0, 1, -1};
  return markup;
}

ClipTruth standing(std::size_t frame_count) {
  return {.poses = std::vector(frame_count, rest_pose(two_bones().skeleton)),
          .contacts = std::vector(frame_count, FootContacts{true, false})};
}

TEST(PerformanceDatabase, KeepsMarkupAndTruth) {
  PerformanceDatabase database = crane_and_jumping();
  EXPECT_FALSE(database.markup());
  EXPECT_EQ(database.truth(1), nullptr);
  const std::string hash = database.content_hash();
  database.set_markup(two_bones());
  database.set_truth(1, standing(5));
  ASSERT_TRUE(database.markup());
  EXPECT_EQ(database.markup()->skeleton.joints[1].name, "knee");
  EXPECT_EQ(database.truth(0), nullptr);
  ASSERT_NE(database.truth(1), nullptr);
  EXPECT_EQ(database.truth(1)->poses.size(), 5U);
  // A clip more, and other labels on the same skeleton, change nothing of what is known.
  database.add(clip("late", 2));
  EXPECT_EQ(database.truth(2), nullptr);
  Markup relabelled = two_bones();
  relabelled.joint_of_vertex = {0, 1, 1, 1};
  database.set_markup(relabelled);
  EXPECT_NE(database.truth(1), nullptr);
  // Nobody can read true poses without the skeleton they are poses of.
  Markup other = two_bones();
  other.skeleton.joints[1].rest_position.y() = 0.4;
  database.set_markup(other);
  EXPECT_EQ(database.truth(1), nullptr);
  database.set_truth(1, standing(5));
  database.set_markup(std::nullopt);
  EXPECT_FALSE(database.markup());
  EXPECT_EQ(database.truth(1), nullptr);
  EXPECT_EQ(crane_and_jumping().content_hash(), hash);
}

TEST(PerformanceDatabase, KeepsModelsWhateverBecomesOfTheMarkup) {
  const LearntModels models =
      test::learnt_models(Positions::Zero(4, 3), {{.name = "torso", .parent = -1, .vertices = {0, 1, 2, 3}},
                                                  {.name = "leg", .parent = 0, .vertices = {2, 3}}});
  PerformanceDatabase database;
  EXPECT_TRUE(database.models().empty());
  EXPECT_NO_THROW(database.set_models({}));
  EXPECT_THAT([&] { database.set_models(models); },
              ThrowsMessage<InvalidArgument>(HasSubstr("needs a database with a clip")));
  database = crane_and_jumping();
  const std::string hash = database.content_hash();
  database.set_markup(two_bones());
  database.set_models(models);
  EXPECT_EQ(database.content_hash(), hash);
  database.set_markup(std::nullopt);
  database.add(clip("late", 2));
  ASSERT_EQ(database.models().part.parts.size(), 2U);
  EXPECT_EQ(database.models().part.parts[0].basis, models.part.parts[0].basis);
  EXPECT_EQ(database.models().whole.parts.size(), 1U);
  // Models of another surface: those it has stay.
  LearntModels other = models;
  other.whole.reference = Positions::Zero(5, 3);
  EXPECT_THAT([&] { database.set_models(other); },
              ThrowsMessage<InvalidArgument>(HasSubstr("5 vertices; expected 4")));
  EXPECT_FALSE(database.models().empty());
  database.set_models({});
  EXPECT_TRUE(database.models().empty());
}

TEST(PerformanceDatabase, HashesAppearanceApartFromShape) {
  const auto textured = [](std::uint8_t red, float u) {
    Topology topology = two_triangles();
    topology.uvs = {{0, 0}, {u, 0}, {1, 1}};
    topology.triangle_uvs = {{0, 1, 2}, {0, 1, 2}};
    topology.texture = std::make_shared<const Image>(Image{.width = 1, .height = 1, .rgb = {red, 2, 3}});
    return clip("a", 2, 25.0, topology);
  };
  const auto colored = [](std::vector<Color> colors) {
    MeshSequence sequence = clip("a", 2);
    sequence.set_colors(std::move(colors));
    return sequence;
  };
  std::vector<Color> per_frame(8, Color{9, 9, 9});
  per_frame[7] = {9, 9, 8};
  std::set<std::string> looks, shapes;
  for (const MeshSequence& sequence : {clip("a", 2), textured(1, 1.0F), textured(9, 1.0F), textured(1, 0.5F),
                                       colored(std::vector<Color>(4, Color{9, 9, 9})),
                                       colored(std::vector<Color>(4, Color{9, 9, 8})), colored(per_frame)}) {
    PerformanceDatabase database;
    database.add(sequence);
    looks.insert(database.appearance_hash());
    shapes.insert(database.content_hash());
  }
  EXPECT_EQ(looks.size(), 7U);
  EXPECT_EQ(shapes.size(), 1U);
  // A clip that moves otherwise looks the same.
  MeshSequence moved = clip("a", 2);
  moved.frame(1).array() += 1.0F;
  PerformanceDatabase database;
  database.add(moved);
  EXPECT_EQ(looks.count(database.appearance_hash()), 1U);
}

TEST(PerformanceDatabase, RefusesMarkupAndTruthThatDoNotFit) {
  PerformanceDatabase database;
  EXPECT_THAT([&] { database.set_markup(two_bones()); },
              ThrowsMessage<InvalidArgument>(HasSubstr("needs a database with a clip")));
  EXPECT_NO_THROW(database.set_markup(std::nullopt));
  database = crane_and_jumping();
  // A truth without a skeleton.
  EXPECT_THAT([&] { database.set_truth(0, standing(3)); },
              ThrowsMessage<InvalidArgument>(HasSubstr("clip 'crane': a truth needs a markup")));
  // A markup of another surface.
  Markup larger = two_bones();
  larger.joint_of_vertex.push_back(0);
  EXPECT_THAT([&] { database.set_markup(larger); },
              ThrowsMessage<InvalidArgument>(HasSubstr("labels 5 vertices with joints; the surface has 4")));
  EXPECT_FALSE(database.markup());
  database.set_markup(two_bones());
  // Another number of frames.
  EXPECT_THAT([&] { database.set_truth(0, standing(4)); },
              ThrowsMessage<InvalidArgument>(HasSubstr("clip 'crane': the truth has 4 poses")));
  // A clip that is not there.
  EXPECT_THROW(database.set_truth(2, standing(3)), InvalidArgument);
  EXPECT_THROW((void)database.truth(2), InvalidArgument);
}

TEST(PerformanceDatabase, RefusesAClipThatDoesNotFitAndStaysAsItWas) {
  PerformanceDatabase database = crane_and_jumping();
  const std::string hash = database.content_hash();
  // A name that is empty, means a folder, or would not survive "CLIP:FRAME".
  for (const std::string name : {"", ".", "..", "a:b", "a/b"}) {
    EXPECT_THAT([&] { database.add(clip(name)); },
                ThrowsMessage<InvalidArgument>(HasSubstr("cannot name a clip")));
  }
  // A name that is taken.
  EXPECT_THAT([&] { database.add(clip("crane")); },
              ThrowsMessage<InvalidArgument>(HasSubstr("a clip named 'crane' already")));
  // No frames.
  EXPECT_THAT([&] { database.add(clip("empty", 0)); },
              ThrowsMessage<InvalidArgument>(HasSubstr("'empty' has no frames")));
  // Another number of vertices.
  Topology other = two_triangles();
  other.vertex_count = 5;
  EXPECT_THAT([&] { database.add(clip("horse", 3, 25.0, other)); },
              ThrowsMessage<InvalidArgument>(HasSubstr("clip 'crane' has 4 vertices, clip 'horse' has 5")));
  // Other triangles: the first that differs is named.
  other = two_triangles();
  other.triangles[1] = {0, 3, 2};
  EXPECT_THAT([&] { database.add(clip("horse", 3, 25.0, other)); },
              ThrowsMessage<InvalidArgument>(
                  HasSubstr("triangle 1 is (0, 2, 3) in clip 'crane' and (0, 3, 2) in clip 'horse'")));
  EXPECT_THAT(database.clip_names(), ElementsAre("crane", "jumping"));
  EXPECT_EQ(database.frame_count(), 8U);
  EXPECT_EQ(database.content_hash(), hash);
}

TEST(PerformanceDatabase, RefusesAnIndexBeyondTheLastClip) {
  const PerformanceDatabase database = crane_and_jumping();
  EXPECT_THAT([&] { database.clip(2); },
              ThrowsMessage<InvalidArgument>("there is no clip 2: the database holds 2"));
  EXPECT_THROW(database.first_frame(2), InvalidArgument);
  EXPECT_THROW(database.to_string({.clip_idx = 2}), InvalidArgument);
}

TEST(PerformanceDatabase, UnknownClipOffersTheNearestName) {
  const PerformanceDatabase database = crane_and_jumping();
  EXPECT_THAT([&] { database.clip_idx("carne"); },
              ThrowsMessage<InvalidArgument>(HasSubstr("did you mean 'crane'?")));
  EXPECT_THAT([&] { database.clip_idx("somersault"); },
              ThrowsMessage<InvalidArgument>(
                  AllOf(HasSubstr("the clips are crane, jumping"), Not(HasSubstr("did you mean")))));
  EXPECT_THAT([] { PerformanceDatabase().clip_idx("crane"); },
              ThrowsMessage<InvalidArgument>(HasSubstr("the database holds none")));
}

TEST(ParseFrame, IsTheInverseOfToString) {
  const PerformanceDatabase database = crane_and_jumping();
  std::set<std::string> texts;
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    for (std::size_t f = 0; f < database.clip(c).frame_count(); ++f) {
      const FrameId frame{.clip_idx = c, .frame_idx = f};
      texts.insert(database.to_string(frame));
      EXPECT_EQ(database.parse_frame(database.to_string(frame)), frame);
    }
  }
  EXPECT_EQ(texts.size(), database.frame_count());
  EXPECT_EQ(database.to_string({.clip_idx = 1, .frame_idx = 4}), "jumping:4");
}

TEST(ParseFrame, SaysWhatIsWrong) {
  const PerformanceDatabase database = crane_and_jumping();
  const auto parse = [&](const std::string& text) {
    return [&database, text] { database.parse_frame(text); };
  };
  // No colon.
  EXPECT_THAT(parse("crane"),
              ThrowsMessage<InvalidArgument>(HasSubstr("expected CLIP:FRAME, such as crane:0")));
  // An unknown clip.
  EXPECT_THAT(parse("crans:1"), ThrowsMessage<InvalidArgument>(HasSubstr("did you mean 'crane'?")));
  // No number, a negative one, one with something behind it, one too large for any computer.
  for (const std::string text : {"crane:", "crane:one", "crane:-1", "crane:+1", "crane:1.5", "crane:1 ",
                                 "crane:99999999999999999999999"}) {
    EXPECT_THAT(parse(text), ThrowsMessage<InvalidArgument>(HasSubstr("'" + text + "' is not a frame")));
  }
  // Beyond the last frame.
  EXPECT_THAT(parse("crane:3"),
              ThrowsMessage<InvalidArgument>("clip 'crane' has frames 0 to 2, asked for 3"));
}

TEST(FramesPerSecond, IsTheRateAllClipsShare) {
  PerformanceDatabase database = crane_and_jumping();
  EXPECT_EQ(database.frames_per_second(), 25.0);
  database.add(clip("slow", 2, 12.5));
  EXPECT_THAT([&] { database.frames_per_second(); },
              ThrowsMessage<InvalidArgument>(AllOf(HasSubstr("clip 'crane' has 25 frames per second"),
                                                   HasSubstr("clip 'slow' has 12.5"))));
  EXPECT_THROW(PerformanceDatabase().frames_per_second(), InvalidArgument);
}

TEST(ContentHashOfADatabase, ChangesWithEverythingItCovers) {
  const auto hash_of = [](const std::vector<MeshSequence>& clips) {
    PerformanceDatabase database;
    for (const MeshSequence& each : clips) database.add(each);
    return database.content_hash();
  };
  const MeshSequence original = clip("crane");
  EXPECT_EQ(hash_of({original}), hash_of({clip("crane")}));

  std::set<std::string> hashes = {hash_of({original})};
  const auto expect_new = [&](const std::vector<MeshSequence>& clips, const std::string& change) {
    EXPECT_TRUE(hashes.insert(hash_of(clips)).second) << change;
  };
  expect_new({}, "no clip");
  expect_new({clip("crano")}, "name");
  expect_new({clip("crane", 4)}, "frame count");
  expect_new({clip("crane", 3, 50.0)}, "rate");
  Topology topology = two_triangles();
  topology.triangles[0] = {0, 2, 1};
  expect_new({clip("crane", 3, 25.0, topology)}, "triangles");
  // As many floats, laid out as other frames.
  topology = two_triangles();
  topology.vertex_count = 6;
  expect_new({clip("crane", 2, 25.0, topology)}, "vertex count");
  MeshSequence changed = original;
  changed.frame(2)(3, 2) = 1e-30F;
  expect_new({changed}, "one coordinate");
  expect_new({original, clip("jumping")}, "another clip");
  expect_new({clip("jumping"), original}, "order of clips");
}

}  // namespace
}  // namespace reprise
