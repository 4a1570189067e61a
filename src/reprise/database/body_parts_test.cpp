// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/database/body_parts.h"

#include <algorithm>
#include <numbers>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

constexpr int around = 12;
constexpr int along = 101;  // rings, a centimetre apart

// A tube of 1 m along +Y: torso below 0.4 m, a stretch without labels up to 0.6 m, one arm above.
struct Tube {
  Tube() : positions(around * along, 3), joints(around * along) {
    topology.vertex_count = around * along;
    for (int ring = 0; ring < along; ++ring) {
      for (int k = 0; k < around; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / around;
        const int v = ring * around + k;
        positions.row(v) << static_cast<float>(0.05 * std::cos(angle)), static_cast<float>(0.01 * ring),
            static_cast<float>(0.05 * std::sin(angle));
        joints[static_cast<std::size_t>(v)] = ring < 40 ? 0 : ring < 60 ? -1 : ring < 80 ? 1 : 2;
        if (ring + 1 == along) continue;
        const int next = ring * around + (k + 1) % around;
        topology.triangles.push_back({v, v + around, next});
        topology.triangles.push_back({next, v + around, next + around});
      }
    }
    skeleton.joints = {{.name = "pelvis", .parent = -1, .rest_position = {0, 0, 0}},
                       {.name = "left_upper_arm", .parent = 0, .rest_position = {0, 0.6, 0}},
                       {.name = "left_forearm", .parent = 1, .rest_position = {0, 0.8, 0}}};
  }
  // Lowest and highest ring of a part.
  static std::pair<int, int> rings(const BodyPart& part) {
    return {part.vertices.front() / around, part.vertices.back() / around};
  }

  Topology topology;
  Positions positions;
  std::vector<std::int32_t> joints;
  Skeleton skeleton;
};

TEST(BodyParts, FormATreeBelowTheTorsoAndHoldEveryVertex) {
  const Tube tube;
  const auto parts = body_parts(tube.topology, tube.positions, tube.skeleton, tube.joints);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].name, "torso");
  EXPECT_EQ(parts[0].parent, -1);
  EXPECT_EQ(parts[1].name, "left_arm");
  EXPECT_EQ(parts[1].parent, 0);
  std::set<std::int32_t> all;
  for (const BodyPart& part : parts) {
    EXPECT_TRUE(std::is_sorted(part.vertices.begin(), part.vertices.end()));
    all.insert(part.vertices.begin(), part.vertices.end());
  }
  EXPECT_EQ(static_cast<int>(all.size()), tube.topology.vertex_count);
}

TEST(BodyParts, OverlapIsLargerWhereTheSurfaceIsFree) {
  const Tube tube;
  // The border lies in the middle of the free stretch, at ring 50: 10 rings of it on either side.
  const BodyPartOptions options{.overlap = 0.05, .free_overlap = 0.05};
  const auto even = body_parts(tube.topology, tube.positions, tube.skeleton, tube.joints, options);
  EXPECT_NEAR(Tube::rings(even[0]).second, 54, 1);
  EXPECT_NEAR(Tube::rings(even[1]).first, 45, 1);
  const auto wide = body_parts(tube.topology, tube.positions, tube.skeleton, tube.joints,
                               {.overlap = 0.05, .free_overlap = 0.20});
  // A quarter of the overlap is spent on 10 free rings, the rest beyond them.
  EXPECT_GE(Tube::rings(wide[0]).second, 60);
  EXPECT_LE(Tube::rings(wide[1]).first, 39);
}

TEST(BodyParts, BadLabelsAreRefused) {
  Tube tube;
  tube.joints[5] = 3;
  EXPECT_THAT([&] { body_parts(tube.topology, tube.positions, tube.skeleton, tube.joints); },
              ::testing::ThrowsMessage<InvalidArgument>(::testing::HasSubstr("vertex 5")));
  std::fill(tube.joints.begin(), tube.joints.end(), -1);
  EXPECT_THROW(body_parts(tube.topology, tube.positions, tube.skeleton, tube.joints), InvalidArgument);
  tube.joints.pop_back();
  EXPECT_THROW(body_parts(tube.topology, tube.positions, tube.skeleton, tube.joints), InvalidArgument);
}

}  // namespace
}  // namespace reprise
