// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/ground_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/synthesis/feet_test_support.h"
#include "reprise/synthesis/leg_weights.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

// Do all vertices follow bones of that side?
bool all_follow(const PerformanceDatabase& database, const std::vector<std::int32_t>& vertices,
                const std::string& side) {
  const Markup& markup = *database.markup();
  return std::ranges::all_of(vertices, [&](std::int32_t v) {
    const std::int32_t joint = markup.joint_of_vertex[static_cast<std::size_t>(v)];
    return joint >= 0 && markup.skeleton.joints[static_cast<std::size_t>(joint)].name.starts_with(side);
  });
}

// A copy in which some vertices of a clip lie on the ground in its first frames.
PerformanceDatabase with_floored(const PerformanceDatabase& database,
                                 const std::vector<std::int32_t>& vertices, std::size_t frames) {
  PerformanceDatabase copy;
  for (const MeshSequence& clip : database.clips()) {
    MeshSequence changed = clip;
    if (copy.empty()) {
      for (std::size_t f = 0; f < frames; ++f) {
        for (const std::int32_t v : vertices) changed.frame(f).row(v) = clip.frame(0).row(v);
        for (const std::int32_t v : vertices) changed.frame(f)(v, 1) = 0.01F;
      }
    }
    copy.add(std::move(changed));
  }
  return copy;
}

TEST(GroundContactsTest, FeetAreTheTwoFeet) {
  const PerformanceDatabase& database = test::performer_with_feet();
  const GroundContacts contacts(database);
  ASSERT_THAT(contacts.feet(), SizeIs(2));
  EXPECT_NE(all_follow(database, contacts.feet()[0], "left_"),
            all_follow(database, contacts.feet()[1], "left_"));
  EXPECT_NE(all_follow(database, contacts.feet()[0], "right_"),
            all_follow(database, contacts.feet()[1], "right_"));
  for (const auto& foot : contacts.feet()) EXPECT_TRUE(std::ranges::is_sorted(foot));
}

TEST(GroundContactsTest, WholeSolesThatLieStillAreInContact) {
  const PerformanceDatabase& database = test::performer_with_feet();
  const GroundContacts contacts(database);
  const std::size_t left = all_follow(database, contacts.feet()[0], "left_") ? 0 : 1;
  std::size_t stands = 0;
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    const ClipTruth& truth = *database.truth(c);
    for (std::size_t f = 0; f + 1 < truth.contacts.size(); ++f) {
      for (const std::size_t side : {0U, 1U}) {
        if (!truth.contacts[f][side] || !truth.contacts[f + 1][side]) continue;
        ++stands;
        const auto& foot = contacts.feet()[side == 0 ? left : 1 - left];
        EXPECT_TRUE(std::ranges::any_of(contacts.touching(c, f), [&](std::int32_t v) {
          return std::ranges::binary_search(foot, v);
        })) << database.to_string({c, f});
      }
    }
  }
  EXPECT_GT(stands, 300U);
}

TEST(GroundContactsTest, VerticesThatAreHighOrFastAreNotInContact) {
  const PerformanceDatabase& database = test::performer_with_feet();
  const ContactOptions options{.height = 0.02, .speed = 0.2};
  const GroundContacts contacts(database, options);
  const std::size_t walk = database.clip_idx("walk");
  const MeshSequence& clip = database.clip(walk);
  for (std::size_t f = 0; f + 1 < clip.frame_count(); ++f) {
    const PositionsView now = clip.frame(f);
    const PositionsView next = clip.frame(f + 1);
    std::vector<std::int32_t> expected;
    for (std::int32_t v = 0; v < static_cast<std::int32_t>(now.rows()); ++v) {
      const double highest =
          static_cast<double>(std::max(now(v, 1), next(v, 1))) - contacts.ground_height(walk);
      const double dx = static_cast<double>(next(v, 0)) - static_cast<double>(now(v, 0));
      const double dz = static_cast<double>(next(v, 2)) - static_cast<double>(now(v, 2));
      if (highest <= options.height && std::sqrt(dx * dx + dz * dz) * 25.0 <= options.speed)
        expected.push_back(v);
    }
    EXPECT_EQ(contacts.touching(walk, f), expected) << "frame " << f;
  }
  EXPECT_TRUE(contacts.touching(walk, clip.frame_count() - 1).empty())
      << "nothing comes after the last frame";
}

TEST(GroundContactsTest, HandOnTheFloorIsNoFoot) {
  const PerformanceDatabase& database = test::performer_with_feet();
  const Markup& markup = *database.markup();
  const auto hand = markup.vertices_of_joint(*markup.skeleton.find("left_hand"));
  ASSERT_FALSE(hand.empty());
  // Long enough to have more contacts than a foot has.
  const GroundContacts contacts(with_floored(database, hand, 50));
  EXPECT_TRUE(std::ranges::includes(contacts.touching(0, 10), hand)) << "the test needs it on the floor";
  EXPECT_EQ(contacts.feet(), GroundContacts(database).feet());
}

TEST(GroundContactsTest, ClothThatBrushesTheFloorIsNoFoot) {
  const PerformanceDatabase& database = test::performer_with_feet();
  const GroundContacts plain(database);
  std::vector<std::int32_t> shin;
  for (std::size_t v = 0; v < plain.mean_heights().size(); ++v) {
    if (plain.mean_heights()[v] > 0.3 && plain.mean_heights()[v] < 0.36)
      shin.push_back(static_cast<std::int32_t>(v));
  }
  ASSERT_GT(shin.size(), 10U);
  const GroundContacts contacts(with_floored(database, shin, 3));
  EXPECT_TRUE(std::ranges::includes(contacts.touching(0, 1), shin)) << "the test needs it on the floor";
  EXPECT_EQ(contacts.feet(), plain.feet());
}

TEST(GroundContactsTest, OneBadFrameDoesNotMoveTheGround) {
  PerformanceDatabase database;
  MeshSequence clip = test::performer_with_feet().clip(0);
  const double ground = GroundContacts(test::performer_with_feet()).ground_height(0);
  clip.frame(7).col(1).array() -= 0.2F;
  database.add(std::move(clip));
  EXPECT_NEAR(GroundContacts(database).ground_height(0), ground, 1e-3);
}

TEST(GroundContactsTest, BadInputIsRefused) {
  const PerformanceDatabase& database = test::performer_with_feet();
  const auto made_with = [&](const ContactOptions& options) {
    return [&] { GroundContacts(database, options); };
  };
  EXPECT_THAT(made_with({.height = -0.1}),
              ThrowsMessage<InvalidArgument>(HasSubstr("contact height -0.1 m")));
  EXPECT_THROW(made_with({.height = std::numeric_limits<double>::infinity()})(), InvalidArgument);
  EXPECT_THAT(made_with({.speed = 0.0}), ThrowsMessage<InvalidArgument>(HasSubstr("contact speed 0 m/s")));
  EXPECT_THROW(made_with({.speed = std::nan("")})(), InvalidArgument);
  EXPECT_THROW(GroundContacts{PerformanceDatabase{}}, InvalidArgument);
  const GroundContacts contacts(database);
  EXPECT_THROW(contacts.touching(99, 0), InvalidArgument);
  EXPECT_THROW(contacts.touching(0, 999), InvalidArgument);
}

class LegWeightsTest : public ::testing::Test {
 protected:
  const PerformanceDatabase& database_ = test::performer_with_feet();
  GroundContacts contacts_{database_};
  Eigen::MatrixXd weights_ = leg_weights(database_, contacts_);
};

TEST_F(LegWeightsTest, OneOnTheFootZeroOnTheOtherAndAboveTheHips) {
  ASSERT_EQ(weights_.cols(), 2);
  EXPECT_TRUE((weights_.array() >= 0.0).all());
  EXPECT_TRUE((weights_.rowwise().sum().array() <= 1.0 + 1e-12).all());
  for (Eigen::Index foot = 0; foot < 2; ++foot) {
    for (const std::int32_t v : contacts_.feet()[static_cast<std::size_t>(foot)]) {
      EXPECT_EQ(weights_(v, foot), 1.0);
      EXPECT_EQ(weights_(v, 1 - foot), 0.0);
    }
  }
  for (Eigen::Index v = 0; v < weights_.rows(); ++v) {
    if (contacts_.mean_heights()[static_cast<std::size_t>(v)] > 0.5 * contacts_.stature()) {
      EXPECT_TRUE(weights_.row(v).isZero(0.0)) << "vertex " << v;
    }
  }
}

TEST_F(LegWeightsTest, HandsThatHangBesideTheLegsDoNotFollow) {
  const Markup& markup = *database_.markup();
  for (const char* name : {"left_hand", "right_hand"}) {
    for (const std::int32_t v : markup.vertices_of_joint(*markup.skeleton.find(name)))
      EXPECT_TRUE(weights_.row(v).isZero(0.0)) << name << ", vertex " << v;
  }
}

TEST_F(LegWeightsTest, TheyFallSmoothlyFromEdgeToEdge) {
  const PositionsView reference = database_.clip(0).frame(0);
  double steepest = 0.0;
  for (const Triangle& triangle : database_.topology()->triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = triangle[k];
      const std::int32_t b = triangle[(k + 1) % 3];
      const double length = static_cast<double>((reference.row(a) - reference.row(b)).norm());
      steepest = std::max(steepest, (weights_.row(a) - weights_.row(b)).cwiseAbs().maxCoeff() / length);
    }
  }
  // A smoothstep over the 0.75 m from ankle to hip is no steeper than 2 a metre; ankles are thinner than
  // thighs, where a harmonic function falls faster.
  EXPECT_LT(steepest, 6.0);
}

TEST_F(LegWeightsTest, AShoeThatIsAPieceOfItsOwnTakesTheLegAlong) {
  // The surface cut open around the ankles: vertices there are doubled.
  const Topology& whole = *database_.topology();
  const auto is_low = [&](const Triangle& triangle) {
    return std::ranges::all_of(triangle, [&](std::int32_t v) {
      return contacts_.mean_heights()[static_cast<std::size_t>(v)] < 0.16;
    });
  };
  auto cut = std::make_shared<Topology>();
  cut->vertex_count = 2 * whole.vertex_count;
  for (Triangle triangle : whole.triangles) {
    if (is_low(triangle)) {
      for (std::int32_t& v : triangle) v += whole.vertex_count;
    }
    cut->triangles.push_back(triangle);
  }
  PerformanceDatabase database;
  for (const MeshSequence& clip : database_.clips()) {
    MeshSequence doubled(clip.name(), cut, clip.frame_count(), clip.frames_per_second());
    for (std::size_t f = 0; f < clip.frame_count(); ++f) {
      doubled.frame(f).topRows(whole.vertex_count) = clip.frame(f);
      doubled.frame(f).bottomRows(whole.vertex_count) = clip.frame(f);
    }
    database.add(std::move(doubled));
  }
  const GroundContacts contacts(database);
  const Eigen::MatrixXd weights = leg_weights(database, contacts);
  std::vector<std::int32_t> uses(static_cast<std::size_t>(2 * whole.vertex_count), 0);
  for (const Triangle& triangle : cut->triangles) {
    for (const std::int32_t v : triangle) ++uses[static_cast<std::size_t>(v)];
  }
  std::size_t seams = 0;
  for (std::int32_t v = 0; v < whole.vertex_count; ++v) {
    if (uses[static_cast<std::size_t>(v)] == 0 || uses[static_cast<std::size_t>(v + whole.vertex_count)] == 0)
      continue;
    ++seams;
    EXPECT_GT(weights.row(v).maxCoeff(), 0.5) << "the leg at the ankle goes along";
    EXPECT_NEAR(weights.row(v).maxCoeff(), weights.row(v + whole.vertex_count).maxCoeff(), 0.1);
  }
  EXPECT_GT(seams, 10U);
}

TEST(LegWeightsWithoutFeetTest, NothingFollows) {
  PerformanceDatabase database;
  MeshSequence clip = test::walk("a", 10);
  for (std::size_t f = 0; f < clip.frame_count(); ++f) clip.frame(f).col(1).array() += static_cast<float>(f);
  database.add(std::move(clip));
  const GroundContacts contacts(database, {.height = 0.0});
  EXPECT_TRUE(contacts.feet().empty());
  EXPECT_EQ(leg_weights(database, contacts).cols(), 0);
}

}  // namespace
}  // namespace reprise
