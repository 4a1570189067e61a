// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/bvh.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/acclaim_skeleton.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

const std::string small =
    "HIERARCHY\n"
    "ROOT Hips\n"
    "{\n"
    "  OFFSET 0 90 0\n"
    "  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
    "  JOINT Left Leg\n"
    "  {\n"
    "    OFFSET 10 0 0\n"
    "    CHANNELS 1 Xrotation\n"
    "    End Site\n"
    "    {\n"
    "      OFFSET 0 -80 0\n"
    "    }\n"
    "  }\n"
    "}\n"
    "MOTION\n"
    "Frames: 2\n"
    "Frame Time: 0.0083333\n"
    "1 2 3 0 0 0 0\n"
    "1 2 3 0 0 90 -90\n";

SkeletalMotion parsed(const std::string& text) {
  return parse_bvh(text, "folder/walk.bvh");
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

double angle_between(const Quaterniond& a, const Quaterniond& b) {
  return a.angularDistance(b);
}

TEST(Bvh, ReadsJointsRestPoseAndFrames) {
  const SkeletalMotion motion = parsed(small);
  EXPECT_EQ(motion.name, "walk");
  EXPECT_EQ(motion.frames_per_second, 120.0);
  ASSERT_EQ(motion.skeleton.size(), 3);
  EXPECT_EQ(motion.skeleton.joints[1].name, "Left Leg");
  EXPECT_EQ(motion.skeleton.joints[2].name, "Left Leg_end");
  EXPECT_EQ(motion.skeleton.joints[2].parent, 1);
  EXPECT_NO_THROW(validate(motion.skeleton));
  EXPECT_LT((motion.skeleton.joints[2].rest_position - Vector3d(0.1, 0.1, 0.0)).norm(), 1e-12);
  ASSERT_EQ(motion.frames.size(), 2U);
  // The position channels stand for the offset; nothing turns.
  EXPECT_LT((motion.frames[0].position[0] - Vector3d(0.01, 0.02, 0.03)).norm(), 1e-12);
  EXPECT_LT((motion.frames[0].position[2] - Vector3d(0.11, -0.78, 0.03)).norm(), 1e-12);
  // A quarter turn left about Y puts the hip behind, the leg's own turn about (its) X lifts it.
  EXPECT_LT((motion.frames[1].position[1] - Vector3d(0.01, 0.02, -0.07)).norm(), 1e-12);
  EXPECT_LT((motion.frames[1].position[2] - Vector3d(0.81, 0.02, -0.07)).norm(), 1e-12);
}

TEST(Bvh, TheFirstRotationWrittenIsTheOutermost) {
  const auto rotation = [](const std::string& channels) {
    const std::string text = replaced(small, "Zrotation Xrotation Yrotation", channels);
    return parsed(replaced(text, "1 2 3 0 0 90 -90", "1 2 3 20 30 40 0")).frames[1].rotation[0];
  };
  const auto turn = [](double degrees, int axis) {
    return AngleAxisd(degrees * std::numbers::pi / 180.0, Vector3d::Unit(axis));
  };
  EXPECT_LT(angle_between(rotation("Zrotation Xrotation Yrotation"), turn(20, 2) * turn(30, 0) * turn(40, 1)),
            1e-7);
  EXPECT_LT(angle_between(rotation("Xrotation Yrotation Zrotation"), turn(20, 0) * turn(30, 1) * turn(40, 2)),
            1e-7);
  EXPECT_LT(angle_between(rotation("zrotation YROTATION Zrotation"), turn(20, 2) * turn(30, 1) * turn(40, 2)),
            1e-7);
}

TEST(Bvh, UnitsScaleLengthsAlone) {
  const SkeletalMotion centimetres = parsed(small);
  const SkeletalMotion inches = parse_bvh(small, "walk.bvh", {.metres_per_unit = 0.0254});
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_LT((inches.frames[1].position[j] - 2.54 * centimetres.frames[1].position[j]).norm(), 1e-12);
    EXPECT_LT(angle_between(inches.frames[1].rotation[j], centimetres.frames[1].rotation[j]), 1e-12);
  }
  EXPECT_THAT([] { parse_bvh(small, "walk.bvh", {.metres_per_unit = 0.0}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("0 metres per unit")));
}

TEST(Bvh, RatesAreWhatTheRoundedTimeMeans) {
  const auto rate = [](const std::string& time) {
    return parsed(replaced(small, "0.0083333", time)).frames_per_second;
  };
  EXPECT_EQ(rate(".0083333"), 120.0);
  EXPECT_EQ(rate("0.033333"), 30.0);
  EXPECT_EQ(rate("0.04"), 25.0);
  EXPECT_NEAR(rate("0.0333667"), 29.97, 1e-3);
  EXPECT_NEAR(rate("3.7"), 1.0 / 3.7, 1e-12);
}

TEST(Bvh, ReadsOddButGoodForms) {
  // Line ends of either kind, no last line end, a byte order mark, keywords in other cases, braces on the
  // same line.
  std::string text = small;
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2)
    text.replace(at, 1, "\r\n");
  EXPECT_EQ(parsed("\xEF\xBB\xBF" + text).frames.size(), 2U);
  EXPECT_EQ(parsed(small.substr(0, small.size() - 1)).frames.size(), 2U);
  EXPECT_EQ(parsed(replaced(small, "ROOT Hips\n{", "Root Hips {")).skeleton.joints[0].name, "Hips");
  // No space after "Frames:" and "Time:", tabs, numbers with exponents.
  std::string tight = replaced(replaced(small, "Frames: 2", "Frames:2"), "Frame Time: ", "Frame\tTime:");
  tight = replaced(replaced(tight, "1 2 3 0 0 0 0", "1e0\t2.0E+00\t30.e-1 0 0 0 -0e5"), "OFFSET 10",
                   "OFFSET\t1E1");
  EXPECT_LT((parsed(tight).frames[0].position[2] - parsed(small).frames[0].position[2]).norm(), 1e-12);
  EXPECT_EQ(parsed(tight).frames_per_second, 120.0);
  // Two sites on one joint, and a joint that has the name of a site.
  const std::string site = "    End Site\n    {\n      OFFSET 0 -80 0\n    }\n";
  const SkeletalMotion two = parsed(replaced(replaced(small, site, site + site), "Hips", "Left Leg_end"));
  EXPECT_EQ(two.skeleton.joints[2].name, "Left Leg_end_2");
  EXPECT_EQ(two.skeleton.joints[3].name, "Left Leg_end_3");
  // Two roots.
  const std::size_t begin = small.find("ROOT"), end = small.find("MOTION");
  const std::string other =
      replaced(replaced(small.substr(begin, end - begin), "Hips", "Prop"), "Left Leg", "Tip");
  std::string roots = replaced(small, "MOTION", other + "MOTION");
  roots = replaced(replaced(roots, "1 2 3 0 0 0 0", "1 2 3 0 0 0 0 4 5 6 0 0 0 0"), "90 -90",
                   "90 -90 4 5 6 0 0 0 0");
  EXPECT_LT((parsed(roots).frames[0].position[3] - Vector3d(0.04, 0.05, 0.06)).norm(), 1e-12);
}

TEST(BvhErrors, NameFileLineExpectedAndFound) {
  const auto error = [](const std::string& from, const std::string& to) {
    const std::string text = replaced(small, from, to);
    try {
      parsed(text);
    } catch (const FileError& failure) {
      return std::string(failure.what());
    }
    return std::string("no error");
  };
  // Not such a file.
  EXPECT_THAT(error("HIERARCHY", "solid cube"),
              AllOf(StartsWith("folder/walk.bvh:1: "), HasSubstr("expected 'HIERARCHY', found 'solid'")));
  EXPECT_THAT([] { parsed(""); }, ThrowsMessage<FileError>(HasSubstr("expected 'HIERARCHY'")));
  // Numbers missing, no numbers, not finite.
  EXPECT_THAT(error("OFFSET 10 0 0", "OFFSET 10 0"),
              HasSubstr("walk.bvh:9: expected three numbers after OFFSET, "
                        "found 'CHANNELS'"));
  EXPECT_THAT(error("1 2 3 0 0 0 0", "1 2 3 zero 0 0 0"),
              HasSubstr("walk.bvh:19: expected a number, found 'zero'"));
  for (const char* number : {"nan", "inf", "-inf", "1e999", "1e13"}) {
    EXPECT_THAT(error("1 2 3 0 0 0 0", std::string("1 2 3 0 0 0 ") + number), HasSubstr("walk.bvh:19: "))
        << number;
  }
  // Channels: too few, too many, unknown, none, twice.
  EXPECT_THAT(error("CHANNELS 1 Xrotation", "CHANNELS 2 Xrotation"), HasSubstr("expected 2 channels"));
  EXPECT_THAT(error("CHANNELS 1 Xrotation", "CHANNELS 1 Xrotation Yrotation"),
              HasSubstr("walk.bvh:9: expected 1 channels, found more: 'Yrotation'"));
  EXPECT_THAT(error("CHANNELS 1 Xrotation", "CHANNELS 1 Xspin"), HasSubstr("and then 'Xspin'"));
  EXPECT_THAT(error("CHANNELS 1 Xrotation", ""), HasSubstr("walk.bvh:6: the joint has no CHANNELS"));
  EXPECT_THAT(error("Xposition Yposition", "Xposition Xposition"), HasSubstr("stands twice"));
  EXPECT_THAT(error("CHANNELS 1 Xrotation", "CHANNELS 99999999999 Xrotation"),
              HasSubstr("the number of channels, found '99999999999'"));
  EXPECT_THAT(error("      OFFSET 0 -80 0", "      OFFSET 0 -80 0\n CHANNELS 0"),
              HasSubstr("an End Site has no channels"));
  // Names: none, twice.
  EXPECT_THAT(error("JOINT Left Leg", "JOINT"), HasSubstr("walk.bvh:6: expected the name of a joint"));
  EXPECT_THAT(error("JOINT Left Leg", "JOINT Hips"),
              HasSubstr("two joints are called 'Hips': the first is in line 2"));
  // An offset missing; a word out of place; a brace missing.
  EXPECT_THAT(error("OFFSET 10 0 0", ""), HasSubstr("walk.bvh:6: the joint has no OFFSET"));
  EXPECT_THAT(error("    CHANNELS 1", "    CHANELS 1"), HasSubstr("walk.bvh:9: expected OFFSET, CHANNELS"));
  EXPECT_THAT(error("  }\n}\n", "  }\n"), HasSubstr("found 'MOTION'"));
  // Frames: fewer or more values in a line, fewer or more lines, none, no count, a lying count.
  EXPECT_THAT(error("1 2 3 0 0 0 0", "1 2 3 0 0 0"),
              HasSubstr("walk.bvh:19: expected 7 values, one a channel, found 6"));
  EXPECT_THAT(error("1 2 3 0 0 0 0", "1 2 3 0 0 0 0 0"), HasSubstr("found 8"));
  EXPECT_THAT(error("Frames: 2", "Frames: 3"),
              HasSubstr("walk.bvh:20: is truncated: expected 3 frames after line 18, found 2"));
  EXPECT_THAT(error("Frames: 2", "Frames: 1"),
              HasSubstr("walk.bvh:20: expected the end of the file after 1 frames"));
  EXPECT_THAT(error("Frames: 2", "Frames: 0"), HasSubstr("expected at least one frame"));
  EXPECT_THAT(error("Frames: 2", "Frames: two"), HasSubstr("the number of frames, found 'two'"));
  EXPECT_THAT(error("Frames: 2", "Frames: 2000000000"), HasSubstr("expected 2000000000 frames"));
  EXPECT_THAT(error("Frames: 2", "Frames: -2"), HasSubstr("the number of frames, found '-2'"));
  // Time between frames.
  for (const char* time : {"0", "-0.01", "nan", "fast", "1e-320"}) {
    EXPECT_THAT(error("0.0083333", time), HasSubstr("walk.bvh:18: ")) << time;
  }
}

TEST(BvhErrors, EveryTruncationIsNoticed) {
  // Up to the last number itself, whose digits may be fewer.
  for (std::size_t size = 0; size + 3 < small.size(); ++size) {
    EXPECT_THROW(parsed(small.substr(0, size)), FileError) << small.substr(0, size);
  }
}

// Poses are held for every joint: a small file must not ask for memory without end.
TEST(BvhErrors, ManyJointsOnFewChannelsAreRefused) {
  std::string text = "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 1 Xrotation\n";
  for (int i = 0; i < 100; ++i) text += "End Site { OFFSET 0 1 0 }\n";
  text += "}\nMOTION\nFrames: 1\nFrame Time: 1\n0\n";
  EXPECT_THAT([&] { parsed(text); },
              ThrowsMessage<FileError>(HasSubstr("1 channels cannot move 101 joints")));
}

SkeletalMotion random_motion(unsigned seed, std::size_t frame_count) {
  SkeletalMotion motion{"random", {}, 24.0, {}};
  motion.skeleton.joints = {{"pelvis", -1, {0.01, 0.9, -0.02}}, {"chest", 0, {0.0, 1.3, 0.0}},
                            {"head", 1, {0.0, 1.6, 0.05}},      {"head_end", 2, {0.0, 1.8, 0.05}},
                            {"left hand", 1, {0.7, 1.3, 0.0}},  {"prop", -1, {0.5, 0.0, 0.5}}};
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (std::size_t f = 0; f < frame_count; ++f) {
    std::vector<Quaterniond> rotations;
    for (int j = 0; j < 6; ++j) {
      rotations.push_back(
          Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized());
    }
    rotations[3] = rotations[2];
    motion.frames.push_back(
        pose_from_rotations(motion.skeleton, rotations, {normal(random), normal(random), normal(random)}));
  }
  return motion;
}

TEST(BvhWriter, WhatIsWrittenIsReadBack) {
  SkeletalMotion motion = random_motion(1, 50);
  // Where X is a quarter turn, the other two angles are not unique.
  motion.frames[7] = pose_from_rotations(
      motion.skeleton,
      std::vector<Quaterniond>(6, Quaterniond(AngleAxisd(0.7, Vector3d::UnitZ()) *
                                              AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitX()))),
      {0, 1, 0});
  for (const double unit : {0.01, 1.0, 0.0254 / 0.45}) {
    const SkeletalMotion again =
        parse_bvh(format_bvh(motion, {.metres_per_unit = unit}), "random.bvh", {.metres_per_unit = unit});
    EXPECT_EQ(again.frames_per_second, 24.0);
    EXPECT_EQ(again.skeleton.find("head_end"), 3);
    ASSERT_EQ(again.frames.size(), motion.frames.size());
    const std::vector<std::string> names = {"pelvis", "chest", "head", "head_end", "left_hand", "prop"};
    for (std::size_t j = 0; j < names.size(); ++j) {
      const auto k = static_cast<std::size_t>(again.skeleton.joint_idx(names[j]));
      EXPECT_LT((again.skeleton.joints[k].rest_position - motion.skeleton.joints[j].rest_position).norm(),
                1e-5);
      for (std::size_t f = 0; f < motion.frames.size(); ++f) {
        EXPECT_LT((again.frames[f].position[k] - motion.frames[f].position[j]).norm(), 1e-5) << names[j];
        EXPECT_LT(angle_between(again.frames[f].rotation[k], motion.frames[f].rotation[j]), 1e-6) << names[j];
      }
    }
    // Written again, the text is the same: nothing is lost or added on the way.
    if (unit == 0.01) {
      const std::string once = format_bvh(again);
      EXPECT_EQ(format_bvh(parsed(once)), once);
    }
  }
}

// Programs interpolate the angles of neighbouring frames.
TEST(BvhWriter, AnglesDoNotJump) {
  SkeletalMotion motion = random_motion(2, 1);
  motion.frames.clear();
  for (int f = 0; f < 200; ++f) {
    const double t = 0.05 * f;
    const Quaterniond spin(AngleAxisd(2.0 * t, Vector3d(0.3, 1.0, 0.2).normalized()));
    motion.frames.push_back(
        pose_from_rotations(motion.skeleton, std::vector<Quaterniond>(6, spin), {0, 1, 0}));
  }
  std::istringstream text(format_bvh(motion));
  std::string line;
  while (line.rfind("Frame Time", 0) != 0) std::getline(text, line);
  std::vector<double> previous;
  int frames = 0;
  for (; std::getline(text, line); ++frames) {
    std::istringstream words(line);
    std::vector<double> values;
    for (double value = 0; words >> value;) values.push_back(value);
    for (std::size_t i = 0; i < previous.size(); ++i) EXPECT_LT(std::abs(values[i] - previous[i]), 30.0);
    previous = values;
  }
  EXPECT_EQ(frames, 200);
}

TEST(BvhWriter, WritesWholeOrNotAtAll) {
  const test::TemporaryFolder folder;
  const SkeletalMotion motion = random_motion(3, 4);
  write_bvh(motion, folder / "out.bvh");
  EXPECT_EQ(read_text_file(folder / "out.bvh"), format_bvh(motion));
  EXPECT_EQ(read_bvh(folder / "out.bvh").frames.size(), 4U);
  EXPECT_THROW(write_bvh(motion, folder / "missing" / "out.bvh"), FileError);
  EXPECT_THROW(read_bvh(folder / "missing.bvh"), FileError);
}

TEST(BvhWriter, RefusesWhatCannotBeWritten) {
  // No frames, no joints, a pose that is not finite or not of the skeleton, two names that become one.
  EXPECT_THAT([] { format_bvh(random_motion(1, 0)); },
              ThrowsMessage<InvalidArgument>(HasSubstr("'random' has no frames")));
  EXPECT_THAT(
      [] {
        format_bvh({"none", {}, 25.0, {SkeletonPose{}}});
      },
      ThrowsMessage<InvalidArgument>(HasSubstr("has no joints")));
  SkeletalMotion motion = random_motion(1, 2);
  motion.frames[1].position[2].x() = std::nan("");
  EXPECT_THAT([&] { format_bvh(motion); }, ThrowsMessage<InvalidArgument>(HasSubstr("frame 1")));
  motion = random_motion(1, 2);
  motion.frames[0].rotation.pop_back();
  EXPECT_THAT([&] { format_bvh(motion); }, ThrowsMessage<InvalidArgument>(HasSubstr("frame 0")));
  motion = random_motion(1, 2);
  motion.skeleton.joints[1].name = "left_hand";
  EXPECT_THAT([&] { format_bvh(motion); },
              ThrowsMessage<InvalidArgument>(HasSubstr("two joints would be called 'left_hand'")));
}

// Inputs that fuzzing made of good files, and files that lie about their sizes; of other formats too.
TEST(MotionCorpus, EveryFileIsReadOrRefusedWithAMessage) {
  int count = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(REPRISE_SOURCE_DIR "/tests/fuzz/corpus")) {
    if (!entry.is_regular_file()) continue;
    ++count;
    const std::string bytes = read_text_file(entry.path());
    const std::size_t middle = std::min(bytes.find("\n%%\n"), bytes.size());
    for (const auto& parse : std::initializer_list<std::function<void()>>{
             [&] { validate(parse_bvh(bytes, entry.path()).skeleton); },
             [&] {
               const AcclaimSkeleton skeleton = parse_asf(bytes.substr(0, middle), entry.path());
               parse_amc(bytes.substr(std::min(bytes.size(), middle + 4)), entry.path(), skeleton);
             }}) {
      try {
        parse();
      } catch (const FileError& error) {
        EXPECT_THAT(error.what(), HasSubstr(entry.path().filename().string()));
      }
    }
  }
  EXPECT_GE(count, 30);
}

TEST(BvhRealFiles, AllAreReadAndStandUpright) {
  REPRISE_REQUIRE_DATA();
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::data_folder() / "cmu" / "bvh")) {
    ++count;
    const bool is_daz = entry.path().filename().string().starts_with("3");
    const SkeletalMotion motion = read_bvh(entry.path(), {.metres_per_unit = is_daz ? 0.01 : 0.0254 / 0.45});
    EXPECT_EQ(motion.frames_per_second, 120.0);
    EXPECT_EQ(motion.skeleton.size(), is_daz ? 57 : 38) << entry.path();
    EXPECT_NO_THROW(validate(motion.skeleton));
    const auto head = static_cast<std::size_t>(motion.skeleton.joint_idx(is_daz ? "head" : "Head"));
    double height = 0.0;
    for (const SkeletonPose& pose : motion.frames) height += pose.position[head].y();
    height /= static_cast<double>(motion.frames.size());
    EXPECT_GT(height, 1.2) << entry.path();
    EXPECT_LT(height, 1.6) << entry.path();
  }
  EXPECT_EQ(count, 10);
}

}  // namespace
}  // namespace reprise
