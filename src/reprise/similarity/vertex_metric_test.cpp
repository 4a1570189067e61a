// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/vertex_metric.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/io/sequence_reader.h"
#include "support/shapes.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using test::database_of;

// A clip of unrelated random shapes far from symmetric.
MeshSequence noise(const std::string& name, std::size_t frame_count, unsigned seed) {
  const test::Shape shape = test::body();
  MeshSequence clip(name, shape.topology, frame_count, 25.0);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> offset(-0.3F, 0.3F);
  for (std::size_t f = 0; f < frame_count; ++f) {
    auto out = clip.frame(f);
    out = shape.positions;
    for (float& value : out.reshaped()) value += offset(random);
  }
  return clip;
}

PositionsView view(const Positions& positions) {
  return {positions.data(), positions.rows(), 3};
}

double rms(const PositionsView& a, const PositionsView& b, const GroundTransform& a_from_b) {
  double sum = 0.0;
  for (Eigen::Index v = 0; v < a.rows(); ++v) {
    const Eigen::Vector3d moved = a_from_b * b.row(v).transpose().cast<double>().eval();
    sum += (a.row(v).transpose().cast<double>() - moved).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(a.rows()));
}

PerformanceDatabase ama() {
  PerformanceDatabase database;
  for (const char* name : {"crane", "jumping"}) {
    const auto reader = open_sequence({.path = test::data_folder() / "ama" / name});
    MeshSequence clip(name, reader->topology(), reader->frame_count(), 25.0);
    for (std::size_t f = 0; f < reader->frame_count(); ++f) clip.frame(f) = reader->read(f).positions;
    database.add(std::move(clip));
  }
  return database;
}

TEST(AlignOnGround, RecoversARigidMotionOnTheGround) {
  const test::Shape shape = test::body();
  for (const double yaw : {-3.1, -1.0, 0.0, 0.3, 2.1, std::numbers::pi}) {
    const GroundTransform b_from_a{.yaw = yaw, .translation = {3.0, -4.0}};
    Positions b = shape.positions;
    transform_positions(b_from_a, view(shape.positions), PositionsRef(b.data(), b.rows(), 3));
    const GroundAlignment alignment = align_on_ground(view(b), view(shape.positions));
    EXPECT_NEAR(wrap_angle(alignment.a_from_b.yaw - yaw), 0.0, 1e-6);
    EXPECT_NEAR((alignment.a_from_b.translation - b_from_a.translation).norm(), 0.0, 1e-6);
    EXPECT_LT(alignment.rms_distance, 1e-6);
  }
}

TEST(AlignOnGround, TakesTheSignOfYawFromZTowardsX) {
  Positions towards_z(2, 3);
  towards_z << 0, 0, 0, 0, 0, 1;
  Positions towards_x(2, 3);
  towards_x << 0, 0, 0, 1, 0, 0;
  EXPECT_NEAR(align_on_ground(view(towards_x), view(towards_z)).a_from_b.yaw, std::numbers::pi / 2, 1e-12);
}

TEST(AlignOnGround, ReportsTheDistanceItsTransformLeaves) {
  const MeshSequence clip = noise("noise", 2, 1);
  const GroundAlignment alignment = align_on_ground(clip.frame(0), clip.frame(1));
  EXPECT_NEAR(alignment.rms_distance, rms(clip.frame(0), clip.frame(1), alignment.a_from_b), 1e-12);
}

TEST(AlignOnGround, IsOptimal) {
  const MeshSequence clip = noise("noise", 6, 2);
  for (std::size_t f = 1; f < clip.frame_count(); ++f) {
    const GroundAlignment best = align_on_ground(clip.frame(0), clip.frame(f));
    for (const double step : {-0.5, -0.01, 0.01, 0.5, 3.0}) {
      GroundTransform turned = best.a_from_b;
      turned.yaw += step;
      // Turn about the centroid, not about the origin: the hardest rival of that angle.
      const Eigen::Vector3d c = centroid(clip.frame(f));
      turned.translation +=
          (best.a_from_b * Eigen::Vector2d(c.x(), c.z())) - turned * Eigen::Vector2d(c.x(), c.z());
      EXPECT_GT(rms(clip.frame(0), clip.frame(f), turned), best.rms_distance);
      for (const Eigen::Vector2d& direction : {Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1)}) {
        GroundTransform shifted = best.a_from_b;
        shifted.translation += step * direction;
        EXPECT_GT(rms(clip.frame(0), clip.frame(f), shifted), best.rms_distance);
      }
    }
  }
}

TEST(AlignOnGround, KeepsTheHeightDifference) {
  const test::Shape shape = test::body();
  Positions lifted = shape.positions;
  lifted.col(1).array() += 0.25F;
  EXPECT_NEAR(align_on_ground(view(lifted), view(shape.positions)).rms_distance, 0.25, 1e-6);
}

TEST(AlignOnGround, RefusesUnequalOrEmptyFrames) {
  const Positions three = Positions::Zero(3, 3);
  const Positions four = Positions::Zero(4, 3);
  const Positions none(0, 3);
  EXPECT_THROW(align_on_ground(view(three), view(four)), InvalidArgument);
  EXPECT_THROW(align_on_ground(view(none), view(none)), InvalidArgument);
}

TEST(VertexDissimilarity, EqualsPairwiseAlignment) {
  // More frames than one tile, clips that end inside a tile.
  const PerformanceDatabase database = database_of(
      {noise("a", 50, 3), test::walk("b", 40), noise("c", 1, 4), test::walk("d", 45, 0.1, 13.0, 4.0)});
  const DissimilarityMatrix matrix = vertex_dissimilarity(database);
  ASSERT_EQ(matrix.frame_count(), 136U);
  for (std::size_t clip_a = 0; clip_a < 4; ++clip_a) {
    for (std::size_t i = 0; i < database.clip(clip_a).frame_count(); i += 7) {
      for (std::size_t clip_b = clip_a; clip_b < 4; ++clip_b) {
        for (std::size_t j = 0; j < database.clip(clip_b).frame_count(); j += 3) {
          const std::size_t a = matrix.first_frame(clip_a) + i;
          const std::size_t b = matrix.first_frame(clip_b) + j;
          if (a == b) continue;
          const GroundAlignment direct =
              align_on_ground(database.clip(clip_a).frame(i), database.clip(clip_b).frame(j));
          EXPECT_NEAR(matrix.value(a, b), direct.rms_distance, 1e-6);
          EXPECT_NEAR(wrap_angle(matrix.yaw(a, b) - direct.a_from_b.yaw), 0.0, 1e-6);
        }
      }
    }
  }
}

TEST(VertexDissimilarity, IsSymmetricWithZeroDiagonalAndOppositeYaw) {
  const DissimilarityMatrix matrix =
      vertex_dissimilarity(database_of({noise("a", 5, 5), test::walk("b", 6)}));
  for (std::size_t a = 0; a < matrix.frame_count(); ++a) {
    EXPECT_EQ(matrix.value(a, a), 0.0F);
    EXPECT_EQ(matrix.yaw(a, a), 0.0F);
    for (std::size_t b = 0; b < a; ++b) {
      EXPECT_GT(matrix.value(a, b), 0.0F);
      EXPECT_EQ(matrix.value(a, b), matrix.value(b, a));
      EXPECT_EQ(matrix.yaw(a, b), -matrix.yaw(b, a));
    }
  }
}

TEST(VertexDissimilarity, DoesNotChangeWhenClipsMoveOnTheGround) {
  const std::vector<MeshSequence> clips = {noise("a", 7, 6), test::walk("b", 9)};
  const GroundTransform motion{.yaw = 2.1, .translation = {3.0, -4.0}};
  const DissimilarityMatrix before = vertex_dissimilarity(database_of(clips));
  const DissimilarityMatrix after =
      vertex_dissimilarity(database_of({clips[0], test::moved(clips[1], motion, "b")}));
  for (std::size_t a = 0; a < 7; ++a) {
    for (std::size_t b = 7; b < 16; ++b) {
      EXPECT_NEAR(before.value(a, b), after.value(a, b), 1e-6);
      EXPECT_NEAR(wrap_angle(before.yaw(a, b) - (after.yaw(a, b) + motion.yaw)), 0.0, 1e-5);
    }
  }
}

TEST(VertexDissimilarity, OfAMovedCopyIsZeroToStoragePrecision) {
  const MeshSequence clip = test::walk("walk", 70);
  const GroundTransform motion{.yaw = 2.1, .translation = {3.0, -4.0}};
  const DissimilarityMatrix matrix =
      vertex_dissimilarity(database_of({clip, test::moved(clip, motion, "copy")}));
  for (std::size_t f = 0; f < 70; ++f) {
    EXPECT_LT(matrix.value(f, 70 + f), 1e-6F);
    EXPECT_NEAR(wrap_angle(matrix.yaw(70 + f, f) - 2.1), 0.0, 1e-5);
  }
}

TEST(VertexDissimilarity, HasTheSameBitsForAnyNumberOfThreads) {
  const PerformanceDatabase database = database_of({noise("a", 70, 7), test::walk("b", 100)});
  std::vector<DissimilarityMatrix> results;
  for (const std::size_t threads : {1, 2, 5}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(vertex_dissimilarity(database));
  }
  for (std::size_t r = 1; r < results.size(); ++r) {
    for (std::size_t a = 0; a < 170; ++a) {
      for (std::size_t b = a + 1; b < 170; ++b) {
        ASSERT_EQ(results[0].value(a, b), results[r].value(a, b));
        ASSERT_EQ(results[0].yaw(a, b), results[r].yaw(a, b));
      }
    }
  }
}

TEST(VertexDissimilarity, IsKeyedByTheContentOfTheDatabase) {
  const PerformanceDatabase database = database_of({test::walk("a", 4)});
  EXPECT_EQ(vertex_dissimilarity(database).key(), database.content_hash());
  EXPECT_NE(vertex_dissimilarity(database_of({test::walk("a", 5)})).key(), database.content_hash());
}

TEST(VertexDissimilarity, OfFewerThanTwoFramesIsEmpty) {
  EXPECT_EQ(vertex_dissimilarity(PerformanceDatabase()).frame_count(), 0U);
  const DissimilarityMatrix one = vertex_dissimilarity(database_of({test::walk("a", 1)}));
  EXPECT_EQ(one.frame_count(), 1U);
  EXPECT_EQ(one.value(0, 0), 0.0F);
}

TEST(VertexDissimilarity, OfACapturedClipMovedOnTheGroundIsZeroToStoragePrecision) {
  REPRISE_REQUIRE_DATA();
  PerformanceDatabase database = ama();
  const GroundTransform motion{.yaw = 2.1, .translation = {3.0, -4.0}};
  database.add(test::moved(database.clip(0), motion, "copy"));
  const std::size_t F = database.clip(0).frame_count();
  const DissimilarityMatrix matrix = vertex_dissimilarity(database);
  const std::size_t copy = matrix.first_frame(2);
  const std::size_t jumping = matrix.first_frame(1);
  for (std::size_t f = 0; f < F; ++f) {
    EXPECT_LT(matrix.value(f, copy + f), 1e-5F);
    for (std::size_t g = 0; g < database.clip(1).frame_count(); g += 5) {
      EXPECT_NEAR(matrix.value(f, jumping + g), matrix.value(copy + f, jumping + g), 1e-5);
    }
  }
  // Spot check against the vertices themselves.
  for (std::size_t f = 3; f < F; f += 40) {
    const GroundAlignment direct = align_on_ground(database.clip(0).frame(f), database.clip(1).frame(f / 2));
    EXPECT_NEAR(matrix.value(f, jumping + f / 2), direct.rms_distance, 1e-6);
    EXPECT_NEAR(wrap_angle(matrix.yaw(f, jumping + f / 2) - direct.a_from_b.yaw), 0.0, 1e-6);
  }
}

}  // namespace
}  // namespace reprise
