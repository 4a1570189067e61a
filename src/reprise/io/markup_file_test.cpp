// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/markup_file.h"

#include <filesystem>
#include <fstream>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "support/shapes.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

// Six vertices, three frames; frame 0 is the reference.
PerformanceDatabase database() {
  const test::Shape shape = test::sphere(0);
  MeshSequence clip("rise", shape.topology, 3, 25.0);
  for (std::size_t f = 0; f < 3; ++f) {
    clip.frame(f) = shape.positions;
    clip.frame(f).col(1).array() += 0.1F * static_cast<float>(f);
  }
  PerformanceDatabase made;
  made.add(std::move(clip));
  return made;
}

Markup markup() {
  Markup made;
  made.skeleton.joints = {{.name = "pelvis", .parent = -1, .rest_position = {0.0, 1.0 / 3.0, 0.1}},
                          {.name = "knee \"é\"", .parent = 0, .rest_position = {0.0, 0.5, 1e-17}}};
  made.reference = test::sphere(0).positions;
  made.joint_of_vertex = {0, 1, 1, -1, 0, 1};
  made.parts = {{.name = "torso", .parent = -1, .vertices = {0, 3, 4, 5}},
                {.name = "leg", .parent = 0, .vertices = {1, 2, 5}}};
  made.layers = {"skin", "skirt"};
  made.layer_of_vertex = {0, 0, 0, 1, 0, 1};
  return made;
}

void expect_equal(const Markup& a, const Markup& b) {
  ASSERT_EQ(a.skeleton.size(), b.skeleton.size());
  for (std::size_t j = 0; j < a.skeleton.joints.size(); ++j) {
    EXPECT_EQ(a.skeleton.joints[j].name, b.skeleton.joints[j].name);
    EXPECT_EQ(a.skeleton.joints[j].parent, b.skeleton.joints[j].parent);
    EXPECT_EQ(a.skeleton.joints[j].rest_position, b.skeleton.joints[j].rest_position);
  }
  EXPECT_EQ(a.reference, b.reference);
  EXPECT_EQ(a.joint_of_vertex, b.joint_of_vertex);
  ASSERT_EQ(a.parts.size(), b.parts.size());
  for (std::size_t p = 0; p < a.parts.size(); ++p) {
    EXPECT_EQ(a.parts[p].name, b.parts[p].name);
    EXPECT_EQ(a.parts[p].parent, b.parts[p].parent);
    EXPECT_EQ(a.parts[p].vertices, b.parts[p].vertices);
  }
  EXPECT_EQ(a.layers, b.layers);
  EXPECT_EQ(a.layer_of_vertex, b.layer_of_vertex);
}

TEST(MarkupFile, WhatIsWrittenIsReadBack) {
  const test::TemporaryFolder folder;
  PerformanceDatabase marked = database();
  Markup full = markup();
  Markup bare = full;  // no parts, no layers
  bare.parts.clear();
  bare.layers.clear();
  bare.layer_of_vertex.clear();
  Markup elsewhere = full;  // a reference that no clip shows
  elsewhere.reference(2, 1) = 0.1F;
  for (const Markup& each : {full, bare, elsewhere}) {
    marked.set_markup(each);
    write_markup_file(marked, folder / "m.json");
    expect_equal(read_markup_file(folder / "m.json", marked), each);
  }
  marked.set_markup(full);
  write_markup_file(marked, folder / "m.json");
  EXPECT_EQ(json::parse(read_text_file(folder / "m.json"))["reference"], "rise:0");
  // Another frame than the file's.
  EXPECT_EQ(read_markup_file(folder / "m.json", marked, "rise:2").reference, marked.clip(0).frame(2));
  EXPECT_THROW(write_markup_file(database(), folder / "m.json"), InvalidArgument);
}

TEST(MarkupFile, AJointWithoutPositionStandsOnItsBorder) {
  const test::TemporaryFolder folder;
  const json file = {{"format", "reprise markup"},
                     {"version", 1},
                     {"reference", "rise:1"},
                     {"joints",
                      {{{"name", "body"}, {"parent", nullptr}, {"vertices", {0, 1, 2, 3, 5}}},
                       {{"name", "tip"}, {"parent", "body"}, {"vertices", {4}}},
                       {{"name", "far"}, {"parent", "body"}, {"position", {1, 2, 3}}}}}};
  write_text_file(folder / "m.json", file.dump());
  const PerformanceDatabase base = database();
  const Markup read = read_markup_file(folder / "m.json", base);
  // The middle of the edges that lead to vertex 4.
  const Topology& topology = *base.topology();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  int count = 0;
  for (const Triangle& t : topology.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (t[(k + 1) % 3] != 4) continue;
      middle += 0.5 * (read.reference.row(t[k]) + read.reference.row(4)).transpose().cast<double>();
      ++count;
    }
  }
  EXPECT_LT((read.skeleton.joints[1].rest_position - middle / count).norm(), 1e-12);
  EXPECT_EQ(read.skeleton.joints[2].rest_position, Eigen::Vector3d(1, 2, 3));
  // The root has no border: the centroid of its vertices.
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  for (const int v : {0, 1, 2, 3, 5}) centroid += read.reference.row(v).transpose().cast<double>() / 5.0;
  EXPECT_LT((read.skeleton.joints[0].rest_position - centroid).norm(), 1e-12);
  EXPECT_EQ(read.reference, base.clip(0).frame(1));
}

TEST(MarkupFile, PartsMayComeWithoutTheirTree) {
  const test::TemporaryFolder folder;
  const PerformanceDatabase base = database();
  json file = {{"format", "reprise markup"},
               {"version", 1},
               {"reference", "rise:0"},
               {"joints", {{{"name", "body"}, {"parent", nullptr}, {"vertices", {0, 1, 2, 3, 4, 5}}}}},
               {"root_part", "middle"},
               {"parts",
                {{{"name", "end"}, {"vertices", {0, 1, 2}}},
                 {{"name", "tail"}, {"vertices", {4, 5}}},
                 {{"name", "middle"}, {"parent", nullptr}, {"vertices", {2, 1, 3, 4}}}}}};
  write_text_file(folder / "m.json", file.dump());
  const std::vector<BodyPart> parts = read_markup_file(folder / "m.json", base).parts;
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_EQ(parts[0].name, "middle");
  EXPECT_THAT(parts[0].vertices, ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(parts[1].name, "end");
  EXPECT_EQ(parts[2].name, "tail");
  EXPECT_EQ(parts[1].parent, 0);
  EXPECT_EQ(parts[2].parent, 0);

  const auto expect_refused = [&](const json& spoilt, const std::string& field, const std::string& what) {
    write_text_file(folder / "m.json", spoilt.dump());
    EXPECT_THAT([&] { (void)read_markup_file(folder / "m.json", base); },
                ThrowsMessage<FileError>(AllOf(HasSubstr(field), HasSubstr(what))));
  };
  // No such root.
  json bad = file;
  bad["root_part"] = "torso";
  expect_refused(bad, "root_part", "there is no part 'torso'");
  // A tree twice.
  bad = file;
  bad["parts"][1]["parent"] = "end";
  expect_refused(bad, "parts[1].parent", "expected no parents");
  // Parts that do not hang together.
  bad = file;
  bad["parts"][1]["vertices"] = {5};
  expect_refused(bad, "parts", "'tail' shares no vertex with any other part");
  // No tree at all.
  bad = file;
  bad.erase("root_part");
  expect_refused(bad, "parts[1]",
                 "'tail' lacks a parent: expected the name of a part before it, or the field");
}

TEST(MarkupFile, PartsMayFollowJoints) {
  const test::TemporaryFolder folder;
  const PerformanceDatabase base = database();
  const json file = {
      {"format", "reprise markup"},
      {"version", 1},
      {"reference", "rise:0"},
      {"joints",
       {{{"name", "body"}, {"parent", nullptr}, {"vertices", {0, 1, 2}}},
        {{"name", "neck"}, {"parent", "body"}, {"position", {0, 1, 0}}},
        {{"name", "head"}, {"parent", "neck"}, {"vertices", {3, 4, 5}}}}},
      {"parts", {{{"name", "trunk"}}, {{"name", "top"}, {"parent", "trunk"}, {"joints", {"neck"}}}}}};
  write_text_file(folder / "m.json", file.dump());
  const Markup read = read_markup_file(folder / "m.json", base);
  ASSERT_EQ(read.parts.size(), 2U);
  EXPECT_EQ(read.parts[1].name, "top");
  EXPECT_EQ(read.parts[1].parent, 0);
  // No edge is as short as the overlap: parts are their joints' vertices.
  EXPECT_THAT(read.parts[0].vertices, ElementsAre(0, 1, 2));
  EXPECT_THAT(read.parts[1].vertices, ElementsAre(3, 4, 5));

  const auto expect_refused = [&](const json& spoilt, const std::string& field, const std::string& what) {
    write_text_file(folder / "m.json", spoilt.dump());
    EXPECT_THAT([&] { (void)read_markup_file(folder / "m.json", base); },
                ThrowsMessage<FileError>(AllOf(HasSubstr(field), HasSubstr(what))));
  };
  json bad = file;
  bad["parts"][1]["joints"] = {"nekc"};
  expect_refused(bad, "parts", "did you mean 'neck'");
  bad = file;
  bad["parts"][0]["vertices"] = {0, 1};
  expect_refused(bad, "parts[0].vertices", "either all vertices or all joints");
  bad = file;
  bad["root_part"] = "trunk";
  expect_refused(bad, "root_part", "expected parts of vertices");
}

TEST(MarkupFile, ErrorsNameFileAndField) {
  const test::TemporaryFolder folder;
  const PerformanceDatabase base = database();
  PerformanceDatabase marked = database();
  marked.set_markup(markup());
  write_markup_file(marked, folder / "good.json");
  const json good = json::parse(read_text_file(folder / "good.json"));
  const auto expect_refused = [&](const std::function<void(json&)>& spoil, const std::string& field,
                                  const std::string& what) {
    json file = good;
    spoil(file);
    write_text_file(folder / "m.json", file.dump());
    EXPECT_THAT([&] { (void)read_markup_file(folder / "m.json", base); },
                ThrowsMessage<FileError>(AllOf(HasSubstr("m.json"), HasSubstr(field), HasSubstr(what))))
        << file.dump();
  };
  // No markup file; a later one.
  expect_refused([](json& f) { f["format"] = "another"; }, "", "is not a markup file");
  expect_refused([](json& f) { f = json::array(); }, "", "is not a markup file");
  expect_refused([](json& f) { f["version"] = 2; }, "version", "reads up to version 1");
  // References.
  expect_refused([](json& f) { f.erase("reference"); }, "reference", "expected this field");
  expect_refused([](json& f) { f["reference"] = "rose:0"; }, "reference", "did you mean 'rise'");
  expect_refused([](json& f) { f["reference"] = "rise:3"; }, "reference", "frames 0 to 2");
  expect_refused([](json& f) { f["reference"] = {{1, 2, 3}}; }, "reference", "or 6 positions");
  expect_refused(
      [](json& f) {
        f["reference"] = json(6, json::array({1, 2}));
      },
      "reference[0]", "three numbers");
  // Joints.
  expect_refused([](json& f) { f["joints"][1]["name"] = "pelvis"; }, "joints[1].name", "already");
  expect_refused([](json& f) { f["joints"][1]["name"] = ""; }, "", "name");
  expect_refused([](json& f) { f["joints"][1]["parent"] = "hip"; }, "joints[1].parent", "listed before");
  expect_refused([](json& f) { f["joints"][1]["position"] = {1, 2}; }, "joints[1].position", "three numbers");
  expect_refused([](json& f) { f["joints"][1]["vertices"][0] = 6; }, "joints[1].vertices[0]", "from 0 to 5");
  expect_refused([](json& f) { f["joints"][1]["vertices"][0] = -1; }, "joints[1].vertices[0]", "found -1");
  expect_refused([](json& f) { f["joints"][1]["vertices"][0] = 1.5; }, "joints[1].vertices[0]", "integer");
  expect_refused([](json& f) { f["joints"][1]["vertices"] = {0}; }, "joints[1].vertices", "'pelvis' already");
  expect_refused(
      [](json& f) {
        f["joints"][1].erase("vertices");
        f["joints"][1].erase("position");
      },
      "joints[1]", "neither a position nor vertices");
  expect_refused([](json& f) { f["joints"] = json::array(); }, "", "has no joint");
  // Parts and layers.
  expect_refused([](json& f) { f["parts"][1]["parent"] = nullptr; }, "", "'leg' lacks a parent");
  expect_refused([](json& f) { f["parts"][1]["vertices"] = json::array(); }, "", "'leg' holds no vertex");
  expect_refused([](json& f) { f["layers"][1]["vertices"] = {3}; }, "layers", "vertex 5 is in none");
  expect_refused([](json& f) { f["layers"][1]["vertices"][0] = 0; }, "layers[1].vertices", "'skin' already");
  // Damaged text.
  write_text_file(folder / "m.json", "{\n  \"format\": ");
  EXPECT_THAT([&] { (void)read_markup_file(folder / "m.json", base); },
              ThrowsMessage<FileError>(HasSubstr("line 2")));
  EXPECT_THROW((void)read_markup_file(folder / "missing.json", base), FileError);
  EXPECT_THROW((void)read_markup_file(folder / "good.json", PerformanceDatabase()), InvalidArgument);
}

TEST(LandmarkFile, IsReadAndChecked) {
  const test::TemporaryFolder folder;
  const json good = {{"format", "reprise landmarks"},
                     {"version", 1},
                     {"frame", "crane:0"},
                     {"landmarks", {{"neck", 7}, {"head_top", 2}}}};
  write_text_file(folder / "l.json", good.dump());
  const LandmarkFile read = read_landmark_file(folder / "l.json");
  EXPECT_EQ(read.frame, "crane:0");
  EXPECT_THAT(read.landmarks, ElementsAre(testing::Pair("head_top", 2), testing::Pair("neck", 7)));
  json bad = good;
  bad["landmarks"]["neck"] = "seven";
  write_text_file(folder / "l.json", bad.dump());
  EXPECT_THAT([&] { (void)read_landmark_file(folder / "l.json"); },
              ThrowsMessage<FileError>(AllOf(HasSubstr("landmarks.neck"), HasSubstr("integer"))));
  bad = good;
  bad.erase("landmarks");
  write_text_file(folder / "l.json", bad.dump());
  EXPECT_THAT([&] { (void)read_landmark_file(folder / "l.json"); },
              ThrowsMessage<FileError>(HasSubstr("landmarks: expected this field")));
  bad = good;
  bad["format"] = "reprise markup";
  write_text_file(folder / "l.json", bad.dump());
  EXPECT_THAT([&] { (void)read_landmark_file(folder / "l.json"); },
              ThrowsMessage<FileError>(HasSubstr("is not a landmark file")));
}

}  // namespace
}  // namespace reprise
