// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/sequence/mesh_sequence.h"

#include <algorithm>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const TopologyPtr triangle =
    std::make_shared<const Topology>(Topology{.vertex_count = 3, .triangles = {{0, 1, 2}}});

TEST(MeshSequence, HoldsFramesOneAfterTheOther) {
  MeshSequence clip("clip", triangle, 2, 50.0);
  EXPECT_THAT(clip.data(), Each(0.0F));
  clip.frame(1).row(2) << 1, 2, 3;
  EXPECT_THAT(std::vector<float>(clip.data().end() - 3, clip.data().end()), ElementsAre(1, 2, 3));
  EXPECT_EQ(std::as_const(clip).frame(1), clip.frame(1));
  EXPECT_EQ(clip.frame(0).rows(), 3);
  EXPECT_EQ(clip.data().size(), 2U * 3U * 3U);
  EXPECT_DOUBLE_EQ(clip.duration(), 0.04);
}

TEST(MeshSequence, RefusesWhatIsNoSequence) {
  // No topology.
  EXPECT_THAT([] { MeshSequence("clip", nullptr, 1, 25.0); },
              ThrowsMessage<InvalidArgument>(HasSubstr("'clip' has no topology")));
  // A rate that is not a positive number.
  for (const double rate :
       {0.0, -25.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT([=] { MeshSequence("clip", triangle, 1, rate); },
                ThrowsMessage<InvalidArgument>(HasSubstr("expected a positive, finite rate")));
  }
}

TEST(MeshSequence, RefusesAFrameBeyondTheLast) {
  MeshSequence clip("clip", triangle, 2, 25.0);
  const auto message = ThrowsMessage<InvalidArgument>("sequence 'clip' has frames 0 to 1, asked for 2");
  EXPECT_THAT([&] { clip.frame(2); }, message);
  EXPECT_THAT([&] { std::as_const(clip).frame(2); }, message);
  EXPECT_THAT([&] { clip.mutable_normals(2); }, message);
  EXPECT_THAT([&] { clip.mesh(2); }, message);
  EXPECT_THAT([] { MeshSequence("clip", triangle, 0, 25.0).frame(0); },
              ThrowsMessage<InvalidArgument>(HasSubstr("has no frames")));
  EXPECT_THROW(MeshSequence().frame(0), InvalidArgument);
}

TEST(MeshSequence, SharesATopologyOfTheSameVertexCountOnly) {
  MeshSequence clip("clip", triangle, 1, 25.0);
  const auto equal = std::make_shared<const Topology>(*triangle);
  clip.share_topology(equal);
  EXPECT_EQ(clip.topology(), equal);
  EXPECT_THAT([&] { clip.share_topology(test::sheet(1).topology); },
              ThrowsMessage<InvalidArgument>(AllOf(HasSubstr("3 vertices"), HasSubstr("of 4"))));
  EXPECT_THROW(clip.share_topology(nullptr), InvalidArgument);
  EXPECT_THROW(MeshSequence().share_topology(triangle), InvalidArgument);
  EXPECT_EQ(clip.topology(), equal);
}

TEST(MeshSequence, NormalsAreNoneOrOfEveryFrame) {
  MeshSequence clip("clip", triangle, 2, 25.0);
  EXPECT_FALSE(clip.has_normals());
  EXPECT_THAT([&] { clip.normals(0); }, ThrowsMessage<InvalidArgument>(HasSubstr("no normals")));
  clip.mutable_normals(1).rowwise() = Eigen::RowVector3f(0, 1, 0);
  EXPECT_TRUE(clip.has_normals());
  EXPECT_EQ(clip.normals(0), Positions::Zero(3, 3));
  EXPECT_EQ(clip.normals(1).row(2), Eigen::RowVector3f(0, 1, 0));
}

TEST(MeshSequence, ColorsAreNoneOneSetOrOneSetAFrame) {
  MeshSequence clip("clip", triangle, 2, 25.0);
  EXPECT_FALSE(clip.has_colors());
  EXPECT_THAT([&] { clip.colors(0); }, ThrowsMessage<InvalidArgument>(HasSubstr("no colours")));
  std::vector<Color> colors(6);
  for (std::uint8_t i = 0; i < 6; ++i) colors[i] = {i, i, i};

  clip.set_colors({colors.begin(), colors.begin() + 3});
  EXPECT_FALSE(clip.has_colors_per_frame());
  for (const std::size_t f : {0U, 1U})
    EXPECT_THAT(clip.colors(f), ElementsAre(colors[0], colors[1], colors[2]));

  clip.set_colors(colors);
  EXPECT_TRUE(clip.has_colors_per_frame());
  EXPECT_THAT(clip.colors(1), ElementsAre(colors[3], colors[4], colors[5]));
  EXPECT_THROW(clip.colors(2), InvalidArgument);

  EXPECT_THAT([&] { clip.set_colors(std::vector<Color>(4)); },
              ThrowsMessage<InvalidArgument>(HasSubstr("4 colours for 3 vertices and 2 frames")));
  clip.set_colors({});
  EXPECT_FALSE(clip.has_colors());
}

TEST(MeshSequence, OriginsAreNoneOrOneAFrame) {
  MeshSequence clip("clip", triangle, 2, 25.0);
  const FrameOrigin captured{.clip = "walk", .frame_idx = 4};
  const FrameOrigin blended{
      .clip = "walk", .frame_idx = 5, .partner_clip = "run", .partner_frame_idx = 0, .partner_weight = 0.5};
  EXPECT_FALSE(captured.is_blend());
  EXPECT_TRUE(blended.is_blend());
  clip.set_origins({captured, blended});
  EXPECT_THAT(clip.origins(), ElementsAre(captured, blended));
  EXPECT_THAT([&] { clip.set_origins({captured}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("1 origins for 2 frames")));
  clip.set_origins({});
  EXPECT_TRUE(clip.origins().empty());
}

TEST(MeshSequence, MeshIsACopyOfOneFrameWithAllThatIsKnownOfIt) {
  MeshSequence clip("clip", triangle, 2, 25.0);
  clip.frame(1).setConstant(2.0F);
  const Mesh bare = clip.mesh(1);
  EXPECT_EQ(bare.topology, triangle);
  EXPECT_EQ(bare.positions, Positions::Constant(3, 3, 2.0F));
  EXPECT_EQ(bare.normals.rows(), 0);
  EXPECT_TRUE(bare.colors.empty());

  clip.mutable_normals(1).setConstant(1.0F);
  clip.set_colors({{1, 1, 1}, {2, 2, 2}, {3, 3, 3}});
  const Mesh full = clip.mesh(1);
  clip.frame(1).setZero();
  EXPECT_EQ(full.positions, Positions::Constant(3, 3, 2.0F));
  EXPECT_EQ(full.normals, Positions::Constant(3, 3, 1.0F));
  EXPECT_EQ(full.colors[2], (Color{3, 3, 3}));
}

TEST(Centroid, MovesWithTheShape) {
  const MeshSequence clip = test::walk("walk", 3);
  const GroundTransform transform{.yaw = 0.7, .translation = {2.0, -3.0}};
  const MeshSequence elsewhere = test::moved(clip, transform, "elsewhere");
  EXPECT_LT((centroid(elsewhere.frame(1)) - transform * centroid(std::as_const(clip).frame(1))).norm(), 1e-6);
}

TEST(GroundTrajectory, MovesWithTheClipAndKeepsItsLength) {
  const MeshSequence clip = test::walk("walk", 20);
  const GroundTransform transform{.yaw = -2.0, .translation = {1.0, 4.0}};
  const auto here = ground_trajectory(clip);
  const auto there = ground_trajectory(test::moved(clip, transform, "elsewhere"));
  ASSERT_EQ(here.size(), 20U);
  for (std::size_t f = 0; f < here.size(); ++f) EXPECT_LT((there[f] - transform * here[f]).norm(), 1e-6);
  EXPECT_NEAR(ground_distance(here, 3, 17), ground_distance(there, 3, 17), 1e-5);
}

TEST(GroundTrajectory, DoesNotSeeTheHeight) {
  MeshSequence clip = test::walk("walk", 5);
  const auto before = ground_trajectory(clip);
  for (std::size_t f = 0; f < clip.frame_count(); ++f) clip.frame(f).col(1).array() += 10.0F;
  EXPECT_EQ(ground_trajectory(clip), before);
}

TEST(GroundDistance, IsTheLengthOfThePathAndAdds) {
  const std::vector<Eigen::Vector2d> trajectory = {{0, 0}, {3, 4}, {3, 4}, {0, 0}, {0, 1}};
  EXPECT_DOUBLE_EQ(ground_distance(trajectory, 0, 4), 11.0);
  EXPECT_DOUBLE_EQ(ground_distance(trajectory, 1, 1), 0.0);
  for (std::size_t middle = 0; middle < trajectory.size(); ++middle) {
    EXPECT_DOUBLE_EQ(ground_distance(trajectory, 0, middle) + ground_distance(trajectory, middle, 4), 11.0);
  }
  // A frame beyond the last.
  EXPECT_THAT([&] { ground_distance(trajectory, 0, 5); },
              ThrowsMessage<InvalidArgument>(HasSubstr("of 5 frames")));
  // Backwards.
  EXPECT_THROW(ground_distance(trajectory, 3, 2), InvalidArgument);
}

TEST(TransformPositions, AgreesWithTheTransformOfEachPointAlsoInPlace) {
  const MeshSequence clip = test::walk("walk", 1);
  const GroundTransform transform{.yaw = 1.2, .translation = {-0.5, 0.25}};
  MeshSequence out_of_place("out", clip.topology(), 1, 25.0);
  transform_positions(transform, clip.frame(0), out_of_place.frame(0));
  for (Eigen::Index v = 0; v < clip.frame(0).rows(); ++v) {
    const Eigen::Vector3d p = clip.frame(0).row(v).transpose().cast<double>();
    EXPECT_LT((out_of_place.frame(0).row(v).transpose().cast<double>() - transform * p).norm(), 1e-6);
  }
  MeshSequence in_place = clip;
  transform_positions(transform, std::as_const(in_place).frame(0), in_place.frame(0));
  EXPECT_EQ(in_place.data(), out_of_place.data());

  MeshSequence other_shape("other", triangle, 1, 25.0);
  EXPECT_THROW(transform_positions(transform, clip.frame(0), other_shape.frame(0)), InvalidArgument);
}

}  // namespace
}  // namespace reprise
