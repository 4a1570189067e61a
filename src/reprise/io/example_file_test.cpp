// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/example_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "support/captured_log.h"
#include "support/shapes.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

const std::vector<std::string> part_names = {"torso", "left_leg"};

PerformanceDatabase database() {
  return test::database_of({test::walk("walk", 100), test::walk("run", 40)});
}

FrameId walk(std::size_t frame_idx) {
  return {.clip_idx = 0, .frame_idx = frame_idx};
}

FrameId run(std::size_t frame_idx) {
  return {.clip_idx = 1, .frame_idx = frame_idx};
}

ExampleList read(const std::string& text) {
  const test::TemporaryFolder folder;
  write_text_file(folder / "examples.json", text);
  return read_example_file(folder / "examples.json", database(), part_names);
}

std::string with_head(const std::string& fields) {
  return R"({"format": "reprise examples", "version": 1, )" + fields + "}";
}

TEST(ExampleFile, ListsFramesOfAllPartsAndOfOne) {
  const ExampleList list = read(with_head(
      R"("frames": ["walk:20-40:10", "run:3", "walk:30"], "parts": {"left_leg": ["run:1-3", "run:0-2"]})"));
  EXPECT_THAT(list.of("torso"), ElementsAre(walk(20), walk(30), walk(40), run(3)));  // repeated ones once
  EXPECT_THAT(list.of("left_leg"), ElementsAre(run(1), run(2), run(3), run(0)));     // in the order given
  const ExampleList one = read(with_head(R"("parts": {"left_leg": ["run"]})"));
  EXPECT_EQ(one.of("left_leg").size(), 40U);
  EXPECT_THAT(one.of("torso"), IsEmpty());  // not said: the caller's to choose
}

TEST(ExampleFile, WhatIsWrittenIsReadBack) {
  const test::TemporaryFolder folder;
  const auto path = folder / "examples.json";
  for (const ExampleList& list :
       {ExampleList{.frames = {walk(4), walk(5), walk(6), run(7), run(6), walk(99), run(0)},
       .frames_of_part = {{"torso", {run(39)}}, {"left_leg", {walk(0), walk(2), walk(1)}}}},
        ExampleList{.frames = {run(39)}}, ExampleList{.frames_of_part = {{"torso", {walk(98), walk(99)}}}}}) {
    write_example_file(list, database(), path);
    const ExampleList again = read_example_file(path, database(), part_names);
    EXPECT_EQ(again.frames, list.frames);
    EXPECT_EQ(again.frames_of_part, list.frames_of_part);
  }
  write_example_file({.frames = {walk(4), walk(5), walk(6), run(7), run(9)}}, database(), path);
  EXPECT_THAT(read_text_file(path), AllOf(HasSubstr("\"walk:4-6\""), HasSubstr("\"run:7\"")));
}

TEST(ExampleFile, UnknownFieldsAreWarnedOf) {
  const test::CapturedLog log;
  read(with_head(R"("frames": ["run"], "part": {})"));
  EXPECT_THAT(log.text(), AllOf(HasSubstr("'part'"), HasSubstr("did you mean 'parts'?")));
}

TEST(ExampleFile, BadFilesAreNamed) {
  const auto expect = [](const std::string& text, const std::string& place, const std::string& what) {
    EXPECT_THAT([&] { read(text); }, ThrowsMessage<FileError>(AllOf(HasSubstr("examples.json"),
                                                                    HasSubstr(place), HasSubstr(what))))
        << text;
  };
  // not JSON, another format, a newer version
  expect("{\"format\":\n oops", "line 2, column 2", "is not JSON");
  expect("[]", "", "is not a list of examples");
  expect(R"({"format": "reprise markup", "version": 1})", "", "is not a list of examples");
  expect(R"({"format": "reprise examples", "version": 2})", "version", "up to version 1");
  expect(R"({"format": "reprise examples"})", "version", "expected this field");
  // nothing in it
  expect(R"({"format": "reprise examples", "version": 1})", "top level", "found neither");
  expect(with_head(R"("parts": {})"), "top level", "found neither");
  expect(with_head(R"("frames": [])"), "frames", "found none");
  expect(with_head(R"("frames": ["run"], "parts": {"torso": []})"), "parts.torso", "found none");
  // of another kind
  expect(with_head(R"("frames": "run:3")"), "frames", "expected a list, found string");
  expect(with_head(R"("frames": [3])"), "frames[0]", "expected a text, found number 3");
  expect(with_head(R"("parts": ["torso"])"), "parts", "expected an object");
  // frames that are not there
  expect(with_head(R"("frames": ["run:3", "runn:4"])"), "frames[1]", "did you mean 'run'?");
  expect(with_head(R"("frames": ["run:40"])"), "frames[0]", "has frames 0 to 39");
  expect(with_head(R"("parts": {"torso": ["run:7-3"]})"), "parts.torso[0]", "ends before it begins");
  // parts that are not there
  expect(with_head(R"("parts": {"left_lag": ["run"]})"), "parts.left_lag", "did you mean 'left_leg'?");
  expect(with_head(R"("parts": {"tail": ["run"]})"), "parts.tail", "the parts are torso, left_leg");
  EXPECT_THROW(read_example_file("/nowhere/examples.json", database(), part_names), FileError);
}

TEST(ExampleFile, WritesNothingThatCannotBeRead) {
  const test::TemporaryFolder folder;
  const auto path = folder / "examples.json";
  for (const ExampleList& list :
       {ExampleList{}, ExampleList{.frames = {run(40)}}, ExampleList{.frames = {run(39), run(40)}},
        ExampleList{.frames = {{.clip_idx = 2, .frame_idx = 0}}},
        ExampleList{.frames = {run(0)}, .frames_of_part = {{"torso", {}}}}}) {
    EXPECT_THROW(write_example_file(list, database(), path), InvalidArgument);
    EXPECT_FALSE(std::filesystem::exists(path));
  }
}

}  // namespace
}  // namespace reprise
