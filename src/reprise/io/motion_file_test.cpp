// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/motion_file.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/io/bvh.h"
#include "reprise/io/io_test_support.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

// A figure of 1.7 m that walks along Z at 1.3 m/s and swings arms and legs.
SkeletalMotion walking(std::size_t frame_count, double frames_per_second) {
  SkeletalMotion motion{"walk", {}, frames_per_second, {}};
  motion.skeleton.joints = {{"Hips", -1, {0, 0.95, 0}},
                            {"Head", 0, {0, 1.6, 0}},
                            {"Head_end", 1, {0, 1.7, 0}},
                            {"LeftArm", 0, {0.2, 1.4, 0}},
                            {"LeftHand", 3, {0.75, 1.4, 0}},
                            {"LeftHand_end", 4, {0.85, 1.4, 0}},
                            {"RightArm", 0, {-0.2, 1.4, 0}},
                            {"RightHand", 6, {-0.75, 1.4, 0}},
                            {"RightHand_end", 7, {-0.85, 1.4, 0}},
                            {"LeftLeg", 0, {0.1, 0.9, 0}},
                            {"LeftFoot", 9, {0.1, 0.1, 0}},
                            {"LeftFoot_end", 10, {0.1, 0.0, 0.1}},
                            {"RightLeg", 0, {-0.1, 0.9, 0}},
                            {"RightFoot", 12, {-0.1, 0.1, 0}},
                            {"RightFoot_end", 13, {-0.1, 0.0, 0.1}}};
  for (std::size_t f = 0; f < frame_count; ++f) {
    const double t = static_cast<double>(f) / frames_per_second;
    std::vector<Quaterniond> rotations(motion.skeleton.joints.size(), Quaterniond::Identity());
    const double swing = std::sin(6.0 * t);
    const auto turn = [&](int joint, double angle, const Vector3d& axis) {
      for (int j = joint; j < motion.skeleton.size(); ++j) {
        const int parent = motion.skeleton.joints[static_cast<std::size_t>(j)].parent;
        if (j == joint || parent == joint || (parent >= 0 && j - joint == 2 && parent == joint + 1)) {
          rotations[static_cast<std::size_t>(j)] =
              Quaterniond(AngleAxisd(angle, axis)) * rotations[static_cast<std::size_t>(j)];
        }
      }
    };
    turn(1, 0.1 + 0.05 * swing, Vector3d::UnitX());
    turn(3, -1.2, Vector3d::UnitZ());
    turn(3, 0.5 * swing, Vector3d::UnitX());
    turn(4, -0.4 - 0.2 * swing, Vector3d::UnitX());
    turn(6, 1.2, Vector3d::UnitZ());
    turn(6, -0.5 * swing, Vector3d::UnitX());
    turn(7, -0.4 + 0.2 * swing, Vector3d::UnitX());
    turn(9, 0.1 - 0.4 * swing, Vector3d::UnitX());
    turn(10, 0.2 + 0.3 * swing, Vector3d::UnitX());
    turn(12, 0.1 + 0.4 * swing, Vector3d::UnitX());
    turn(13, 0.2 - 0.3 * swing, Vector3d::UnitX());
    motion.frames.push_back(
        pose_from_rotations(motion.skeleton, rotations, {0.0, 0.95 + 0.02 * std::cos(12.0 * t), 1.3 * t}));
  }
  return motion;
}

class MotionFileTest : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name, std::ios::binary) << text;
    return folder_.path() / name;
  }
  // The message of the error.
  static std::string error(const MotionSource& source) {
    try {
      read_motion(source);
    } catch (const Error& failure) {
      return failure.what();
    }
    return "no error";
  }
  test::TemporaryFolder folder_;
};

const std::string small_asf =
    ":units\n  angle deg\n:root\n order TX TY TZ RX RY RZ\n axis XYZ\n position 0 0 0\n orientation 0 0 0\n"
    ":bonedata\n begin\n name trunk\n direction 0 1 0\n length 12\n axis 0 0 0 XYZ\n dof rx ry rz\n end\n"
    " begin\n name leg\n direction 0 -1 0\n length 16\n axis 0 0 0 XYZ\n dof rx\n end\n"
    ":hierarchy\n begin\n root trunk leg\n end\n";
const std::string small_amc =
    ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 16 0 0 0 0\ntrunk 0 0 0\nleg 0\n2\nroot 0 16 0 0 0 0\ntrunk 1 0 "
    "0\nleg 1\n";

// The unit of a BVH is the one in which people are as tall as people.
TEST_F(MotionFileTest, UnitsOfBvhAreFound) {
  const SkeletalMotion motion = walking(30, 30.0);
  for (const double unit : {1.0, 0.01, 0.001, 0.0254, 0.0254 / 0.45}) {
    const auto path = write("walk.bvh", format_bvh(motion, {.metres_per_unit = unit}));
    const MotionFile file = read_motion({.motion = path});
    EXPECT_NEAR(file.metres_per_unit, unit, 1e-12);
    EXPECT_EQ(file.motion.frames_per_second, 30.0);
    EXPECT_THAT(file.notes, Contains(HasSubstr("the file has no unit")));
    EXPECT_LT((file.motion.frames[20].position[4] - motion.frames[20].position[4]).norm(), 1e-3) << unit;
    // Given: taken, without a note.
    const MotionFile given = read_motion({.motion = path, .metres_per_unit = unit});
    EXPECT_THAT(given.notes, IsEmpty());
    EXPECT_LT((given.motion.frames[20].position[4] - file.motion.frames[20].position[4]).norm(), 1e-9);
  }
}

TEST_F(MotionFileTest, AFigureThatIsNoPersonIsRefused) {
  const SkeletalMotion motion = walking(30, 30.0);
  const auto path = write("walk.bvh", format_bvh(motion, {.metres_per_unit = 0.01}));
  EXPECT_THAT(error({.motion = path, .metres_per_unit = 1.0}),
              AllOf(HasSubstr("walk.bvh"), HasSubstr("170.5 m tall with 1 metres a unit"),
                    HasSubstr("0.01 metres a unit (centimetres) would make it 1.71 m")));
  const auto odd = write("odd.bvh", format_bvh(motion, {.metres_per_unit = 0.17}));
  EXPECT_THAT(error({.motion = odd}), HasSubstr("would make it 1.65 m"));
  const auto point = write("point.bvh",
                           "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n}\nMOTION\n"
                           "Frames: 1\nFrame Time: 0.04\n0\n");
  EXPECT_THAT(error({.motion = point}), HasSubstr("no size"));
  // A prop on a root of its own, far away, is no part of the figure.
  SkeletalMotion with_prop = motion;
  with_prop.skeleton.joints.push_back({"Prop", -1, {0, 0, 50}});
  for (SkeletonPose& pose : with_prop.frames) {
    pose.rotation.push_back(Quaterniond::Identity());
    pose.position.emplace_back(0, 0, 50);
  }
  EXPECT_NEAR(read_motion({.motion = write("prop.bvh", format_bvh(with_prop))}).metres_per_unit, 0.01, 1e-12);
}

TEST_F(MotionFileTest, RatesThatAreNotKnownAreSaid) {
  const std::string text = format_bvh(walking(30, 25.0));
  const std::size_t begin = text.find("Frame Time:"), end = text.find('\n', begin);
  const auto with_line = [&](const std::string& line) {
    return write("walk.bvh", text.substr(0, begin) + line + text.substr(end + (line.empty() ? 1 : 0)));
  };
  EXPECT_THAT(error({.motion = with_line("Frame Time: 0")}),
              HasSubstr("expected a time between frames above 0"));
  EXPECT_THAT(error({.motion = with_line("")}), HasSubstr("expected 'Frame Time: SECONDS'"));
  EXPECT_THAT(error({.motion = with_line("Frame Time: 40")}), HasSubstr("0.025 frames a second"));
  EXPECT_EQ(read_motion({.motion = with_line("Frame Time:0.04")}).motion.frames_per_second, 25.0);
  // With a rate that is given, none of that matters.
  for (const char* line : {"Frame Time: 0", "", "Frame Time: 40", "Frame Time: 0.04"}) {
    const MotionFile file = read_motion({.motion = with_line(line), .frames_per_second = 50.0});
    EXPECT_EQ(file.motion.frames_per_second, 50.0) << line;
    EXPECT_EQ(file.motion.frames.size(), 30U) << line;
  }
  for (const double rate : {0.0, -1.0, std::nan("")}) {
    EXPECT_THAT(error({.motion = "walk.bvh", .frames_per_second = rate}), HasSubstr("frames per second"));
    EXPECT_THAT(error({.motion = "walk.bvh", .metres_per_unit = rate}), HasSubstr("metres per unit"));
  }
}

TEST_F(MotionFileTest, TheSkeletonOfAnAmcIsFound) {
  const auto motion = write("07_01.amc", small_amc);
  // None: what was looked for is listed.
  EXPECT_THAT(error({.motion = motion}),
              AllOf(HasSubstr("needs its skeleton"), HasSubstr("07.asf"), HasSubstr("07_01.asf"),
                    HasSubstr("0 .asf files lie beside it")));
  // The only one beside it, the subject's, the one that is named.
  const auto other = write("body.ASF", small_asf);
  EXPECT_THAT(read_motion({.motion = motion}).notes, Contains(HasSubstr("body.ASF")));
  write("more.asf", small_asf);
  EXPECT_THAT(error({.motion = motion}), HasSubstr("2 .asf files lie beside it"));
  write("07.asf", small_asf);
  const MotionFile file = read_motion({.motion = motion});
  EXPECT_THAT(file.notes, AllOf(Contains(HasSubstr("07.asf")), Contains(HasSubstr("120 frames a second"))));
  EXPECT_EQ(file.motion.frames_per_second, 120.0);
  EXPECT_NEAR(file.metres_per_unit, 0.0254 / 0.45, 1e-12);
  EXPECT_EQ(
      read_motion({.motion = motion, .skeleton = other, .frames_per_second = 60.0}).motion.frames_per_second,
      60.0);
  // In the folder asf beside the file's.
  std::filesystem::create_directories(folder_.path() / "amc");
  std::filesystem::create_directories(folder_.path() / "asf");
  std::filesystem::rename(motion, folder_.path() / "amc" / "07_01.amc");
  std::filesystem::rename(folder_.path() / "07.asf", folder_.path() / "asf" / "07.asf");
  EXPECT_EQ(read_motion({.motion = folder_.path() / "amc" / "07_01.amc"}).motion.frames.size(), 2U);
}

TEST_F(MotionFileTest, WhatDoesNotFitIsRefused) {
  const auto asf = write("07.asf", small_asf);
  const auto amc = [&](const std::string& text) { return write("07_01.amc", text); };
  const auto bvh = write("walk.bvh", format_bvh(walking(3, 25.0)));
  EXPECT_THAT(error({.motion = "walk.fbx"}), HasSubstr("expected a .bvh or .amc file, found '.fbx'"));
  EXPECT_THAT(error({.motion = "walk"}), HasSubstr("found no extension"));
  EXPECT_THAT(error({.motion = folder_.path() / "none.bvh"}), HasSubstr("none.bvh"));
  EXPECT_THAT(error({.motion = folder_.path() / "none.amc"}), HasSubstr("does not exist"));
  EXPECT_THAT(error({.motion = bvh, .skeleton = asf}), HasSubstr("has a skeleton of its own"));
  EXPECT_THAT(error({.motion = amc(small_amc), .skeleton = bvh}), HasSubstr("expected an .asf file"));
  EXPECT_THAT(error({.motion = amc(small_amc), .skeleton = folder_.path() / "08.asf"}), HasSubstr("08.asf"));
  // The skeleton of another figure.
  const std::string one_leg =
      small_asf.substr(0, small_asf.find(" begin\n name leg")) + ":hierarchy\n begin\n root trunk\n end\n";
  EXPECT_THAT(error({.motion = amc(small_amc), .skeleton = write("other.asf", one_leg)}),
              AllOf(HasSubstr("07_01.amc:6: "), HasSubstr("the skeleton has no bone 'leg'")));
  // Cut off within a frame, before any, and with values that are none.
  EXPECT_THAT(error({.motion = amc(small_amc.substr(0, small_amc.size() - 6))}),
              AllOf(HasSubstr("07_01.amc:7: frame 2 has no values of bone 'leg'"), HasSubstr("truncated")));
  EXPECT_THAT(error({.motion = amc(small_amc.substr(0, small_amc.find("1\nroot")))}), HasSubstr("truncated"));
  EXPECT_THAT(error({.motion = amc(small_amc.substr(0, small_amc.find("leg 0")) + "leg nan\n")}),
              HasSubstr("07_01.amc:6: "));
  std::string endless = format_bvh(walking(3, 25.0));
  endless.replace(endless.find("Frames: 3"), 9, "Frames: 0");
  EXPECT_THAT(error({.motion = write("none.bvh", endless)}), HasSubstr("expected at least one frame"));
}

TEST(MotionDefects, ASoundMotionHasNone) {
  for (const double rate : {25.0, 120.0}) {
    EXPECT_THAT(find_defects(walking(200, rate)), IsEmpty()) << rate;
  }
  EXPECT_THAT(find_defects(walking(1, 25.0)), IsEmpty());
  // At rest all along, or moving off from it smoothly.
  SkeletalMotion still = walking(60, 25.0);
  for (SkeletonPose& pose : still.frames) pose = rest_pose(still.skeleton);
  EXPECT_THAT(find_defects(still), IsEmpty());
  SkeletalMotion starting = walking(120, 25.0);
  for (std::size_t f = 0; f < 50; ++f) {
    const double u = static_cast<double>(f) / 50.0;
    starting.frames[f] = interpolate(starting.skeleton, rest_pose(starting.skeleton), starting.frames[f],
                                     u * u * (3.0 - 2.0 * u));
  }
  EXPECT_THAT(find_defects(starting), IsEmpty());
}

TEST(MotionDefects, JumpsAreFoundAndMended) {
  for (const double rate : {25.0, 120.0}) {
    const SkeletalMotion truth = walking(200, rate);
    SkeletalMotion motion = truth;
    const Vector3d jump(0.1, 0.0, 0.05);
    for (std::size_t f = 81; f < motion.frames.size(); ++f) {
      for (Vector3d& position : motion.frames[f].position) position += jump;
    }
    const std::vector<MotionDefect> defects = find_defects(motion);
    ASSERT_EQ(defects.size(), 1U) << rate;
    EXPECT_EQ(defects[0].kind, MotionDefect::Kind::jump);
    EXPECT_EQ(defects[0].first_frame, 80U);
    EXPECT_NEAR(defects[0].distance, jump.norm(), 0.02);
    EXPECT_EQ(to_string(defects[0], motion.skeleton), "the figure jumps 11 cm between frames 81 and 82");
    const SkeletalMotion mended = without_defects(motion, defects);
    ASSERT_EQ(mended.frames.size(), truth.frames.size());
    EXPECT_THAT(find_defects(mended), IsEmpty());
    // What comes after the jump stays, what was before follows.
    EXPECT_LT((mended.frames[150].position[1] - motion.frames[150].position[1]).norm(), 1e-12);
    EXPECT_LT((mended.frames[10].position[1] - truth.frames[10].position[1] - jump).norm(), 0.02);
  }
}

TEST(MotionDefects, FlipsAreFoundAndLedOver) {
  const SkeletalMotion truth = walking(200, 120.0);
  const auto joint = static_cast<std::size_t>(truth.skeleton.size() - 2);
  const auto flipped = [&](std::size_t first, std::size_t last) {
    SkeletalMotion motion = truth;
    for (std::size_t f = first; f <= last; ++f) {
      const Quaterniond turn(AngleAxisd(2.5, Vector3d::UnitX()));
      // With its End Site, the last joint.
      motion.frames[f].rotation[joint] = motion.frames[f].rotation[joint] * turn;
      motion.frames[f].rotation.back() = motion.frames[f].rotation.back() * turn;
      motion.frames[f].position.back() =
          motion.frames[f].position[joint] +
          motion.frames[f].rotation[joint] *
              (truth.skeleton.joints.back().rest_position - truth.skeleton.joints[joint].rest_position);
    }
    return motion;
  };
  struct Span {
    std::size_t first, last;
  };
  for (const auto [first, last] : {Span{80, 85}, Span{120, 120}, Span{0, 1}, Span{190, 199}}) {
    SCOPED_TRACE(first);
    const SkeletalMotion motion = flipped(first, last);
    const std::vector<MotionDefect> defects = find_defects(motion);
    ASSERT_EQ(defects.size(), 1U);
    EXPECT_EQ(defects[0].kind, MotionDefect::Kind::flip);
    EXPECT_EQ(defects[0].joint, static_cast<int>(joint));
    EXPECT_EQ(defects[0].first_frame, first);
    EXPECT_EQ(defects[0].last_frame, last);
    const SkeletalMotion mended = without_defects(motion, defects);
    EXPECT_THAT(find_defects(mended), IsEmpty());
    for (std::size_t f = first; f <= last; ++f) {
      EXPECT_LT(mended.frames[f].rotation[joint].angularDistance(truth.frames[f].rotation[joint]), 0.2);
    }
    EXPECT_LT((mended.frames[first].position.back() - truth.frames[first].position.back()).norm(), 0.05);
  }
  EXPECT_EQ(to_string(find_defects(flipped(80, 85))[0], truth.skeleton),
            truth.skeleton.joints[joint].name + " is turned over in frames 81 to 86");
  // A joint that stays turned is as it is: nothing tells which of both is right.
  EXPECT_THAT(find_defects(flipped(60, 140)), IsEmpty());
}

TEST(MotionDefects, LeadingRestPosesAreFoundAndLeftOut) {
  for (const double rate : {25.0, 120.0}) {
    SkeletalMotion motion = walking(100, rate);
    for (std::size_t f = 0; f < 3; ++f)
      motion.frames.insert(motion.frames.begin(), rest_pose(motion.skeleton));
    const std::vector<MotionDefect> defects = find_defects(motion);
    ASSERT_EQ(defects.size(), 1U) << rate;
    EXPECT_EQ(defects[0].kind, MotionDefect::Kind::rest_pose);
    EXPECT_EQ(to_string(defects[0], motion.skeleton), "frames 1 to 3 are in the rest pose");
    const SkeletalMotion mended = without_defects(motion, defects);
    EXPECT_EQ(mended.frames.size(), 100U);
    EXPECT_LT((mended.frames[0].position[3] - motion.frames[3].position[3]).norm(), 1e-12);
  }
  EXPECT_THAT([] { without_defects(walking(3, 25.0), {{.first_frame = 5, .last_frame = 6}}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("frames 5 to 6 of a motion of 3")));
}

// Every trial of the corpus is read as the index says, and of its defects those are named that its README
// lists, and joints that are seen to flip (the README does not speak of them), and no others.
TEST(MotionCorpusFiles, AllAreReadAndOnlyTrueDefectsAreNamed) {
  REPRISE_REQUIRE_DATA();
  const std::filesystem::path cmu = test::data_folder() / "cmu";
  const std::map<std::string, std::string> known = {
      {"08_07.amc", "the figure jumps 10 cm between frames 6 and 7"},
      {"09_10.amc", "frames 1 to 4 are in the rest pose"},
      {"16_15.amc", "lhumerus is turned over in frames 1 to 2"},
      {"16_16.amc", "lhand is turned over in frames 1 to 5"},
      {"16_23.amc", "rhumerus is turned over in frames 1 to 3"},
      {"35_19.amc", "rhand is turned over in frames 105 to 110"},
      {"35_26.amc", "rhand is turned over in frames 66 to 67"},
      {"39_05.amc", "rhand is turned over in frames 58 to 59"},
      {"39_07.amc", "rhand is turned over in frame 33"},
      {"39_10.amc", "rhand is turned over in frame 250"},
      {"08_07.bvh", "frame 1 is in the rest pose; the figure jumps 10 cm between frames 7 and 8"},
      {"07_12.bvh", "frames 1 to 2 are in the rest pose"}};
  std::ifstream index(cmu / "index.csv");
  std::string line;
  std::getline(index, line);
  int trials = 0, files = 0;
  while (std::getline(index, line)) {
    // Descriptions may have commas, in quotes.
    std::vector<std::string> fields(1);
    bool quoted = false;
    for (const char c : line) {
      if (c == '"') {
        quoted = !quoted;
      } else if (c == ',' && !quoted) {
        fields.emplace_back();
      } else {
        fields.back() += c;
      }
    }
    ++trials;
    for (const std::string extension : {"amc", "bvh"}) {
      const std::filesystem::path path = cmu / extension / (fields[0] + "." + extension);
      if (!std::filesystem::exists(path)) continue;
      SCOPED_TRACE(path.filename());
      ++files;
      const MotionFile file = read_motion({.motion = path});
      EXPECT_EQ(file.motion.frames_per_second, 120.0);
      if (extension == "amc") {
        EXPECT_EQ(file.motion.frames.size(), static_cast<std::size_t>(std::stoi(fields[4])));
      }
      std::string found;
      for (const MotionDefect& defect : find_defects(file.motion)) {
        found += (found.empty() ? "" : "; ") + to_string(defect, file.motion.skeleton);
      }
      const auto expected = known.find(path.filename().string());
      if (expected != known.end()) {
        EXPECT_EQ(found, expected->second);
      } else {
        EXPECT_EQ(found, extension == "bvh" ? "frame 1 is in the rest pose" : "");
      }
    }
  }
  EXPECT_EQ(trials, 131);
  EXPECT_EQ(files, 130 + 10);
}

}  // namespace
}  // namespace reprise
