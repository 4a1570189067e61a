// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/acclaim.h"

#include <algorithm>
#include <array>
#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/acclaim_skeleton.h"
#include "reprise/io/bvh.h"
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

// An arm of two bones whose own axes are turned against the world's.
const std::string small_asf =
    "# comment\n"
    ":version 1.10\n"
    ":name test\n"
    ":units\n"
    "  mass 1.0\n"
    "  length 0.45\n"
    "  angle deg\n"
    ":documentation\n"
    "  free text, begin end\n"
    ":root\n"
    "  order TX TY TZ RX RY RZ\n"
    "  axis XYZ\n"
    "  position 0 10 0\n"
    "  orientation 0 0 0\n"
    ":bonedata\n"
    "  begin\n"
    "    id 1\n"
    "    name upper\n"
    "    direction 1 0 0\n"
    "    length 3\n"
    "    axis 0 0 90 XYZ\n"
    "    dof rx ry rz\n"
    "    limits (-160.0 20.0)\n"
    "           (-70.0 70.0)\n"
    "           (-60.0 70.0)\n"
    "  end\n"
    "  begin\n"
    "    id 2\n"
    "    name lower\n"
    "    direction 1 0 0\n"
    "    length 2\n"
    "    axis 0 0 0 XYZ\n"
    "    dof ry\n"
    "  end\n"
    ":hierarchy\n"
    "  begin\n"
    "    root upper\n"
    "    upper lower\n"
    "  end\n";

const std::string small_amc =
    "#!OML:ASF test.asf\n"
    ":FULLY-SPECIFIED\n"
    ":DEGREES\n"
    "1\n"
    "root 1 2 3 0 0 0\n"
    "upper 0 0 0\n"
    "lower 0\n"
    "2\n"
    "root 1 2 3 0 0 90\n"
    "upper 90 0 0\n"
    "lower -90\n";

SkeletalMotion parsed(const std::string& asf, const std::string& amc) {
  return parse_amc(amc, "folder/walk.amc", parse_asf(asf, "folder/body.asf"), {.metres_per_unit = 1.0});
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

Quaterniond turn(double degrees, int axis) {
  return Quaterniond(AngleAxisd(degrees * std::numbers::pi / 180.0, Vector3d::Unit(axis)));
}

TEST(Acclaim, ReadsBonesRestPoseAndFrames) {
  const SkeletalMotion motion = parsed(small_asf, small_amc);
  EXPECT_EQ(motion.name, "walk");
  EXPECT_EQ(motion.frames_per_second, 120.0);
  ASSERT_EQ(motion.skeleton.size(), 4);
  EXPECT_EQ(motion.skeleton.joints[3].name, "lower_end");
  EXPECT_NO_THROW(validate(motion.skeleton));
  EXPECT_LT((motion.skeleton.joints[2].rest_position - Vector3d(3, 10, 0)).norm(), 1e-12);
  EXPECT_LT((motion.skeleton.joints[3].rest_position - Vector3d(5, 10, 0)).norm(), 1e-12);
  ASSERT_EQ(motion.frames.size(), 2U);
  EXPECT_LT((motion.frames[0].position[3] - Vector3d(6, 12, 3)).norm(), 1e-12);
  // The upper bone's own X is the world's Y at rest: it turns the arm from +X to -Z, and the root's turn
  // about Z leaves that. The lower bone turns back by the same, about the upper's Y, which the root has
  // turned to -X.
  EXPECT_LT((motion.frames[1].position[1] - Vector3d(1, 12, 3)).norm(), 1e-12);
  EXPECT_LT((motion.frames[1].position[2] - Vector3d(1, 12, 0)).norm(), 1e-12);
  EXPECT_LT((motion.frames[1].position[3] - Vector3d(1, 14, 0)).norm(), 1e-12);
}

TEST(Acclaim, TheFirstAngleTurnsFirst) {
  const auto rotation = [](const std::string& asf, const std::string& upper) {
    return parsed(asf, replaced(small_amc, "upper 90 0 0", upper)).frames[1].rotation[1];
  };
  const Quaterniond root = turn(90, 2), axis = turn(90, 2);
  const Quaterniond expected = root * axis * (turn(30, 2) * turn(20, 1) * turn(10, 0)) * axis.conjugate();
  EXPECT_LT(rotation(small_asf, "upper 10 20 30").angularDistance(expected), 1e-7);
  EXPECT_LT(rotation(replaced(small_asf, "dof rx ry rz", "dof rz ry rx"), "upper 30 20 10")
                .angularDistance(root * axis * (turn(10, 0) * turn(20, 1) * turn(30, 2)) * axis.conjugate()),
            1e-7);
}

TEST(Acclaim, DegreesAndRadiansMeanTheSame) {
  const double quarter = 0.5 * std::numbers::pi;
  std::string amc = replaced(small_amc, ":DEGREES", ":RADIANS");
  amc = replaced(replaced(amc, "0 0 90", fmt::format("0 0 {}", quarter)), "upper 90",
                 fmt::format("upper {}", quarter));
  amc = replaced(amc, "lower -90", fmt::format("lower {}", -quarter));
  const std::string asf = replaced(replaced(small_asf, "angle deg", "angle rad"), "axis 0 0 90",
                                   fmt::format("axis 0 0 {}", quarter));
  const SkeletalMotion degrees = parsed(small_asf, small_amc), radians = parsed(asf, amc);
  for (std::size_t j = 0; j < 4; ++j) {
    EXPECT_LT((degrees.frames[1].position[j] - radians.frames[1].position[j]).norm(), 1e-9);
    EXPECT_LT(degrees.frames[1].rotation[j].angularDistance(radians.frames[1].rotation[j]), 1e-7);
  }
}

// Bones keep their lengths in every frame of any rotation: the positions are those of forward kinematics.
TEST(Acclaim, PosesAreThoseOfTheirRotations) {
  const SkeletalMotion motion = parsed(small_asf, small_amc);
  for (const SkeletonPose& pose : motion.frames) {
    const SkeletonPose again = pose_from_rotations(motion.skeleton, pose.rotation, pose.position[0]);
    for (std::size_t j = 0; j < 4; ++j) EXPECT_LT((again.position[j] - pose.position[j]).norm(), 1e-12);
  }
}

std::string error_of(const std::string& asf, const std::string& amc) {
  try {
    parsed(asf, amc);
  } catch (const FileError& failure) {
    return failure.what();
  }
  return "no error";
}

TEST(AsfErrors, NameFileLineExpectedAndFound) {
  const auto error = [](const std::string& from, const std::string& to) {
    return error_of(replaced(small_asf, from, to), small_amc);
  };
  // Not such a file; empty; sections missing.
  EXPECT_THAT(error_of("solid cube\n", small_amc),
              AllOf(StartsWith("folder/body.asf:1: "), HasSubstr("is not an ASF file")));
  EXPECT_THAT(error_of("", small_amc), HasSubstr("has no ':bonedata'"));
  EXPECT_THAT(error_of(small_asf.substr(0, small_asf.find(":hierarchy")), small_amc),
              HasSubstr("is truncated: it has no ':hierarchy'"));
  // Bones: no name, twice, called root, no direction, no length, no end.
  EXPECT_THAT(error("    name lower\n", ""), HasSubstr("body.asf:27: the bone has no name"));
  EXPECT_THAT(error("name lower", "name upper"),
              HasSubstr("body.asf:27: two bones are called 'upper': the first is in line 16"));
  EXPECT_THAT(error("name lower", "name root"), HasSubstr("a bone cannot be called 'root'"));
  EXPECT_THAT(error("    direction 1 0 0\n", ""), HasSubstr("bone 'upper' has no direction"));
  EXPECT_THAT(error("    length 3\n", ""), HasSubstr("bone 'upper' has no length"));
  EXPECT_THAT(error("  end\n  begin", "  begin"), HasSubstr("expected 'end' of the bone of line 16"));
  // Values: missing, no number, not finite, huge.
  EXPECT_THAT(error("direction 1 0 0", "direction 1 0"), HasSubstr("body.asf:19: expected three numbers"));
  EXPECT_THAT(error("length 3", "length three"), HasSubstr("body.asf:20: expected a length, found 'three'"));
  for (const char* number : {"nan", "inf", "1e300"}) {
    EXPECT_THAT(error("length 3", std::string("length ") + number), HasSubstr("body.asf:20: ")) << number;
  }
  // Axes and freedoms that do not exist.
  EXPECT_THAT(error("90 XYZ", "90 XXZ"), HasSubstr("an order of axes such as XYZ, found 'XXZ'"));
  EXPECT_THAT(error("90 XYZ", "90"), HasSubstr("body.asf:21: "));
  EXPECT_THAT(error("dof rx ry rz", "dof rx tx"), HasSubstr("found 'tx'"));
  EXPECT_THAT(error("dof rx ry rz", "dof rx rx"), HasSubstr("stands twice"));
  EXPECT_THAT(error("angle deg", "angle gon"), HasSubstr("body.asf:7: expected 'angle deg' or 'angle rad'"));
  // The hierarchy: an unknown bone, two parents, a bone that hangs on nothing, a loop, the root below.
  EXPECT_THAT(error("root upper", "root uper"),
              HasSubstr("body.asf:37: there is no bone 'uper': did you mean 'upper'?"));
  EXPECT_THAT(error("upper lower", "upper lower\n upper lower"), HasSubstr("has a parent already"));
  EXPECT_THAT(error("    upper lower\n", ""),
              HasSubstr("body.asf:27: bone 'lower' does not hang on the root"));
  EXPECT_THAT(error("    root upper\n    upper lower\n", "    lower upper\n    upper lower\n"),
              HasSubstr("does not hang on the root"));
  EXPECT_THAT(error("upper lower", "upper root"), HasSubstr("the root cannot have a parent"));
  EXPECT_THAT(error("    upper lower\n  end\n", "    upper lower\n"),
              HasSubstr("expected 'end' of the hierarchy"));
}

TEST(AmcErrors, NameFileLineExpectedAndFound) {
  const auto error = [](const std::string& from, const std::string& to) {
    return error_of(small_asf, replaced(small_amc, from, to));
  };
  // Empty, or without the unit of its angles.
  EXPECT_THAT(error_of(small_asf, ""), HasSubstr("walk.amc: is truncated: expected a frame"));
  EXPECT_THAT(error(":DEGREES\n", ""), HasSubstr("walk.amc:3: expected ':DEGREES' or ':RADIANS'"));
  // A bone that the skeleton does not have, or twice in a frame, or missing.
  EXPECT_THAT(error("lower 0", "lover 0"),
              AllOf(StartsWith("folder/walk.amc:7: "),
                    HasSubstr("the skeleton has no bone 'lover': did you mean 'lower'?")));
  EXPECT_THAT(error("lower 0", "upper 0 0 0"),
              HasSubstr("walk.amc:7: bone 'upper' stands twice in the frame"));
  EXPECT_THAT(error("lower 0\n", ""), HasSubstr("walk.amc:4: frame 1 has no values of bone 'lower'"));
  EXPECT_THAT(error("lower -90\n", ""), HasSubstr("walk.amc:8: frame 2 has no values of bone 'lower'"));
  // Too few, too many, no numbers, not finite.
  EXPECT_THAT(error("upper 0 0 0", "upper 0 0"),
              HasSubstr("walk.amc:6: expected 3 values of bone 'upper', found 2"));
  EXPECT_THAT(error("upper 0 0 0", "upper 0 0 0 0"), HasSubstr("found 4"));
  for (const char* number : {"x", "nan", "inf", "1e999"}) {
    EXPECT_THAT(error("lower 0", std::string("lower ") + number), HasSubstr("walk.amc:7: expected a number"));
  }
  // Frames out of order, or with numbers that are none.
  EXPECT_THAT(error("2\nroot", "3\nroot"), HasSubstr("walk.amc:8: expected frame 2, found 3"));
  EXPECT_THAT(error("2\nroot", "1\nroot"), HasSubstr("expected frame 2, found 1"));
  EXPECT_THAT(error("1\nroot", "root"), HasSubstr("expected the number of a frame"));
  EXPECT_THAT(error("2\nroot", "99999999999\nroot"), HasSubstr("expected the number of a frame"));
  // Options that are none.
  EXPECT_THAT(
      [] { parse_amc(small_amc, "a.amc", parse_asf(small_asf, "a.asf"), {.frames_per_second = 0.0}); },
      ThrowsMessage<InvalidArgument>(HasSubstr("0 frames per second")));
  EXPECT_THAT([] { parse_amc(small_amc, "a.amc", parse_asf(small_asf, "a.asf"), {.metres_per_unit = -1.0}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("-1 metres per unit")));
}

TEST(AmcErrors, ManyBonesOnFewFreedomsAreRefused) {
  AcclaimSkeleton skeleton;
  skeleton.bones.push_back({.name = "root", .freedoms = {0}});
  for (int i = 0; i < 20; ++i) skeleton.bones.push_back({.name = std::to_string(i), .parent = 0});
  EXPECT_THAT([&] { parse_amc(":DEGREES\n1\nroot 0\n", "a.amc", skeleton); },
              ThrowsMessage<FileError>(HasSubstr("1 degrees of freedom cannot move 21 bones")));
}

std::filesystem::path cmu() {
  return test::data_folder() / "cmu";
}

SkeletalMotion read_trial(const std::string& trial) {
  return read_acclaim(cmu() / "asf" / (trial.substr(0, 2) + ".asf"), cmu() / "amc" / (trial + ".amc"));
}

TEST(AcclaimRealFiles, AllTrialsStandAsHighAsPeopleDo) {
  REPRISE_REQUIRE_DATA();
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(cmu() / "amc")) {
    ++count;
    const std::string trial = entry.path().stem().string();
    const SkeletalMotion motion = read_trial(trial);
    EXPECT_NO_THROW(validate(motion.skeleton));
    EXPECT_EQ(motion.skeleton.size(), 1 + 30 + 7) << trial;  // root, bones, ends
    const auto top = static_cast<std::size_t>(motion.skeleton.joint_idx("head_end"));
    std::vector<double> heights;
    for (const SkeletonPose& pose : motion.frames) heights.push_back(pose.position[top].y());
    std::nth_element(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2),
                     heights.end());
    const double median = heights[heights.size() / 2];
    EXPECT_GT(median, 1.45) << trial;
    EXPECT_LT(median, 1.70) << trial;
  }
  EXPECT_EQ(count, 130);
}

// Two files of one trial by different hands: the BVH was made of the AMC by another program. It has one
// T-pose before the first frame, and lacks the bone between its Spine1 and Neck, so that everything above is
// lower by that bone.
TEST(AcclaimRealFiles, AgreeWithTheSameTrialsAsBvh) {
  REPRISE_REQUIRE_DATA();
  constexpr double tolerance = 1e-4;  // metres: the BVH has 4 decimals
  const std::vector<std::array<const char*, 2>> lower = {
      {"Hips", "root"},       {"LeftUpLeg", "lfemur"},          {"LeftLeg", "ltibia"},
      {"LeftFoot", "lfoot"},  {"LeftToeBase", "ltoes"},         {"RightLeg", "rtibia"},
      {"RightFoot", "rfoot"}, {"RightToeBase", "rtoes"},        {"Spine", "upperback"},
      {"Spine1", "thorax"},   {"RightToeBase_end", "rtoes_end"}};
  const std::vector<std::array<const char*, 2>> upper = {
      {"Neck", "lowerneck"},   {"Head", "head"},       {"Head_end", "head_end"},
      {"LeftArm", "lhumerus"}, {"LeftHand", "lwrist"}, {"RightForeArm", "rradius"},
      {"RightHand", "rwrist"}};
  for (const std::string trial : {"02_01", "05_01", "07_01", "08_01", "08_07", "09_01", "09_12"}) {
    const SkeletalMotion amc = read_trial(trial);
    const SkeletalMotion bvh = read_bvh(cmu() / "bvh" / (trial + ".bvh"), {.metres_per_unit = 0.0254 / 0.45});
    ASSERT_EQ(bvh.frames.size(), amc.frames.size() + 1) << trial;
    const auto in = [](const SkeletalMotion& motion, const char* name) {
      return static_cast<std::size_t>(motion.skeleton.joint_idx(name));
    };
    const std::size_t thorax = in(amc, "thorax");
    const Vector3d missing =
        amc.skeleton.joints[in(amc, "lowerneck")].rest_position - amc.skeleton.joints[thorax].rest_position;
    double greatest = 0.0;
    for (std::size_t f = 0; f < amc.frames.size(); ++f) {
      const SkeletonPose &a = amc.frames[f], &b = bvh.frames[f + 1];
      for (const auto& [theirs, ours] : lower) {
        greatest = std::max(greatest, (b.position[in(bvh, theirs)] - a.position[in(amc, ours)]).norm());
      }
      for (const auto& [theirs, ours] : upper) {
        const Vector3d raised = b.position[in(bvh, theirs)] + a.rotation[thorax] * missing;
        greatest = std::max(greatest, (raised - a.position[in(amc, ours)]).norm());
      }
    }
    EXPECT_LT(greatest, tolerance) << trial;
  }
}

}  // namespace
}  // namespace reprise
