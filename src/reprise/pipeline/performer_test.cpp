// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The three built-in costumes, held to what docs/performer.md says of them.

#include "reprise/synthetic/performer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/skeleton/skeleton_extraction.h"
#include "reprise/synthetic/body/makehuman.h"
#include "support/promises.h"
#include "support/test_data.h"

namespace reprise {
namespace {

struct Expected {
  std::string costume;
  std::size_t clips = 0;
  std::size_t frames = 0;
  std::string from, to;
};

void PrintTo(const Expected& expected, std::ostream* stream) {
  *stream << expected.costume;
}

class Costumes : public ::testing::TestWithParam<Expected> {};

// Edges of the surface, each once, with the number of triangles on it.
std::map<std::pair<int, int>, int> edges_of(const Topology& topology) {
  std::map<std::pair<int, int>, int> edges;
  for (const Triangle& t : topology.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      ++edges[{low, high}];
    }
  }
  return edges;
}

void expect_closed_even_surface(const Topology& topology, const Positions& rest) {
  EXPECT_NEAR(topology.vertex_count, 2500, 75);
  EXPECT_EQ(connected_components(topology).count, 1);
  const auto edges = edges_of(topology);
  std::vector<double> lengths;
  for (const auto& [edge, triangles] : edges) {
    EXPECT_EQ(triangles, 2) << "edge " << edge.first << " " << edge.second;
    lengths.push_back((rest.row(edge.first) - rest.row(edge.second)).norm());
  }
  const auto faces = static_cast<int>(topology.triangles.size());
  EXPECT_EQ(topology.vertex_count - static_cast<int>(edges.size()) + faces, 2) << "no handles";
  const double mean =
      std::accumulate(lengths.begin(), lengths.end(), 0.0) / static_cast<double>(lengths.size());
  double variance = 0.0;
  for (const double length : lengths)
    variance += (length - mean) * (length - mean) / static_cast<double>(lengths.size());
  EXPECT_LT(std::sqrt(variance) / mean, 0.35);
}

// Mean horizontal speed in cm/s of the part of a sole that stands, while its foot is on the ground in two
// frames running, and the deepest and highest of the lowest vertex of a standing foot, metres.
struct Footing {
  double drift = 0.0;
  double lowest = 0.0;
  double highest = 0.0;
};

Footing footing(const PerformanceDatabase& database) {
  const Markup& markup = *database.markup();
  Footing result;
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t side = 0; side < 2; ++side) {
    std::vector<std::int32_t> sole;
    for (const char* joint : {"foot", "toe"}) {
      const auto vertices = markup.vertices_of_joint(
          markup.skeleton.joint_idx((side == 0 ? "left_" : "right_") + std::string(joint)));
      sole.insert(sole.end(), vertices.begin(), vertices.end());
    }
    for (std::size_t c = 0; c < database.clips().size(); ++c) {
      const MeshSequence& clip = database.clip(c);
      const ClipTruth& truth = *database.truth(c);
      // In a twirl the foot turns about a point between vertices; the tests of the motion itself measure
      // that.
      if (clip.name().find("twirl") != std::string::npos) continue;
      for (std::size_t f = 0; f + 1 < clip.frame_count(); ++f) {
        if (!truth.contacts[f][side] || !truth.contacts[f + 1][side]) continue;
        const PositionsView now = clip.frame(f);
        const PositionsView next = clip.frame(f + 1);
        // What stands is what is lowest in both frames.
        const auto height = [&](std::int32_t v) { return std::max(now(v, 1), next(v, 1)); };
        const auto lowest = *std::min_element(sole.begin(), sole.end(),
                                              [&](auto a, auto b) { return height(a) < height(b); });
        result.lowest = std::min<double>(result.lowest, now(lowest, 1));
        result.highest = std::max<double>(result.highest, now(lowest, 1));
        // A foot that rolls or pivots stands on a part of its sole: the stillest of what touches the ground.
        double moved = std::numeric_limits<double>::infinity();
        for (const std::int32_t v : sole) {
          if (height(v) > height(lowest) + 0.01F) continue;
          moved = std::min<double>(moved, std::hypot(next(v, 0) - now(v, 0), next(v, 2) - now(v, 2)));
        }
        sum += 100.0 * moved * clip.frames_per_second();
        count += 1.0;
      }
    }
  }
  result.drift = sum / count;
  return result;
}

TEST_P(Costumes, PerformAsThePaperDescribesTheirDatabase) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const Expected& expected = GetParam();
  const PerformanceDatabase database = make_performer({.costume = expected.costume});
  EXPECT_EQ(database.clips().size(), expected.clips);
  EXPECT_EQ(database.frame_count(), expected.frames);
  ASSERT_TRUE(database.markup());
  const Markup& markup = *database.markup();
  const Topology& topology = *database.topology();
  ASSERT_TRUE(topology.texture);
  expect_closed_even_surface(topology, markup.reference);
  EXPECT_EQ(markup.parts.size(), 6U);

  const Footing feet = footing(database);
  EXPECT_LT(feet.drift, 0.5);
  EXPECT_GT(feet.lowest, -0.01);
  EXPECT_LT(feet.highest, 0.02);
  RecordProperty("foot_drift_cm_s", std::to_string(feet.drift));

  double distance = 0.0;
  double angle = 0.0;
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    const PoseDifference difference =
        pose_difference(extract_skeleton(database.clip(c), markup), database.truth(c)->poses);
    const double share =
        static_cast<double>(database.clip(c).frame_count()) / static_cast<double>(database.frame_count());
    distance += share * difference.distance;
    angle += share * difference.angle;
  }
  EXPECT_LT(distance, 0.02);
  EXPECT_LT(angle, 5.0 * 3.14159265 / 180.0);
  RecordProperty("joint_distance_mm", std::to_string(1e3 * distance));
  RecordProperty("joint_angle_degrees", std::to_string(angle * 180.0 / 3.14159265));

  const auto result =
      run_keyframes(database, test::graph_of(database),
                    {.keyframes = {expected.from, expected.to}, .distance = 10.0, .time = 8.0});
  ASSERT_TRUE(result.has_value());
  // A walk shows more of the skirt in folds than the whole database, which also stands and poses.
  const Naturalness natural = test::expect_kept_promises(*result, database, 1.25);
  RecordProperty("pop_ratio", std::to_string(natural.pop_ratio));
  RecordProperty("synthesised_foot_drift_cm_s", std::to_string(natural.foot_drift));
  EXPECT_EQ(result->animation.topology(), database.topology()) << "the texture goes along";
}

INSTANTIATE_TEST_SUITE_P(BuiltIn, Costumes,
                         ::testing::Values(Expected{"character1", 10, 442, "stand:1", "hit:45"},
                                           Expected{"fashion1", 6, 491, "walk:15", "walk_pose:37"},
                                           Expected{"fashion2", 6, 435, "walk:15", "walk_pose:37"}),
                         [](const auto& expected) { return expected.param.costume; });

}  // namespace
}  // namespace reprise
