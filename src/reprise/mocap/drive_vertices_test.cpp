// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mocap/drive_vertices.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/synthetic/figure/figure.h"

namespace reprise {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

// The built-in figure, made once; its left shin has a shell of cloth that slides, its head no label.
const PerformanceDatabase& dressed_figure() {
  static const PerformanceDatabase dressed = [] {
    const PerformanceDatabase figure = make_figure({.voxel_size = 0.05});
    Markup markup = *figure.markup();
    std::ranges::replace(markup.joint_of_vertex, markup.skeleton.joint_idx("head"), -1);
    const std::vector<std::int32_t> shin = markup.vertices_of_joint(markup.skeleton.joint_idx("left_shin"));
    PerformanceDatabase database;
    for (const MeshSequence& clip : figure.clips()) {
      MeshSequence copy = clip;
      for (std::size_t f = 0; f < clip.frame_count(); ++f) {
        PositionsRef frame = copy.frame(f);
        for (std::size_t i = 0; i < shin.size(); i += 4) {
          frame(shin[i], 0) += 0.04F * std::sin(static_cast<float>(f));
        }
      }
      database.add(std::move(copy));
    }
    database.set_markup(markup);
    return database;
  }();
  return dressed;
}

const SkeletonFollower& follower() {
  static const SkeletonFollower follower(dressed_figure().clips(), *dressed_figure().markup());
  return follower;
}

const Markup& markup() {
  return *dressed_figure().markup();
}

double residual(const DriveVertex& vertex) {
  return follower().residuals()[static_cast<std::size_t>(vertex.vertex)];
}

std::map<int, std::vector<DriveVertex>> by_joint(const std::vector<DriveVertex>& vertices) {
  std::map<int, std::vector<DriveVertex>> sorted;
  for (const DriveVertex& vertex : vertices) sorted[vertex.joint].push_back(vertex);
  return sorted;
}

TEST(DriveVertices, EachFollowedBoneHasItsMostRigidVertices) {
  const DriveVertexOptions options{.per_bone = 8};
  const std::vector<DriveVertex> chosen = choose_drive_vertices(dressed_figure(), follower(), options);
  EXPECT_TRUE(std::ranges::is_sorted(chosen, {}, &DriveVertex::vertex));
  EXPECT_EQ(std::ranges::adjacent_find(chosen, {}, &DriveVertex::vertex), chosen.end()) << "one twice";
  const auto bones = by_joint(chosen);
  const std::vector<bool> followed = followed_bones(*dressed_figure().topology(), markup());
  for (int joint = 0; joint < markup().skeleton.size(); ++joint) {
    const std::string& name = markup().skeleton.joints[static_cast<std::size_t>(joint)].name;
    ASSERT_EQ(bones.contains(joint), followed[static_cast<std::size_t>(joint)]) << name;
    if (!bones.contains(joint)) continue;
    const std::vector<std::int32_t> labelled = markup().vertices_of_joint(joint);
    EXPECT_EQ(bones.at(joint).size(), std::min<std::size_t>(8, labelled.size())) << name;
    std::vector<double> residuals;
    for (const std::int32_t v : labelled) residuals.push_back(residual({.vertex = v}));
    std::ranges::sort(residuals);
    const double limit = residuals[std::max<std::size_t>(8, (residuals.size() + 1) / 2) - 1];
    const bool is_foot = name.ends_with("_foot") || name.ends_with("_toe");
    for (const DriveVertex& vertex : bones.at(joint)) {
      EXPECT_EQ(markup().joint_of_vertex[static_cast<std::size_t>(vertex.vertex)], joint);
      EXPECT_LE(residual(vertex), limit) << name;
      EXPECT_EQ(vertex.weight, is_foot ? options.foot_weight : 1.0) << name;
    }
  }
}

TEST(DriveVertices, LooseOnesAreClothAndUnlabelledAndWeighLittle) {
  const auto chosen_with = [](int loose) {
    return by_joint(
        choose_drive_vertices(dressed_figure(), follower(), {.loose = loose, .loose_weight = 0.2}));
  };
  EXPECT_FALSE(chosen_with(0).contains(-1));
  EXPECT_EQ(chosen_with(12).at(-1).size(), 12U);
  const auto all = chosen_with(100000);
  const int shin = markup().skeleton.joint_idx("left_shin");
  int on_head = 0;
  int on_cloth = 0;
  for (const DriveVertex& vertex : all.at(-1)) {
    EXPECT_EQ(vertex.weight, 0.2);
    EXPECT_GT(residual(vertex), 0.006);
    on_head += std::isinf(residual(vertex)) ? 1 : 0;
    on_cloth += markup().joint_of_vertex[static_cast<std::size_t>(vertex.vertex)] == shin ? 1 : 0;
  }
  EXPECT_GT(on_head, 0);
  EXPECT_GT(on_cloth, 0);
  // None of the sliding ones stands for the bone.
  for (const DriveVertex& vertex : all.at(shin)) EXPECT_LT(residual(vertex), 0.006);
}

TEST(DriveVertices, AreSpreadOverTheirBone) {
  // No vertex that could be chosen lies farther from the chosen ones than these lie from each other.
  const std::vector<DriveVertex> chosen =
      choose_drive_vertices(dressed_figure(), follower(), {.per_bone = 10, .rigid_share = 1.0, .loose = 0});
  const auto distance = [](std::int32_t a, std::int32_t b) {
    return (markup().reference.row(a) - markup().reference.row(b)).norm();
  };
  for (const auto& [joint, vertices] : by_joint(chosen)) {
    float apart = std::numeric_limits<float>::infinity();
    for (const DriveVertex& a : vertices) {
      for (const DriveVertex& b : vertices) {
        if (a.vertex != b.vertex) apart = std::min(apart, distance(a.vertex, b.vertex));
      }
    }
    for (const std::int32_t v : markup().vertices_of_joint(joint)) {
      float nearest = std::numeric_limits<float>::infinity();
      for (const DriveVertex& a : vertices) nearest = std::min(nearest, distance(v, a.vertex));
      EXPECT_LE(nearest, apart * 1.0001F);
    }
  }
}

TEST(DriveVertices, OptionsOutOfRangeAndDatabasesWithoutMarkupAreRefused) {
  const auto refuses = [](const DriveVertexOptions& options, const char* what) {
    EXPECT_THAT([&] { (void)choose_drive_vertices(dressed_figure(), follower(), options); },
                ThrowsMessage<InvalidArgument>(HasSubstr(what)));
  };
  refuses({.per_bone = 0}, "per_bone: expected 1 or more, found 0");
  refuses({.rigid_share = 0.0}, "rigid_share");
  refuses({.rigid_share = 1.1}, "rigid_share");
  refuses({.foot_weight = 0.0}, "foot_weight");
  refuses({.loose = -1}, "loose");
  refuses({.loose_weight = std::numeric_limits<double>::quiet_NaN()}, "loose_weight");
  PerformanceDatabase bare;
  bare.add(dressed_figure().clip(0));
  EXPECT_THAT([&] { (void)choose_drive_vertices(bare, follower()); },
              ThrowsMessage<InvalidArgument>(HasSubstr("no markup")));
}

class DriveVertexFile : public testing::Test {
 protected:
  DriveVertexFile() { std::filesystem::create_directories(folder_); }
  ~DriveVertexFile() override { std::filesystem::remove_all(folder_); }

  std::vector<DriveVertex> read(const std::string& vertices) const {
    write_text_file(file_,
                    R"({"format": "reprise drive vertices", "version": 1, "vertices": )" + vertices + "}");
    return read_drive_vertices(file_, dressed_figure());
  }
  void refuses(const std::string& vertices, const char* place, const char* what) const {
    EXPECT_THAT([&] { (void)read(vertices); },
                ThrowsMessage<FileError>(testing::AllOf(HasSubstr(place), HasSubstr(what))));
  }

  std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("drive_vertices_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  std::filesystem::path file_ = folder_ / "drive.json";
};

TEST_F(DriveVertexFile, GivesBackWhatWasWritten) {
  std::vector<DriveVertex> chosen = choose_drive_vertices(dressed_figure(), follower());
  chosen.front().weight = 0.1 + 0.2;  // not a short decimal number
  write_drive_vertices(chosen, markup().skeleton, file_);
  const std::vector<DriveVertex> found = read_drive_vertices(file_, dressed_figure());
  ASSERT_EQ(found.size(), chosen.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].vertex, chosen[i].vertex);
    EXPECT_EQ(found[i].joint, chosen[i].joint);
    EXPECT_EQ(found[i].weight, chosen[i].weight);
  }
}

TEST_F(DriveVertexFile, JointAndWeightMayBeLeftOut) {
  const std::vector<DriveVertex> found = read(R"([{"vertex": 9}, {"vertex": 3, "joint": "left_shin"}])");
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].vertex, 3);
  EXPECT_EQ(found[0].joint, markup().skeleton.joint_idx("left_shin"));
  EXPECT_EQ(found[1].joint, -1);
  EXPECT_EQ(found[1].weight, 1.0);
}

TEST_F(DriveVertexFile, SaysWhichEntryIsWrong) {
  const std::string count = std::to_string(dressed_figure().topology()->vertex_count);
  refuses(R"([{"vertex": 1}, {"vertex": )" + count + "}]", "vertices[1].vertex",
          "expected an integer from 0");
  refuses(R"([{"vertex": -1}])", "vertices[0].vertex", "expected an integer from 0");
  refuses(R"([{"vertex": 4}, {"vertex": 4}])", "vertices[1].vertex", "twice");
  refuses(R"([{"vertex": 4, "joint": "left_shim"}])", "vertices[0].joint", "left_shin");
  refuses(R"([{"vertex": 4, "weight": 0}])", "vertices[0].weight", "expected a positive number");
  refuses(R"([{"vertex": 4, "weight": "much"}])", "vertices[0].weight", "expected");
  refuses(R"([{"joint": "head"}])", "vertices[0].vertex", "expected this field");
  refuses("[]", "vertices", "found none");
  refuses("7", "vertices", "expected a list");
  EXPECT_THROW((void)read("["), FileError);
  write_text_file(file_, R"({"format": "reprise drive vertices", "version": 2, "vertices": []})");
  EXPECT_THAT([&] { (void)read_drive_vertices(file_, dressed_figure()); },
              ThrowsMessage<FileError>(HasSubstr("version 2")));
  write_text_file(file_, R"({"format": "reprise markup", "version": 1})");
  EXPECT_THAT([&] { (void)read_drive_vertices(file_, dressed_figure()); },
              ThrowsMessage<FileError>(HasSubstr("is not a list of drive vertices")));
}

}  // namespace
}  // namespace reprise
