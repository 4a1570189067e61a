// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/render/skeleton_surface.h"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

SkeletalMotion arm() {
  Skeleton skeleton{.joints = {{.name = "Hips", .parent = -1, .rest_position = {0.0, 1.0, 0.0}},
                               {.name = "LeftArm", .parent = 0, .rest_position = {0.2, 1.4, 0.0}},
                               {.name = "LeftHand", .parent = 1, .rest_position = {0.7, 1.4, 0.0}},
                               {.name = "rfemur", .parent = 0, .rest_position = {-0.1, 0.5, 0.05}}}};
  SkeletalMotion motion{.name = "arm", .skeleton = skeleton, .frames_per_second = 25.0};
  for (int f = 0; f < 3; ++f) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.4 * f, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()));
    motion.frames.push_back(pose_from_rotations(skeleton, {turn, turn, turn, turn}, {0.1 * f, 1.0, 0.3 * f}));
  }
  return motion;
}

double volume(const Topology& topology, const PositionsView& frame) {
  double sum = 0.0;
  for (const auto& [a, b, c] : topology.triangles) {
    const Eigen::RowVector3d x = frame.row(a).cast<double>();
    sum += x.dot(Eigen::RowVector3d(frame.row(b).cast<double>())
                     .cross(Eigen::RowVector3d(frame.row(c).cast<double>()))) /
           6.0;
  }
  return sum;
}

bool has_point(const PositionsView& frame, const Eigen::Vector3d& point) {
  return (frame.cast<double>().rowwise() - point.transpose()).rowwise().norm().minCoeff() < 1e-6;
}

TEST(SkeletonSurface, PiecesAreClosedAndSeenFromOutside) {
  const MeshSequence surface = skeleton_surface(arm());
  std::map<std::pair<std::int32_t, std::int32_t>, int> directed;
  for (const auto& [a, b, c] : surface.topology()->triangles) {
    ++directed[{a, b}];
    ++directed[{b, c}];
    ++directed[{c, a}];
  }
  for (const auto& [edge, count] : directed) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(directed.contains({edge.second, edge.first}));
  }
  for (std::size_t f = 0; f < surface.frame_count(); ++f) {
    const PositionsView frame = std::as_const(surface).frame(f);
    // Every piece by itself: pieces of the wrong side would hide in a sum.
    const ConnectedComponents pieces = connected_components(*surface.topology());
    for (std::int32_t p = 0; p < pieces.count; ++p) {
      Topology piece = *surface.topology();
      std::erase_if(piece.triangles, [&](const Triangle& triangle) {
        return pieces.of_vertex[static_cast<std::size_t>(triangle[0])] != p;
      });
      EXPECT_GT(volume(piece, frame), 1e-7);
    }
  }
}

TEST(SkeletonSurface, TouchesEveryJointAndMovesWithTheBones) {
  const SkeletalMotion motion = arm();
  const MeshSequence surface = skeleton_surface(motion);
  ASSERT_EQ(surface.frame_count(), 3U);
  const PositionsView first = std::as_const(surface).frame(0);
  for (std::size_t f = 0; f < 3; ++f) {
    const PositionsView frame = std::as_const(surface).frame(f);
    for (const int joint : {0, 1})
      EXPECT_TRUE(has_point(frame, motion.frames[f].position[static_cast<std::size_t>(joint)]));
    EXPECT_TRUE(has_point(frame, motion.frames[f].position[2]));
    // The whole arm turns as one: distances within a bone stay.
    for (const Eigen::Index v : {1, 2, 4}) {
      EXPECT_NEAR((frame.row(0) - frame.row(v)).norm(), (first.row(0) - first.row(v)).norm(), 1e-5);
    }
  }
}

TEST(SkeletonSurface, ColoursTellLeftFromRight) {
  const SkeletonSurfaceOptions options;
  const MeshSequence surface = skeleton_surface(arm());
  const auto colors = surface.colors(0);
  const auto count = [&](const Color& color) { return std::ranges::count(colors, color); };
  EXPECT_EQ(count(options.left), 3 * 6);   // two bones and the end of the hand
  EXPECT_EQ(count(options.right), 2 * 6);  // the thigh and its end
  EXPECT_EQ(colors.size(), 5U * 6U);
}

TEST(SkeletonSurface, NothingToDrawIsRefused) {
  EXPECT_THROW(skeleton_surface({}), InvalidArgument);
  SkeletalMotion still = arm();
  still.frames.clear();
  EXPECT_THROW(skeleton_surface(still), InvalidArgument);
}

}  // namespace
}  // namespace reprise
