// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/editing/space_time.h"

#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/interrupt.h"
#include "reprise/editing/editing_test_support.h"
#include "reprise/editing/key_run.h"

namespace reprise {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr std::size_t frame_count = 61;

// "still" stands; "turning" is the same body turned by 3 degrees a frame; "walk" walks and sways.
PerformanceDatabase performance() {
  MeshSequence still = test::walk("still", frame_count, 0.0, 1e9);
  MeshSequence turning = still;
  turning.set_name("turning");
  for (std::size_t f = 0; f < frame_count; ++f) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(static_cast<double>(f) * M_PI / 60.0, Vector3d::UnitY()).toRotationMatrix();
    const Coordinates turned = still.frame(0).cast<double>() * turn.transpose();
    turning.frame(f) = turned.cast<float>();
  }
  return test::database_of({still, turning, test::walk("walk", frame_count)});
}

class SpaceTimeTest : public testing::Test {
 protected:
  const PerformanceDatabase database_ = performance();
  const test::NearbyFactory factory_{database_};
  const double rate_ = database_.frames_per_second();

  Vector3d captured(std::size_t clip, std::size_t frame, std::int32_t vertex) const {
    return database_.clip(clip).frame(frame).row(vertex).transpose().cast<double>();
  }
  PositionConstraint moved(std::size_t clip, std::size_t frame, std::int32_t vertex,
                           const Vector3d& by) const {
    return {vertex, captured(clip, frame, vertex) + by};
  }
  Vector3d displacement(const MeshSequence& edited, std::size_t clip, std::size_t frame,
                        std::int32_t vertex) const {
    return edited.frame(frame).row(vertex).transpose().cast<double>() - captured(clip, frame, vertex);
  }
  // The surface of a frame that is edited alone.
  Positions still_edit(std::size_t clip, const KeyEdit& key) const {
    const auto editor = factory_.make(EditModel::part);
    editor->set_frame(database_.clip(clip).frame(key.frame_idx));
    editor->deform(key.constraints);
    return editor->positions().cast<float>();
  }
};

TEST(QuinticSmoothstep, StartsAndEndsAtRestAndIsSymmetric) {
  EXPECT_EQ(quintic_smoothstep(0.0), 0.0);
  EXPECT_EQ(quintic_smoothstep(1.0), 1.0);
  EXPECT_EQ(quintic_smoothstep(-3.0), 0.0);
  EXPECT_EQ(quintic_smoothstep(2.0), 1.0);
  const double h = 1e-3;
  for (const double end : {0.0, 1.0}) {
    const double inwards = end == 0.0 ? h : -h;
    const double first = (quintic_smoothstep(end + inwards) - quintic_smoothstep(end)) / h;
    const double second = (quintic_smoothstep(end + 2.0 * inwards) - 2.0 * quintic_smoothstep(end + inwards) +
                           quintic_smoothstep(end)) /
                          (h * h);
    EXPECT_NEAR(first, 0.0, 2e-5);
    EXPECT_NEAR(second, 0.0, 0.1);  // a cubic smoothstep has 6
  }
  for (double t = 0.0; t <= 1.0; t += 0.05) {
    EXPECT_NEAR(quintic_smoothstep(t) + quintic_smoothstep(1.0 - t), 1.0, 1e-12);
  }
}

TEST_F(SpaceTimeTest, FramesOutsideOfTheWindowStayBitForBit) {
  const double window = 8.0 / rate_;
  const MeshSequence edited =
      edit_clip(factory_, 2, {{30, {moved(2, 30, 10, {0.1, 0.0, 0.0})}}}, {.window = window});
  ASSERT_EQ(edited.frame_count(), frame_count);
  for (std::size_t f = 0; f < frame_count; ++f) {
    const bool is_same = Positions(edited.frame(f)) == Positions(database_.clip(2).frame(f));
    EXPECT_EQ(is_same, f <= 22 || f >= 38) << "frame " << f;
    EXPECT_EQ(edited.origins()[f], (FrameOrigin{.clip = "walk", .frame_idx = static_cast<std::int32_t>(f)}));
  }
}

TEST_F(SpaceTimeTest, ADisplacementComesAndGoesAlongTheSmoothstep) {
  const Vector3d by(0.1, -0.2, 0.05);
  const double window = 12.0;
  const MeshSequence edited =
      edit_clip(factory_, 0, {{30, {moved(0, 30, 10, by)}}}, {.window = window / rate_});
  double largest = 0.0;
  for (std::size_t f = 1; f + 1 < frame_count; ++f) {
    const double distance = std::abs(static_cast<double>(f) - 30.0);
    const Vector3d expected = quintic_smoothstep(1.0 - distance / window) * by;
    EXPECT_LT((displacement(edited, 0, f, 10) - expected).norm(), 1e-6) << "frame " << f;
    largest = std::max(largest, (displacement(edited, 0, f - 1, 10) - 2.0 * displacement(edited, 0, f, 10) +
                                 displacement(edited, 0, f + 1, 10))
                                    .norm());
  }
  // The greatest second derivative of the smoothstep is 10 / sqrt(3).
  EXPECT_LT(largest, 10.0 / std::sqrt(3.0) * by.norm() / (window * window) + 1e-6);
}

TEST_F(SpaceTimeTest, DisplacementsRunThroughAllKeysOfAVertex) {
  const Vector3d first(0.1, 0.0, 0.0), second(0.0, 0.3, 0.0);
  const MeshSequence edited =
      edit_clip(factory_, 0, {{45, {moved(0, 45, 10, second)}}, {10, {moved(0, 10, 10, first)}}},
                {.window = 4.0 / rate_});
  for (std::size_t f = 10; f <= 45; ++f) {  // keys far apart that share a vertex
    const double share = quintic_smoothstep((static_cast<double>(f) - 10.0) / 35.0);
    const Vector3d expected = (1.0 - share) * first + share * second;
    EXPECT_LT((displacement(edited, 0, f, 10) - expected).norm(), 1e-6) << "frame " << f;
  }
  EXPECT_EQ(displacement(edited, 0, 6, 10), Vector3d::Zero());
  EXPECT_EQ(displacement(edited, 0, 49, 10), Vector3d::Zero());
}

TEST_F(SpaceTimeTest, AWindowOfZeroHoldsToTheEndsOfTheClip) {
  const Vector3d by(0.1, 0.0, 0.0);
  const MeshSequence edited = edit_clip(factory_, 0, {{30, {moved(0, 30, 10, by)}}}, {.window = 0.0});
  for (std::size_t f = 0; f < frame_count; ++f) {
    EXPECT_LT((displacement(edited, 0, f, 10) - by).norm(), 1e-6) << "frame " << f;
  }
}

TEST_F(SpaceTimeTest, DisplacementsTurnWithTheBody) {
  const Vector3d by(0.1, 0.0, 0.0);
  const MeshSequence edited = edit_clip(factory_, 1, {{30, {moved(1, 30, 10, by)}}}, {.window = 0.0});
  for (std::size_t f = 0; f < frame_count; ++f) {
    const Eigen::AngleAxisd turn((static_cast<double>(f) - 30.0) * M_PI / 60.0, Vector3d::UnitY());
    EXPECT_LT((displacement(edited, 1, f, 10) - turn * by).norm(), 1e-5) << "frame " << f;
  }
}

TEST_F(SpaceTimeTest, AKeyFrameIsItsStillEdit) {
  const KeyEdit first{20, {moved(2, 20, 10, {0.1, 0.0, 0.0}), moved(2, 20, 60, Vector3d::Zero())}};
  const KeyEdit second{40, {moved(2, 40, 60, {0.0, 0.1, 0.0}), moved(2, 40, 10, {0.0, 0.0, 0.1})}};
  const MeshSequence edited = edit_clip(factory_, 2, {first, second});
  EXPECT_EQ(Positions(edited.frame(20)), still_edit(2, first));
  EXPECT_EQ(Positions(edited.frame(40)), still_edit(2, second));
}

TEST_F(SpaceTimeTest, KeysOfOtherVerticesWhoseWindowsMeetGoSmoothlyIntoEachOther) {
  const KeyEdit first{26, {moved(0, 26, 10, {0.1, 0.0, 0.0})}};
  const KeyEdit second{34, {moved(0, 34, 60, {0.0, 0.1, 0.0})}};
  const MeshSequence edited = edit_clip(factory_, 0, {first, second}, {.window = 10.0 / rate_});
  for (const auto& [key, vertex] : {std::pair(&first, 60), std::pair(&second, 10)}) {
    const Vector3d still = still_edit(0, *key).row(vertex).transpose().cast<double>();
    const Vector3d here = edited.frame(key->frame_idx).row(vertex).transpose().cast<double>();
    EXPECT_LT((here - still).norm(), 1e-6) << "a vertex that the key leaves free goes where the key takes it";
  }
  double largest = 0.0;
  for (std::size_t f = 1; f + 1 < frame_count; ++f) {
    for (std::int32_t v = 0; v < edited.frame(0).rows(); ++v) {
      largest = std::max(largest, (displacement(edited, 0, f - 1, v) - 2.0 * displacement(edited, 0, f, v) +
                                   displacement(edited, 0, f + 1, v))
                                      .norm());
    }
  }
  // Within 8 frames from one to the other.
  EXPECT_LT(largest, 10.0 / std::sqrt(3.0) * std::sqrt(2.0) * 0.1 / 64.0);
}

TEST_F(SpaceTimeTest, KeysOfOtherVerticesFarApartDoNotKnowOfEachOther) {
  const KeyEdit first{10, {moved(2, 10, 10, {0.1, 0.0, 0.0})}};
  const KeyEdit second{50, {moved(2, 50, 60, {0.0, 0.1, 0.0})}};
  const SpaceTimeOptions options{.window = 6.0 / rate_};
  const MeshSequence both = edit_clip(factory_, 2, {first, second}, options);
  const MeshSequence one = edit_clip(factory_, 2, {first}, options);
  const MeshSequence other = edit_clip(factory_, 2, {second}, options);
  for (std::size_t f = 0; f < frame_count; ++f) {
    EXPECT_EQ(Positions(both.frame(f)), Positions(f < 30 ? one.frame(f) : other.frame(f))) << "frame " << f;
  }
}

TEST_F(SpaceTimeTest, AKeyAtRestBringsTheSurfaceBack) {
  const KeyEdit edit{10, {moved(2, 10, 10, {0.1, 0.0, 0.0})}};
  const KeyEdit rest{20, {moved(2, 20, 10, Vector3d::Zero())}};
  const MeshSequence edited = edit_clip(factory_, 2, {edit, rest}, {.window = 0.0});
  EXPECT_GT(displacement(edited, 2, 19, 10).norm(), 0.0);
  for (std::size_t f = 20; f < frame_count; ++f) {
    EXPECT_EQ(Positions(edited.frame(f)), Positions(database_.clip(2).frame(f))) << "frame " << f;
  }
}

TEST_F(SpaceTimeTest, TheNumberOfThreadsChangesNothing) {
  const std::vector<KeyEdit> keys = {{20, {moved(2, 20, 10, {0.1, 0.0, 0.0})}},
                                     {32, {moved(2, 32, 60, {0.0, 0.1, 0.0})}}};
  const MeshSequence many = edit_clip(factory_, 2, keys);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(edit_clip(factory_, 2, keys).data(), many.data());
}

TEST_F(SpaceTimeTest, NormalsAreRecomputedWhereTheSurfaceMovesAndOnlyThere) {
  MeshSequence clip = database_.clip(2);
  for (std::size_t f = 0; f < frame_count; ++f) clip.mutable_normals(f).setConstant(0.25F);
  const PerformanceDatabase with_normals = test::database_of({clip});
  const test::NearbyFactory factory(with_normals);
  const MeshSequence edited =
      edit_clip(factory, 0, {{30, {moved(2, 30, 10, {0.1, 0.0, 0.0})}}}, {.window = 5.0 / rate_});
  ASSERT_TRUE(edited.has_normals());
  EXPECT_EQ(Positions(edited.normals(25)), Positions(clip.normals(25)));
  EXPECT_EQ(Positions(edited.normals(28)), vertex_normals(*clip.topology(), edited.frame(28)));
  EXPECT_FALSE(edit_clip(factory_, 2, {{30, {moved(2, 30, 10, {0.1, 0.0, 0.0})}}}).has_normals());
}

TEST_F(SpaceTimeTest, CanBeInterrupted) {
  set_interrupted(true);
  EXPECT_THROW(edit_clip(factory_, 0, {{30, {moved(0, 30, 10, Vector3d::UnitX())}}}), Cancelled);
  set_interrupted(false);
}

TEST_F(SpaceTimeTest, RefusesWhatMakesNoSense) {
  const PositionConstraint fine = moved(0, 30, 10, {0.1, 0.0, 0.0});
  const auto refuses = [&](const char* what, const std::vector<KeyEdit>& keys, double window = 0.5,
                           std::size_t clip = 0) {
    SCOPED_TRACE(what);
    try {
      edit_clip(factory_, clip, keys, {.window = window});
      ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(what));
    }
  };
  refuses("at least one key", {});
  refuses("frame from 0 to 60", {{61, {fine}}});
  refuses("found two", {{30, {fine}}, {30, {fine}}});
  refuses("at least one constraint", {{30, {}}});
  refuses("vertex", {{30, {{99999, Vector3d::Zero()}}}});
  refuses("constrain", {{30, {fine, fine}}});
  refuses("window", {{30, {fine}}}, -1.0);
  refuses("window", {{30, {fine}}}, std::numeric_limits<double>::quiet_NaN());
  refuses("clip", {{30, {fine}}}, 0.5, 3);
  refuses("too far", {{30, {moved(0, 30, 10, {0.0, 2000.0, 0.0})}}});
}

}  // namespace
}  // namespace reprise
