// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/motion/retarget.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/io/acclaim.h"
#include "reprise/io/bvh.h"
#include "reprise/retarget/foot_shape.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// A woman of 1.6 m in an A-pose, soles at y = 0.
Skeleton performer() {
  Skeleton skeleton;
  const auto add = [&](const std::string& name, const std::string& parent, const Vector3d& position) {
    skeleton.joints.push_back({name, parent.empty() ? -1 : skeleton.joint_idx(parent), position});
  };
  add("pelvis", "", {0, 0.835, -0.063});
  add("spine", "pelvis", {0, 0.906, -0.022});
  add("chest", "spine", {0, 1.060, 0.012});
  add("neck", "chest", {0, 1.358, -0.001});
  add("head", "neck", {0, 1.470, 0.041});
  for (const double sign : {1.0, -1.0}) {
    const std::string side = sign > 0.0 ? "left_" : "right_";
    const auto limb = [&](const std::string& name, const std::string& parent, Vector3d position) {
      position.x() *= sign;
      add(side + name, parent, position);
    };
    limb("collar", "chest", {0.023, 1.290, 0.021});
    limb("upper_arm", side + "collar", {0.155, 1.275, 0.021});
    limb("forearm", side + "upper_arm", {0.313, 1.102, 0.025});
    limb("hand", side + "forearm", {0.424, 0.981, 0.161});
    limb("thigh", "pelvis", {0.0955, 0.822, 0.017});
    limb("shin", side + "thigh", {0.135, 0.450, 0.048});
    limb("foot", side + "shin", {0.166, 0.069, 0.030});
    limb("toe", side + "foot", {0.1435, 0.026, 0.155});
  }
  return skeleton;
}

std::size_t joint(const Skeleton& skeleton, const std::string& name) {
  return static_cast<std::size_t>(skeleton.joint_idx(name));
}

const std::string& side_name(std::size_t side) {
  static const std::array<std::string, 2> names = {"left_", "right_"};
  return names[side];
}

// Arms that swing and a body that turns, standing on the spot.
SkeletalMotion waving(const Skeleton& skeleton, std::size_t frame_count, double frames_per_second) {
  SkeletalMotion motion{"waving", skeleton, frames_per_second, {}};
  for (std::size_t f = 0; f < frame_count; ++f) {
    const double t = static_cast<double>(f) / frames_per_second;
    SkeletonPose pose = rest_pose(skeleton);
    std::vector<Quaterniond> rotations = pose.rotation;
    const Quaterniond chest(AngleAxisd(0.3 * std::sin(2.0 * t), Vector3d::UnitY()));
    for (const char* name : {"chest", "neck", "head", "left_collar", "right_collar"}) {
      rotations[joint(skeleton, name)] = chest;
    }
    for (std::size_t side = 0; side < 2; ++side) {
      const Quaterniond arm =
          chest * AngleAxisd(std::sin(3.0 * t + static_cast<double>(side)), Vector3d::UnitX());
      const Quaterniond forearm = arm * AngleAxisd(-0.4 - 0.3 * std::sin(4.0 * t), Vector3d::UnitX());
      rotations[joint(skeleton, side_name(side) + "upper_arm")] = arm;
      rotations[joint(skeleton, side_name(side) + "forearm")] = forearm;
      rotations[joint(skeleton, side_name(side) + "hand")] = forearm;
    }
    motion.frames.push_back(pose_from_rotations(skeleton, rotations, pose.position[0]));
  }
  return motion;
}

// Horizontal speed of the point on which each foot stands, greatest over all frames in contact, m/s. A
// foot stands on its heel or on the joint of its toes, whichever is stiller.
double foot_drift(const PerformerClip& clip) {
  const Skeleton& skeleton = clip.motion.skeleton;
  double greatest = 0.0;
  for (std::size_t f = static_cast<std::size_t>(clip.lead_in); f + 1 < clip.motion.frames.size(); ++f) {
    for (std::size_t side = 0; side < 2; ++side) {
      if (!clip.contacts[f][side] || !clip.contacts[f + 1][side]) continue;
      const retargeting::FootShape shape = retargeting::foot_shape(skeleton, static_cast<int>(side));
      const auto moved = [&](const std::string& name, const Vector3d& point) {
        const int j = skeleton.joint_idx(side_name(side) + name);
        Vector3d way = clip.motion.frames[f + 1].world_from_rest(skeleton, j) * point -
                       clip.motion.frames[f].world_from_rest(skeleton, j) * point;
        way.y() = 0.0;
        return way.norm() * clip.motion.frames_per_second;
      };
      // A foot that rolls from its heel to its ball between two frames stands on neither throughout.
      const auto toes_up = [&](std::size_t frame) {
        const auto j = static_cast<std::size_t>(skeleton.joint_idx(side_name(side) + "foot"));
        return (clip.motion.frames[frame].rotation[j] * Vector3d::UnitZ()).y();
      };
      if (toes_up(f) > 0.0 && toes_up(f + 1) < 0.0) continue;
      greatest = std::max(greatest, std::min(moved("foot", shape.heel), moved("toe", shape.ball)));
    }
  }
  return greatest;
}

// Lowest point of heels and toe tips in the clip.
double lowest_sole(const PerformerClip& clip) {
  const Skeleton& skeleton = clip.motion.skeleton;
  double lowest = 1.0;
  for (std::size_t f = static_cast<std::size_t>(clip.lead_in); f < clip.motion.frames.size(); ++f) {
    for (std::size_t side = 0; side < 2; ++side) {
      const retargeting::FootShape shape = retargeting::foot_shape(skeleton, static_cast<int>(side));
      const SkeletonPose& pose = clip.motion.frames[f];
      const int foot = skeleton.joint_idx(side_name(side) + "foot"),
                toe = skeleton.joint_idx(side_name(side) + "toe");
      lowest = std::min({lowest, (pose.world_from_rest(skeleton, foot) * shape.heel).y(),
                         (pose.world_from_rest(skeleton, toe) * shape.toe_tip).y()});
    }
  }
  return lowest;
}

// Degrees by which a knee bends: forward is positive.
double knee_bend(const Skeleton& skeleton, const SkeletonPose& pose, std::size_t side) {
  const auto at = [&](const char* name) { return pose.position[joint(skeleton, side_name(side) + name)]; };
  const Vector3d thigh = at("shin") - at("thigh"), shin = at("foot") - at("shin");
  const Vector3d hinge = pose.rotation[joint(skeleton, side_name(side) + "thigh")] * Vector3d::UnitX();
  return std::atan2(thigh.cross(shin).dot(hinge), thigh.dot(shin)) * 180.0 / std::numbers::pi;
}

double greatest_distance(const SkeletonPose& a, const SkeletonPose& b) {
  double greatest = 0.0;
  for (std::size_t j = 0; j < a.position.size(); ++j) {
    greatest = std::max(
        {greatest, (a.position[j] - b.position[j]).norm(), a.rotation[j].angularDistance(b.rotation[j])});
  }
  return greatest;
}

TEST(Retarget, OntoTheSameSkeletonNothingChanges) {
  const SkeletalMotion motion = waving(performer(), 60, 25.0);
  const PerformerClip clip = retarget(motion, performer(), {.plant_feet = false});
  EXPECT_EQ(clip.motion.name, "waving");
  EXPECT_EQ(clip.lead_in, 38);
  ASSERT_EQ(clip.motion.frames.size(), 38U + 60U);
  ASSERT_EQ(clip.contacts.size(), clip.motion.frames.size());
  // But for the place: the pelvis stands over the origin.
  for (std::size_t f = 0; f < 60; ++f) {
    SkeletonPose expected = motion.frames[f];
    for (Vector3d& position : expected.position) position.z() += 0.063;
    EXPECT_LT(greatest_distance(clip.motion.frames[38 + f], expected), 1e-6) << f;
  }
  // A body that stands is in contact all the time, and planting leaves it where it is.
  const PerformerClip planted = retarget(motion, performer());
  for (std::size_t f = 0; f < planted.motion.frames.size(); ++f) {
    EXPECT_THAT(planted.contacts[f], ::testing::ElementsAre(true, true)) << f;
  }
  for (std::size_t f = 0; f < 60; ++f) {
    for (const char* name : {"head", "left_hand", "left_foot", "right_toe"}) {
      const std::size_t j = joint(performer(), name);
      EXPECT_LT((planted.motion.frames[38 + f].position[j] - clip.motion.frames[38 + f].position[j]).norm(),
                0.012)
          << name << " " << f;
    }
  }
}

SkeletalMotion moved(const SkeletalMotion& motion, const Quaterniond& turn, double scale,
                     const Vector3d& shift) {
  SkeletalMotion result = motion;
  for (Joint& joint : result.skeleton.joints) joint.rest_position *= scale;
  for (SkeletonPose& pose : result.frames) {
    for (Vector3d& position : pose.position) position = turn * (scale * position) + shift;
    for (Quaterniond& rotation : pose.rotation) rotation = turn * rotation;
  }
  return result;
}

// Where a motion was captured, on what scale, and which axis is up, does not show in the result.
TEST(Retarget, PlaceHeadingScaleAndUpAxisDoNotMatter) {
  const SkeletalMotion motion = waving(performer(), 30, 25.0);
  const PerformerClip expected = retarget(motion, performer());
  const auto expect_same = [&](const SkeletalMotion& other) {
    const PerformerClip clip = retarget(other, performer());
    ASSERT_EQ(clip.motion.frames.size(), expected.motion.frames.size());
    EXPECT_EQ(clip.contacts, expected.contacts);
    for (std::size_t f = 0; f < clip.motion.frames.size(); ++f) {
      EXPECT_LT(greatest_distance(clip.motion.frames[f], expected.motion.frames[f]), 1e-6) << f;
    }
  };
  expect_same(moved(motion, Quaterniond(AngleAxisd(2.0, Vector3d::UnitY())), 1.0, {3.0, 0.7, -5.0}));
  expect_same(moved(motion, Quaterniond::Identity(), 5.5, Vector3d::Zero()));
  // Z up, in the rest pose too.
  SkeletalMotion z_up = waving(performer(), 30, 25.0);
  const Quaterniond up(AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitX()));
  for (Joint& j : z_up.skeleton.joints) j.rest_position = up * j.rest_position;
  for (SkeletonPose& pose : z_up.frames) {
    for (Vector3d& position : pose.position) position = up * position;
    for (Quaterniond& rotation : pose.rotation) rotation = up * rotation * up.conjugate();
  }
  expect_same(z_up);
}

// The same body at rest with its arms level: a pose that looks the same has other rotations.
TEST(Retarget, BonesAreMatchedByDirectionNotByRotation) {
  const Skeleton own = performer();
  // Rest pose T: upper arms and forearms along X.
  Skeleton t_pose = own;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto at = [&](const char* name) -> Vector3d& {
      return t_pose.joints[joint(t_pose, side_name(side) + name)].rest_position;
    };
    const Vector3d along = side == 0 ? Vector3d::UnitX() : Vector3d(-Vector3d::UnitX());
    const double upper = (at("forearm") - at("upper_arm")).norm(),
                 lower = (at("hand") - at("forearm")).norm();
    at("forearm") = at("upper_arm") + upper * along;
    at("hand") = at("forearm") + lower * along;
  }
  SkeletalMotion motion{"t", t_pose, 25.0, {rest_pose(t_pose), rest_pose(t_pose)}};
  const PerformerClip clip = retarget(motion, own, {.plant_feet = false});
  const SkeletonPose& pose = clip.motion.frames.back();
  for (std::size_t side = 0; side < 2; ++side) {
    const auto at = [&](const char* name) { return pose.position[joint(own, side_name(side) + name)]; };
    const Vector3d along = side == 0 ? Vector3d::UnitX() : Vector3d(-Vector3d::UnitX());
    EXPECT_GT((at("forearm") - at("upper_arm")).normalized().dot(along), 1.0 - 1e-9);
    EXPECT_GT((at("hand") - at("forearm")).normalized().dot(along), 1.0 - 1e-9);
  }
  // Trunk, legs and feet, which rest alike, do not move.
  for (const char* name : {"pelvis", "chest", "head", "left_thigh", "right_shin", "left_foot", "right_toe"}) {
    EXPECT_LT(pose.rotation[joint(own, name)].angularDistance(Quaterniond::Identity()), 1e-6) << name;
  }
}

TEST(Retarget, AJointMapMayBeGiven) {
  SkeletalMotion motion = waving(performer(), 10, 25.0);
  std::map<std::string, std::string> map;
  for (std::size_t j = 0; j < motion.skeleton.joints.size(); ++j) {
    map[motion.skeleton.joints[j].name] = fmt::format("bone {}", j);
    motion.skeleton.joints[j].name = fmt::format("bone {}", j);
  }
  const PerformerClip expected = retarget(waving(performer(), 10, 25.0), performer());
  const PerformerClip clip = retarget(motion, performer(), {.joint_map = JointMap{.joints = map}});
  for (std::size_t f = 0; f < clip.motion.frames.size(); ++f) {
    EXPECT_LT(greatest_distance(clip.motion.frames[f], expected.motion.frames[f]), 1e-12);
  }
  // Nothing can be found in these names.
  EXPECT_THAT([&] { retarget(motion, performer()); },
              ThrowsMessage<InvalidArgument>(
                  AllOf(HasSubstr("motion 'waving': no joint map fits"), HasSubstr("bone 0, bone 1"))));
}

// What a motion lacks between joints that it has follows them.
TEST(Retarget, OptionalJointsMayBeMissing) {
  const SkeletalMotion motion = waving(performer(), 10, 25.0);
  std::map<std::string, std::string> map;
  for (const Joint& j : motion.skeleton.joints) {
    if (j.name != "spine" && j.name != "neck" && !j.name.ends_with("toe") && !j.name.ends_with("collar")) {
      map[j.name] = j.name;
    }
  }
  const PerformerClip clip =
      retarget(motion, performer(), {.joint_map = JointMap{.joints = map}, .plant_feet = false});
  const PerformerClip whole = retarget(motion, performer(), {.plant_feet = false});
  for (const char* name : {"chest", "head", "left_hand", "right_foot", "left_toe", "right_collar"}) {
    const std::size_t j = joint(performer(), name);
    EXPECT_LT(clip.motion.frames.back().rotation[j].angularDistance(whole.motion.frames.back().rotation[j]),
              1e-6)
        << name;
  }
}

TEST(Retarget, RefusesWhatIsNoMotion) {
  SkeletalMotion motion = waving(performer(), 10, 25.0);
  for (const double rate : {0.0, -25.0, 1e9, std::nan("")}) {
    EXPECT_THAT([&] { retarget(motion, performer(), {.frames_per_second = rate}); },
                ThrowsMessage<InvalidArgument>(HasSubstr("cannot retarget to")));
  }
  EXPECT_THAT(
      [&] {
        retarget({"none", performer(), 25.0, {}}, performer());
      },
      ThrowsMessage<InvalidArgument>(HasSubstr("'none' has no frames")));
  motion.frames[3].position[2].x() = std::nan("");
  EXPECT_THAT([&] { retarget(motion, performer()); }, ThrowsMessage<InvalidArgument>(HasSubstr("frame 3")));
  // Legs of no length.
  motion = waving(performer(), 10, 25.0);
  for (Joint& j : motion.skeleton.joints) j.rest_position.setZero();
  EXPECT_THAT([&] { retarget(motion, performer()); },
              ThrowsMessage<InvalidArgument>(HasSubstr("check the joint map")));
}

struct Trial {
  const char* name;
  double least_contact, greatest_contact;  // share of the time that a foot stands
};

// Walks and runs of the real data, as ASF/AMC and as two kinds of BVH.
TEST(RetargetRealMotions, FeetStandStillOnTheGroundAndKneesBendForward) {
  REPRISE_REQUIRE_DATA();
  const std::filesystem::path cmu = test::data_folder() / "cmu";
  const std::vector<Trial> trials = {
      {"amc/07_01.amc", 0.45, 0.7},  {"amc/08_01.amc", 0.45, 0.7}, {"amc/08_07.amc", 0.4, 0.7},
      {"amc/16_35.amc", 0.2, 0.45},  {"amc/09_01.amc", 0.2, 0.45}, {"amc/09_10.amc", 0.2, 0.45},
      {"amc/29_01.amc", 0.6, 0.9},   {"bvh/07_01.bvh", 0.45, 0.7}, {"bvh/07_12.bvh", 0.4, 0.7},
      {"bvh/35_17.bvh", 0.17, 0.45}, {"bvh/39_12.bvh", 0.45, 0.7}};
  const Skeleton own = performer();
  for (const Trial& trial : trials) {
    SCOPED_TRACE(trial.name);
    const std::filesystem::path file = cmu / trial.name;
    const SkeletalMotion motion =
        file.extension() == ".bvh"
            ? read_bvh(file)
            : read_acclaim(cmu / "asf" / (file.stem().string().substr(0, 2) + ".asf"), file);
    const PerformerClip clip = retarget(motion, own);
    EXPECT_LT(foot_drift(clip), 0.005);
    EXPECT_GT(lowest_sole(clip), -1e-4);
    EXPECT_LT(lowest_sole(clip), 1e-3);
    double contact = 0.0;
    for (std::size_t f = static_cast<std::size_t>(clip.lead_in); f < clip.motion.frames.size(); ++f) {
      const SkeletonPose& pose = clip.motion.frames[f];
      EXPECT_LT(greatest_distance(pose, pose_from_rotations(own, pose.rotation, pose.position[0])), 1e-9);
      for (std::size_t side = 0; side < 2; ++side) {
        contact += clip.contacts[f][side] ? 0.5 : 0.0;
        const double bend = knee_bend(own, pose, side);
        EXPECT_GT(bend, 0.0) << f;
        EXPECT_LT(bend, 140.0) << f;
        if (f + 1 < clip.motion.frames.size()) {
          EXPECT_LT(std::abs(knee_bend(own, clip.motion.frames[f + 1], side) - bend), 45.0) << f;
        }
      }
    }
    contact /= static_cast<double>(clip.motion.frames.size() - static_cast<std::size_t>(clip.lead_in));
    EXPECT_GT(contact, trial.least_contact);
    EXPECT_LT(contact, trial.greatest_contact);
    // At the origin, along +Z, and the lead-in arrives without a jump.
    const SkeletonPose& first = clip.motion.frames[static_cast<std::size_t>(clip.lead_in)];
    const SkeletonPose& before = clip.motion.frames[static_cast<std::size_t>(clip.lead_in) - 1];
    EXPECT_LT(std::hypot(first.position[0].x(), first.position[0].z()), 1e-9);
    EXPECT_GT((first.rotation[0] * Vector3d::UnitZ()).z(), 0.9);
    const SkeletonPose& after = clip.motion.frames[static_cast<std::size_t>(clip.lead_in) + 1];
    const auto way = [](const SkeletonPose& a, const SkeletonPose& b) {
      double greatest = 0.0;
      for (std::size_t j = 0; j < a.position.size(); ++j) {
        greatest = std::max(greatest, (a.position[j] - b.position[j]).norm());
      }
      return greatest;
    };
    EXPECT_LT(way(before, first), 1.3 * way(first, after) + 0.03);
  }
}

// One performance by two ways into the program: ASF/AMC, and the BVH that another program made of it.
TEST(RetargetRealMotions, AmcAndBvhOfOneTrialGiveOnePerformance) {
  REPRISE_REQUIRE_DATA();
  const std::filesystem::path cmu = test::data_folder() / "cmu";
  const Skeleton own = performer();
  const PerformerClip amc = retarget(read_acclaim(cmu / "asf" / "07.asf", cmu / "amc" / "07_01.amc"), own);
  const PerformerClip bvh = retarget(read_bvh(cmu / "bvh" / "07_01.bvh"), own);
  ASSERT_EQ(amc.motion.frames.size(), bvh.motion.frames.size());
  for (std::size_t f = static_cast<std::size_t>(amc.lead_in); f < amc.motion.frames.size(); ++f) {
    for (const char* name : {"pelvis", "chest", "head", "left_forearm", "right_foot", "left_toe"}) {
      const std::size_t j = joint(own, name);
      EXPECT_LT((amc.motion.frames[f].position[j] - bvh.motion.frames[f].position[j]).norm(), 0.002)
          << name << " " << f;
    }
  }
}

// The performer's own motion, written as BVH, is read back as the same motion.
TEST(RetargetRealMotions, APerformanceSurvivesBvh) {
  REPRISE_REQUIRE_DATA();
  const std::filesystem::path cmu = test::data_folder() / "cmu";
  const Skeleton own = performer();
  PerformerClip clip = retarget(read_acclaim(cmu / "asf" / "16.asf", cmu / "amc" / "16_15.amc"), own);
  clip.motion.frames.erase(clip.motion.frames.begin(), clip.motion.frames.begin() + clip.lead_in);
  const PerformerClip again =
      retarget(parse_bvh(format_bvh(clip.motion), "again.bvh"), own, {.plant_feet = false});
  for (std::size_t f = 0; f < clip.motion.frames.size(); ++f) {
    const SkeletonPose& pose = again.motion.frames[static_cast<std::size_t>(again.lead_in) + f];
    for (std::size_t j = 0; j < own.joints.size(); ++j) {
      EXPECT_LT(pose.rotation[j].angularDistance(clip.motion.frames[f].rotation[j]), 1e-5)
          << own.joints[j].name;
      Vector3d way = pose.position[j] - clip.motion.frames[f].position[j];
      EXPECT_LT(std::hypot(way.x(), way.z()), 1e-4) << own.joints[j].name;
    }
  }
}

}  // namespace
}  // namespace reprise
