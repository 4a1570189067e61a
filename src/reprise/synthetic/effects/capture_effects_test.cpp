// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/effects/capture_effects.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/mesh/geodesic.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr std::size_t frames = 150;

// A grey unit sphere that lies still.
class Effects : public ::testing::Test {
 protected:
  MeshSequence still(const std::string& name = "still") const {
    MeshSequence clip(name, sphere_.topology, frames, 25.0);
    for (std::size_t f = 0; f < frames; ++f) clip.frame(f) = sphere_.positions;
    clip.set_colors(std::vector<Color>(clip.vertex_count(), Color{120, 120, 120}));
    return clip;
  }
  MeshSequence with(const CaptureEffects& effects, const std::string& name = "still") const {
    MeshSequence clip = still(name);
    apply_capture_effects(clip, sphere_.positions, effects);
    return clip;
  }
  // Displacement of all vertices in all frames: F matrices of N x 3.
  std::vector<Positions> displacement(const MeshSequence& clip) const {
    std::vector<Positions> all;
    for (std::size_t f = 0; f < frames; ++f) all.emplace_back(clip.frame(f) - sphere_.positions);
    return all;
  }
  Eigen::Vector3f outward(Eigen::Index v) const {
    return (sphere_.positions.row(v).transpose() - Eigen::Vector3f(0, 1, 0)).normalized();
  }

  test::Shape sphere_ = test::sphere(4);
};

TEST_F(Effects, NoneChangesNothing) {
  const MeshSequence clip = with({});
  EXPECT_EQ(clip.data(), still().data());
  EXPECT_FALSE(clip.has_colors_per_frame());
}

TEST_F(Effects, NoiseHasItsAmountAlongTheNormalAndItsCorrelationInSpaceAndTime) {
  const CaptureEffects effects{.noise = 0.005, .noise_length = 0.3, .noise_time = 0.12};
  const std::vector<Positions> d = displacement(with(effects));
  const Eigen::Index n = sphere_.positions.rows();
  const EdgeGraph graph(*sphere_.topology, PositionsView(sphere_.positions.data(), n, 3));
  double squares = 0.0;
  double tangential = 0.0;
  double in_time = 0.0;   // of frames noise_time apart
  double in_space = 0.0;  // of vertices about noise_length apart
  double expected_in_space = 0.0;
  int pairs = 0;
  Eigen::MatrixXd height(n, static_cast<Eigen::Index>(frames));
  for (Eigen::Index v = 0; v < n; ++v) {
    for (std::size_t f = 0; f < frames; ++f) {
      const Eigen::Vector3f moved = d[f].row(v);
      height(v, static_cast<Eigen::Index>(f)) = moved.dot(outward(v));
      tangential += (moved - outward(v) * moved.dot(outward(v))).squaredNorm();
    }
  }
  squares = height.squaredNorm() / static_cast<double>(height.size());
  const Eigen::Index last = static_cast<Eigen::Index>(frames) - 3;
  in_time = height.leftCols(last).cwiseProduct(height.rightCols(last)).mean() / squares;
  for (std::int32_t v = 0; v < n; v += 7) {
    for (const auto& [near, distance] : graph.neighbourhood(v, 0.35F)) {
      if (distance < 0.25F) continue;
      in_space += height.row(v).dot(height.row(near)) / static_cast<double>(frames) / squares;
      expected_in_space += std::exp(-distance * distance / (2.0 * 0.3 * 0.3));
      ++pairs;
    }
  }
  EXPECT_NEAR(std::sqrt(squares), 0.005, 0.0005);
  EXPECT_LT(tangential, 0.01 * height.squaredNorm());
  EXPECT_NEAR(in_time, std::exp(-0.5), 0.06);
  EXPECT_NEAR(in_space / pairs, expected_in_space / pairs, 0.08);
}

TEST_F(Effects, DriftSlidesOnTheSurfaceByItsAmount) {
  const std::vector<Positions> d =
      displacement(with({.drift = 0.02, .drift_length = 0.4, .drift_time = 0.4}));
  double squares = 0.0;
  double off_surface = 0.0;
  for (const Positions& frame : d) {
    squares += frame.squaredNorm() / static_cast<double>(frame.rows());
    for (Eigen::Index v = 0; v < frame.rows(); ++v) {
      const Eigen::Vector3f at = sphere_.positions.row(v) + frame.row(v);
      off_surface =
          std::max(off_surface, static_cast<double>(std::abs((at - Eigen::Vector3f(0, 1, 0)).norm() - 1.0F)));
    }
  }
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(frames) / 2.0), 0.02,
              0.003);            // two directions of the surface
  EXPECT_LT(off_surface, 0.01);  // the flat triangles' own distance from the sphere
}

TEST_F(Effects, LightsStandStillWhileTheBodyTurns) {
  MeshSequence clip = still();
  for (std::size_t f = 0; f < frames; ++f) {
    const GroundTransform turn{.yaw = 2.0 * 3.14159265358979 * static_cast<double>(f) / frames};
    transform_positions(turn, std::as_const(clip).frame(f), clip.frame(f));
  }
  apply_capture_effects(clip, sphere_.positions, {.studio_lights = true});
  ASSERT_TRUE(clip.has_colors_per_frame());
  // A sphere looks the same however it is turned; each of its vertices does not.
  double first = 0.0;
  double middle = 0.0;
  double change = 0.0;
  for (std::size_t v = 0; v < clip.vertex_count(); ++v) {
    const int a = std::as_const(clip).colors(0)[v][1];
    const int b = std::as_const(clip).colors(frames / 2)[v][1];
    first += a;
    middle += b;
    change += std::abs(a - b);
  }
  const auto n = static_cast<double>(clip.vertex_count());
  EXPECT_NEAR(first / n, middle / n, 0.5);
  EXPECT_GT(change / n, 5.0);
  EXPECT_NEAR(first / n, 120.0, 12.0);
}

TEST_F(Effects, SameSeedSameBytesOnAnyNumberOfThreads) {
  const CaptureEffects effects{.noise = 0.003, .drift = 0.01, .studio_lights = true, .seed = 9};
  const MeshSequence many = with(effects);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const MeshSequence one = with(effects);
  EXPECT_EQ(many.data(), one.data());
  EXPECT_TRUE(std::ranges::equal(many.colors(frames - 1), one.colors(frames - 1)));
}

TEST_F(Effects, AnotherSeedOrClipIsAnotherNoise) {
  const CaptureEffects effects{.noise = 0.003};
  CaptureEffects other = effects;
  other.seed = 2;
  EXPECT_NE(with(effects).data(), with(other).data());
  EXPECT_NE(with(effects).data(), with(effects, "another").data());
}

TEST_F(Effects, BadAmountsAreRefused) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { with({.noise = -0.1}); }, ThrowsMessage<InvalidArgument>(HasSubstr("noise is -0.1")));
  EXPECT_THAT([&] { with({.drift = nan}); }, ThrowsMessage<InvalidArgument>(HasSubstr("drift")));
  EXPECT_THAT([&] { with({.noise = 0.1, .noise_length = 0.0}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("noise length")));
  MeshSequence plain("plain", sphere_.topology, 2, 25.0);
  EXPECT_THAT([&] { apply_capture_effects(plain, sphere_.positions, {.studio_lights = true}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("no colours")));
}

}  // namespace
}  // namespace reprise
