// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Parts of performers: the figure, and a real capture.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/database/body_parts.h"
#include "reprise/database/part_tree.h"
#include "reprise/deform/part_hierarchy.h"
#include "reprise/deform/part_hierarchy_test_support.h"
#include "reprise/io/markup_file.h"
#include "reprise/io/sequence_reader.h"
#include "reprise/skeleton/markup_proposal.h"
#include "reprise/synthetic/figure/figure.h"
#include "support/test_data.h"

namespace reprise {
namespace {

// The parts of a closed performer at one and two levels, and below a whole body.
void expect_sound_parts(const TopologyPtr& topology, const Markup& markup) {
  const test::Shape shape{.topology = topology, .positions = markup.reference};
  for (const int levels : {1, 2}) {
    const std::vector<BodyPart> bodies =
        body_parts(*topology, markup.reference, markup.skeleton, markup.joint_of_vertex, {.levels = levels});
    const PartHierarchy parts = part_test::hierarchy(shape, bodies);
    part_test::expect_laws(shape, parts);
    EXPECT_EQ(parts.parts().size(), levels == 1 ? 6U : 14U);
    EXPECT_EQ(parts.levels().size(), levels == 1 ? 2U : 4U);
    for (const PartHierarchy::Part& part : parts.parts()) {
      EXPECT_EQ(connected_components(*part.topology).count, 1) << part.name;
      EXPECT_TRUE(part.loose.empty()) << part.name;
      // Parts grow 8 cm from both sides, so that from border to border the parent gives up most of its share.
      if (part.parent < 0) continue;
      const auto share = [](const PartHierarchy::FrontierVertex& shared) { return shared.parent_share; };
      EXPECT_GT(std::ranges::max(part.frontier, {}, share).parent_share, 0.75) << part.name;
      EXPECT_LT(std::ranges::min(part.frontier, {}, share).parent_share, 0.25) << part.name;
    }
    // Weights turn over 16 cm and more: three that change by an edge's length e turn by 4 e / 0.16 at most.
    EXPECT_LT(part_test::steepest(shape, parts), 25.0);
    const int hand = parts.part_idx(levels == 1 ? "left_arm" : "left_hand");
    const std::vector<std::int32_t> fingers =
        markup.vertices_of_joint(markup.skeleton.joint_idx("left_hand"));
    std::size_t kept = 0;
    for (const std::int32_t v : fingers) kept += parts.main_part(v) == hand ? 1 : 0;
    EXPECT_GE(kept, fingers.size() * 9 / 10);

    // The tree follows from the shared vertices alone.
    const std::vector<BodyPart> derived = derive_hierarchy(bodies, 0);
    for (std::size_t p = 0; p < derived.size(); ++p) {
      EXPECT_EQ(derived[p].name, bodies[p].name);
      EXPECT_EQ(derived[p].parent, bodies[p].parent) << derived[p].name;
    }

    // The limbs below a whole body instead of a torso.
    std::vector<BodyPart> below_whole = bodies;
    below_whole[0] = whole_body_part(topology->vertex_count);
    const PartHierarchy whole = part_test::hierarchy(shape, below_whole);
    part_test::expect_laws(shape, whole);
    kept = 0;
    for (const std::int32_t v : fingers) kept += whole.main_part(v) == hand ? 1 : 0;
    EXPECT_GE(kept, fingers.size() * 9 / 10);
  }
}

TEST(PartHierarchy, OfTheFigure) {
  const PerformanceDatabase figure = make_figure({.voxel_size = 0.03});
  expect_sound_parts(figure.topology(), *figure.markup());
}

TEST(PartHierarchy, OfARealCapture) {
  REPRISE_REQUIRE_DATA();
  const auto reader = open_sequence({.path = test::data_folder() / "ama" / "crane"});
  const LandmarkFile landmarks =
      read_landmark_file(std::filesystem::path(REPRISE_SOURCE_DIR) / "tests/fixtures/ama_landmarks.json");
  ASSERT_EQ(landmarks.frame, "crane:0");
  const Mesh mesh = reader->read(0);
  expect_sound_parts(mesh.topology, propose_markup(mesh, landmarks.landmarks));
}

}  // namespace
}  // namespace reprise
