// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/retarget/joint_map.h"

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/io/bvh.h"
#include "reprise/retarget/retarget_test_support.h"

namespace reprise {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::ThrowsMessage;

// The woman's joints under other names: body joint -> name. Joints without a name are left out, and what
// hangs on them hangs on their parents.
Skeleton renamed(const std::map<std::string, std::string>& names) {
  const Skeleton body = test::standing_woman();
  Skeleton result;
  std::vector<int> now(body.joints.size(), -1);
  for (std::size_t j = 0; j < body.joints.size(); ++j) {
    const Joint& joint = body.joints[j];
    const int parent = joint.parent < 0 ? -1 : now[static_cast<std::size_t>(joint.parent)];
    const auto name = names.find(joint.name);
    if (name == names.end()) {
      now[j] = parent;
      continue;
    }
    now[j] = result.size();
    result.joints.push_back({name->second, parent, joint.rest_position});
  }
  return result;
}

std::map<std::string, std::string> both_sides(const std::vector<std::array<std::string, 2>>& rows,
                                              const std::array<std::string, 2>& sides) {
  std::map<std::string, std::string> names;
  for (const auto& [body, theirs] : rows) {
    for (std::size_t side = 0; side < 2; ++side) {
      std::string own = body, name = theirs;
      if (const std::size_t star = name.find('*'); star != std::string::npos) {
        own = test::side_name(side) + body;
        name.replace(star, 1, sides[side]);
      }
      names[own] = name;
    }
  }
  return names;
}

TEST(JointMap, BodyJointsAreInOrderAndParentsFirst) {
  std::vector<std::string> names;
  for (const Joint& joint : test::standing_woman().joints) names.push_back(joint.name);
  EXPECT_EQ(body_joints(), names);
  for (const std::string& joint : required_body_joints()) EXPECT_THAT(body_joints(), Contains(joint));
}

// Names as programs write them, each found in a table.
TEST(JointMap, NamesOfProgramsAreKnown) {
  struct Names {
    std::string table;
    std::array<std::string, 2> sides;
    std::vector<std::array<std::string, 2>> rows;
  };
  const std::vector<Names> all = {{"Mixamo and MotionBuilder",
                                   {"Left", "Right"},
                                   {{"pelvis", "mixamorig:Hips"},
                                    {"spine", "mixamorig:Spine"},
                                    {"chest", "mixamorig:Spine2"},
                                    {"neck", "mixamorig:Neck"},
                                    {"head", "mixamorig:Head"},
                                    {"collar", "mixamorig:*Shoulder"},
                                    {"upper_arm", "mixamorig:*Arm"},
                                    {"forearm", "mixamorig:*ForeArm"},
                                    {"hand", "mixamorig:*Hand"},
                                    {"thigh", "mixamorig:*UpLeg"},
                                    {"shin", "mixamorig:*Leg"},
                                    {"foot", "mixamorig:*Foot"},
                                    {"toe", "mixamorig:*ToeBase"}}},
                                  {"Blender (Rigify)",
                                   {".L", ".R"},
                                   {{"pelvis", "DEF-spine"},
                                    {"spine", "DEF-spine.001"},
                                    {"chest", "DEF-spine.003"},
                                    {"neck", "DEF-spine.004"},
                                    {"head", "DEF-spine.006"},
                                    {"collar", "DEF-shoulder*"},
                                    {"upper_arm", "DEF-upper_arm*"},
                                    {"forearm", "DEF-forearm*"},
                                    {"hand", "DEF-hand*"},
                                    {"thigh", "DEF-thigh*"},
                                    {"shin", "DEF-shin*"},
                                    {"foot", "DEF-foot*"},
                                    {"toe", "DEF-toe*"}}},
                                  {"Unreal",
                                   {"_l", "_r"},
                                   {{"pelvis", "pelvis"},
                                    {"spine", "spine_01"},
                                    {"chest", "spine_03"},
                                    {"neck", "neck_01"},
                                    {"head", "head"},
                                    {"collar", "clavicle*"},
                                    {"upper_arm", "upperarm*"},
                                    {"forearm", "lowerarm*"},
                                    {"hand", "hand*"},
                                    {"thigh", "thigh*"},
                                    {"shin", "calf*"},
                                    {"foot", "foot*"},
                                    {"toe", "ball*"}}},
                                  {"Biovision",
                                   {"Left", "Right"},
                                   {{"pelvis", "Hips"},
                                    {"spine", "Chest"},
                                    {"chest", "Chest2"},
                                    {"neck", "Neck"},
                                    {"head", "Head"},
                                    {"collar", "*Collar"},
                                    {"upper_arm", "*Shoulder"},
                                    {"forearm", "*Elbow"},
                                    {"hand", "*Wrist"},
                                    {"thigh", "*Hip"},
                                    {"shin", "*Knee"},
                                    {"foot", "*Ankle"},
                                    {"toe", "*Toe"}}}};
  for (const Names& names : all) {
    SCOPED_TRACE(names.table);
    const std::map<std::string, std::string> expected = both_sides(names.rows, names.sides);
    const JointMap map = find_joints(renamed(expected), "it");
    EXPECT_EQ(map.name, names.table);
    EXPECT_EQ(map.joints, expected);
    EXPECT_THAT(map.missing, IsEmpty());
    EXPECT_THAT(map.unused, IsEmpty());
  }
  EXPECT_EQ(find_joints(test::standing_woman(), "it").name, "the performer's own names");
}

// Names of no table: words, sides and the tree say what they are. A shoulder is an upper arm where a collar
// lies above it, and a collar where an upper arm lies below.
TEST(JointMap, OtherNamesAreGuessed) {
  struct Style {
    std::array<std::string, 2> sides;
    std::vector<std::array<std::string, 2>> rows;
  };
  const std::vector<Style> styles = {{{"Left", "Right"},
                                      {{"pelvis", "Root"},
                                       {"spine", "Abdomen"},
                                       {"chest", "Thorax"},
                                       {"neck", "Cervical"},
                                       {"head", "Skull_Head"},
                                       {"collar", "*Scapula"},
                                       {"upper_arm", "*Humerus"},
                                       {"forearm", "*Radius"},
                                       {"hand", "*Wrist"},
                                       {"thigh", "*Femur"},
                                       {"shin", "*Tibia"},
                                       {"foot", "*Ankle"},
                                       {"toe", "*Toes"}}},
                                     {{"l", "r"},
                                      {{"pelvis", "Body"},
                                       {"spine", "Back"},
                                       {"chest", "UpperBack"},
                                       {"head", "Head"},
                                       {"collar", "*shoulder"},
                                       {"upper_arm", "*upperarm"},
                                       {"forearm", "*lowerarm"},
                                       {"thigh", "*upperleg"},
                                       {"shin", "*lowerleg"},
                                       {"foot", "*foot"}}},
                                     {{"_R_wrong", "_L_wrong"},  // the sides are what the names say
                                      {{"pelvis", "j0"},
                                       {"chest", "j2"},
                                       {"head", "head"},
                                       {"collar", "collarbone*"},
                                       {"upper_arm", "shoulder*"},
                                       {"forearm", "elbow*"},
                                       {"hand", "hand*"},
                                       {"thigh", "hip*"},
                                       {"shin", "knee*"},
                                       {"foot", "foot*"},
                                       {"toe", "ball*"}}}};
  for (const Style& style : styles) {
    SCOPED_TRACE(style.rows.back()[1]);
    std::map<std::string, std::string> expected = both_sides(style.rows, style.sides);
    const JointMap map = find_joints(renamed(expected), "it");
    EXPECT_EQ(map.name, "guessed from the names");
    if (style.sides[0] == "_R_wrong") {
      const std::map<std::string, std::string> given = expected;
      for (const auto& [body, theirs] : given) {
        if (body.starts_with("left_"))
          std::swap(expected["left_" + body.substr(5)], expected["right_" + body.substr(5)]);
      }
    }
    EXPECT_EQ(map.joints, expected);
  }
}

TEST(JointMap, TooFewJointsAreAnErrorThatListsThem) {
  const auto names = both_sides(
      {{"pelvis", "Hips"}, {"thigh", "*UpLeg"}, {"shin", "*Leg"}, {"foot", "*Foot"}}, {"Left", "Right"});
  EXPECT_THAT([&] { find_joints(renamed(names), "motion 'legs'"); },
              ThrowsMessage<InvalidArgument>(AllOf(HasSubstr("motion 'legs': no joint map fits"),
                                                   HasSubstr("left_upper_arm"), HasSubstr("head or chest"),
                                                   HasSubstr("Hips, LeftUpLeg"))));
}

TEST(JointMap, MapsOfTheUser) {
  const JointMap map =
      parse_joint_map(R"({"joints": {"left_thigh": "LThigh", "head": "Top"}})", "dir/my.json");
  EXPECT_EQ(map.name, "my.json");
  EXPECT_THAT(map.joints, ElementsAre(Pair("head", "Top"), Pair("left_thigh", "LThigh")));
  EXPECT_EQ(parse_joint_map(R"({"name": "mine", "joints": {}})", "my.json").name, "mine");
}

TEST(JointMapErrors, OfFiles) {
  const auto error = [](const std::string& text) -> std::string {
    try {
      parse_joint_map(text, "my.json");
    } catch (const FileError& failure) {
      return failure.what();
    }
    return "no error";
  };
  EXPECT_THAT(error("{"), HasSubstr("is not JSON"));
  EXPECT_THAT(error("222e22222"), HasSubstr("is not JSON"));  // beyond what a number may be
  EXPECT_THAT(error("[]"), HasSubstr("expected {\"joints\""));
  EXPECT_THAT(error(R"({"joints": 1})"), HasSubstr("expected {\"joints\""));
  EXPECT_THAT(error(R"({"joints": {}, "joint": {}})"), HasSubstr("'joint' is not known"));
  EXPECT_THAT(error(R"({"joints": {}, "name": 3})"), HasSubstr("'name': expected a text"));
  EXPECT_THAT(error(R"({"joints": {"left_thihg": "a"}})"), HasSubstr("did you mean 'left_thigh'?"));
  EXPECT_THAT(error(R"({"joints": {"head": 3}})"), HasSubstr("'head': expected the name of a joint"));
  EXPECT_THAT([] { read_joint_map("no such file.json"); },
              ThrowsMessage<FileError>(HasSubstr("no such file")));
}

TEST(JointMapErrors, OfMapsThatDoNotFit) {
  const Skeleton body = test::standing_woman();
  JointMap good{"mine", {}, {}, {}};
  for (const Joint& joint : body.joints) good.joints[joint.name] = joint.name;
  const auto error = [&](const std::string& own, const std::string& theirs) -> std::string {
    JointMap map = good;
    if (theirs.empty()) {
      map.joints.erase(own);
    } else {
      map.joints[own] = theirs;
    }
    try {
      checked(map, body, "motion 'walk'");
    } catch (const InvalidArgument& failure) {
      return failure.what();
    }
    return "no error";
  };
  EXPECT_EQ(error("left_toe", ""), "no error");
  EXPECT_THAT(error("head", "haed"), AllOf(HasSubstr("'mine' gives 'haed' for 'head'"),
                                           HasSubstr("motion 'walk'"), HasSubstr("did you mean 'head'?")));
  EXPECT_THAT(error("left_shin", ""), HasSubstr("has no entry for left_shin"));
  EXPECT_THAT(error("tail", "head"), HasSubstr("'tail', which is no body joint"));
  EXPECT_THAT(error("left_hand", "right_hand"), HasSubstr("for both 'left_hand' and 'right_hand'"));
  // Head or chest may be missing, but not both.
  good.joints.erase("chest");
  EXPECT_EQ(error("left_toe", ""), "no error");
  EXPECT_THAT(error("head", ""), HasSubstr("head or chest"));
}

TEST(JointMap, WhatIsMissingAndWhatIsNotUsedIsSaid) {
  Skeleton body = test::standing_woman();
  body.joints.push_back({"hat", body.joint_idx("head"), {0, 1.7, 0}});
  body.joints.push_back({"left_toe_end", body.joint_idx("left_toe"), {0.14, 0.02, 0.2}});
  body.joints[test::joint(body, "neck")].name = "throat";
  const JointMap map = find_joints(body, "it");
  EXPECT_THAT(map.missing, ElementsAre("neck"));
  EXPECT_THAT(map.unused, ElementsAre("throat", "hat"));
  EXPECT_EQ(to_string(map),
            "20 of 21 body joints, the performer's own names; missing: neck; not used: throat, hat");
}

// The corpus: AMC, and two kinds of BVH.
TEST(JointMapRealFiles, EverySkeletonIsKnown) {
  REPRISE_REQUIRE_DATA();
  const std::filesystem::path bvh = test::data_folder() / "cmu" / "bvh";
  const JointMap amc = find_joints(test::cmu_trial("07_01").skeleton, "07_01");
  EXPECT_EQ(amc.name, "CMU (ASF/AMC)");
  EXPECT_THAT(amc.missing, IsEmpty());
  const JointMap cmu = find_joints(read_bvh(bvh / "07_12.bvh").skeleton, "07_12");
  EXPECT_EQ(cmu.name, "CMU (BVH)");
  EXPECT_THAT(cmu.missing, IsEmpty());
  const JointMap daz = find_joints(read_bvh(bvh / "35_17.bvh").skeleton, "35_17");
  EXPECT_EQ(daz.name, "Daz (cgspeed BVH)");
  EXPECT_THAT(daz.joints, Contains(Pair("left_toe", "lFoot_end")));
}

}  // namespace
}  // namespace reprise
