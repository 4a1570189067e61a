// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/example_selection.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <string>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/core/random.h"
#include "reprise/io/sequence_reader.h"
#include "reprise/synthetic/figure/figure.h"
#include "support/shapes.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr std::size_t all_examples = std::numeric_limits<std::size_t>::max();

Eigen::Vector3f random_point(const RandomField& field, std::size_t a, std::size_t b) {
  return {static_cast<float>(field.normal_pair(a, 3 * b)[0]),
          static_cast<float>(field.normal_pair(a, 3 * b + 1)[0]),
          static_cast<float>(field.normal_pair(a, 3 * b + 2)[0])};
}

// Two clips, "a" of 2/3 of the frames, of a ball of 18 vertices that swells at random.
PerformanceDatabase random_database(std::size_t frame_count, std::uint64_t seed = 1) {
  const RandomField field(seed);
  const test::Shape ball = test::sphere(1);
  const auto clip = [&](const std::string& name, std::size_t begin, std::size_t end) {
    MeshSequence made(name, ball.topology, end - begin, 25.0);
    for (std::size_t f = begin; f < end; ++f) {
      made.frame(f - begin) = ball.positions;
      for (Eigen::Index v = 0; v < ball.positions.rows(); ++v) {
        made.frame(f - begin).row(v) +=
            0.05F * random_point(field, f, static_cast<std::size_t>(v)).transpose();
      }
    }
    return made;
  };
  return test::database_of({clip("a", 0, frame_count * 2 / 3), clip("b", frame_count * 2 / 3, frame_count)});
}

// Every frame turned about some axis and put elsewhere.
PerformanceDatabase rigidly_moved(const PerformanceDatabase& database) {
  const RandomField field(77);
  PerformanceDatabase moved;
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    MeshSequence clip = database.clip(c);
    for (std::size_t f = 0; f < clip.frame_count(); ++f) {
      const std::size_t key = database.first_frame(c) + f;
      const Eigen::Isometry3f motion = Eigen::Translation3f(2.0F * random_point(field, key, 0)) *
                                       Eigen::AngleAxisf(static_cast<float>(6.0 * field.uniform(key)),
                                                         random_point(field, key, 1).normalized());
      for (Eigen::Index v = 0; v < clip.frame(f).rows(); ++v) {
        const Eigen::Vector3f p = clip.frame(f).row(v);
        clip.frame(f).row(v) = (motion * p).transpose();
      }
    }
    moved.add(std::move(clip));
  }
  return moved;
}

Positions first_surface(const PerformanceDatabase& database) {
  return database.clip(0).frame(0);
}

std::vector<std::int32_t> part() {
  return {0, 1, 2, 4, 5, 7, 8, 9, 11, 12, 15, 17};
}

// Distances of all frames from all others, aligned by Eigen's own fit.
Eigen::MatrixXd expected_distances(const PerformanceDatabase& database, const Positions& reference,
                                   const std::vector<std::int32_t>& vertices,
                                   const std::vector<FrameId>& frames) {
  const Eigen::Matrix3Xd target = reference(vertices, Eigen::all).transpose().cast<double>();
  std::vector<Eigen::Matrix3Xd> shapes;
  for (const FrameId& frame : frames) {
    const Positions positions = database.clip(frame.clip_idx).frame(frame.frame_idx);
    const Eigen::Matrix3Xd points = positions(vertices, Eigen::all).transpose().cast<double>();
    const Eigen::Matrix4d motion = Eigen::umeyama(points, target, false);
    shapes.emplace_back((motion.topLeftCorner<3, 3>() * points).colwise() +
                        Eigen::Vector3d(motion.topRightCorner<3, 1>()));
  }
  const auto count = static_cast<Eigen::Index>(frames.size());
  return Eigen::MatrixXd::NullaryExpr(count, count, [&](Eigen::Index i, Eigen::Index j) {
    const Eigen::Matrix3Xd difference =
        shapes[static_cast<std::size_t>(i)] - shapes[static_cast<std::size_t>(j)];
    return std::sqrt(difference.squaredNorm() / static_cast<double>(vertices.size()));
  });
}

std::vector<FrameId> frames_of(const PerformanceDatabase& database, std::size_t stride = 1) {
  std::vector<FrameId> frames;
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    for (std::size_t f = 0; f < database.clip(c).frame_count(); f += stride) {
      frames.push_back({.clip_idx = c, .frame_idx = f});
    }
  }
  return frames;
}

Eigen::Index index_of(const std::vector<FrameId>& frames, FrameId frame) {
  return std::ranges::find(frames, frame) - frames.begin();
}

// Every choice is the farthest frame from those before it, and its radius what is then left.
void expect_farthest_points(const ExampleSelection& selection, const std::vector<FrameId>& frames,
                            const Eigen::MatrixXd& distances, double tolerance) {
  ASSERT_EQ(selection.frames.size(), selection.radii.size());
  EXPECT_EQ(selection.candidate_count, frames.size());
  Eigen::VectorXd to_nearest =
      Eigen::VectorXd::Constant(distances.rows(), std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < selection.frames.size(); ++k) {
    const Eigen::Index chosen = index_of(frames, selection.frames[k]);
    ASSERT_LT(chosen, distances.rows()) << "was not a candidate";
    if (k > 0) {
      EXPECT_NEAR(to_nearest[chosen], to_nearest.maxCoeff(), tolerance) << k;
    }
    to_nearest = to_nearest.cwiseMin(distances.col(chosen));
    EXPECT_NEAR(selection.radii[k], to_nearest.maxCoeff(), tolerance) << k;
  }
}

TEST(ExampleSelection, TakesTheFarthestFrameEachTime) {
  const PerformanceDatabase database = random_database(60);
  const Positions reference = first_surface(database);
  const ExampleSelection selection =
      select_examples(database, reference, part(), {.count = 25, .smallest_radius = 0.0});
  ASSERT_EQ(selection.frames.size(), 25U);
  const std::vector<FrameId> frames = frames_of(database);
  expect_farthest_points(selection, frames, expected_distances(database, reference, part(), frames), 1e-6);
  EXPECT_TRUE(std::ranges::is_sorted(selection.radii, std::greater<>()));
  // A shorter choice is the beginning of a longer one.
  const ExampleSelection shorter =
      select_examples(database, reference, part(), {.count = 7, .smallest_radius = 0.0});
  EXPECT_TRUE(std::ranges::equal(shorter.frames, std::span(selection.frames).first(7)));
  // Somebody else's list is measured by the same rule.
  EXPECT_EQ(covering_radii(database, reference, part(), selection.frames), selection.radii);
}

TEST(ExampleSelection, BeginsNearestToTheMean) {
  const PerformanceDatabase database = random_database(40, 3);
  const std::vector<FrameId> frames = frames_of(database);
  const FrameId first = select_examples(database, first_surface(database), part(), {.count = 1}).frames[0];
  // The mean is the point with the least sum of squared distances, so the nearest to it has the least sum
  // too.
  const Eigen::VectorXd sums =
      expected_distances(database, first_surface(database), part(), frames).colwise().squaredNorm();
  EXPECT_NEAR(sums[index_of(frames, first)], sums.minCoeff(), 1e-6);
}

TEST(ExampleSelection, CoversAtMostTwiceAsWideAsTheBestChoice) {
  for (const std::uint64_t seed : {4U, 5U, 6U}) {
    const PerformanceDatabase database = random_database(12, seed);
    const Positions reference = first_surface(database);
    const Eigen::MatrixXd distances = expected_distances(database, reference, part(), frames_of(database));
    const ExampleSelection selection =
        select_examples(database, reference, part(), {.count = 4, .smallest_radius = 0.0});
    std::map<int, double> best;  // of each size, over all subsets
    for (unsigned subset = 1; subset < (1U << 12U); ++subset) {
      double radius = 0.0;
      for (Eigen::Index i = 0; i < 12; ++i) {
        double nearest = std::numeric_limits<double>::infinity();
        for (Eigen::Index j = 0; j < 12; ++j) {
          if ((subset >> static_cast<unsigned>(j)) & 1U) nearest = std::min(nearest, distances(i, j));
        }
        radius = std::max(radius, nearest);
      }
      const auto [entry, is_new] = best.try_emplace(std::popcount(subset), radius);
      entry->second = std::min(entry->second, radius);
    }
    for (int k = 1; k <= 4; ++k) {
      const double radius = selection.radii[static_cast<std::size_t>(k) - 1];
      EXPECT_LE(radius, 2.0 * best[k] + 1e-6) << k;
      EXPECT_GE(radius, best[k] - 1e-6) << k;
    }
  }
}

TEST(ExampleSelection, RigidMotionsOfFramesChangeNothing) {
  const PerformanceDatabase database = random_database(50, 7);
  const Positions reference = first_surface(database);
  const ExampleOptions options{.count = 20, .smallest_radius = 0.0};
  const ExampleSelection still = select_examples(database, reference, part(), options);
  const ExampleSelection moved = select_examples(rigidly_moved(database), reference, part(), options);
  EXPECT_EQ(still.frames, moved.frames);
  for (std::size_t k = 0; k < still.radii.size(); ++k) EXPECT_NEAR(still.radii[k], moved.radii[k], 2e-6);
}

TEST(ExampleSelection, OnlyThePartCounts) {
  const PerformanceDatabase database = random_database(30, 8);
  PerformanceDatabase other;
  for (MeshSequence clip : database.clips()) {
    for (std::size_t f = 0; f < clip.frame_count(); ++f) clip.frame(f).row(3).setConstant(1e3F * f);
    other.add(std::move(clip));
  }
  const ExampleOptions options{.count = 12};
  EXPECT_EQ(select_examples(database, first_surface(database), part(), options).radii,
            select_examples(other, first_surface(database), part(), options).radii);
}

TEST(ExampleSelection, LeavesOutWhatIsExcluded) {
  const PerformanceDatabase database = random_database(60, 9);
  const Positions reference = first_surface(database);
  ExampleOptions options{.count = all_examples, .smallest_radius = 0.0, .stride = 3};
  for (std::size_t f = 0; f < 20; ++f) options.excluded.push_back({.clip_idx = 1, .frame_idx = f});
  options.excluded.push_back({.clip_idx = 0, .frame_idx = 9});
  options.excluded.push_back({.clip_idx = 0, .frame_idx = 9});  // once more does no harm
  std::vector<FrameId> frames;
  for (std::size_t f = 0; f < 40; f += 3) {
    if (f != 9) frames.push_back({.clip_idx = 0, .frame_idx = f});
  }
  const ExampleSelection selection = select_examples(database, reference, part(), options);
  EXPECT_EQ(selection.frames.size(), frames.size());  // every candidate in the end, and nothing is uncovered
  EXPECT_EQ(selection.radii.back(), 0.0);
  expect_farthest_points(selection, frames, expected_distances(database, reference, part(), frames), 1e-6);
  // Examples may come from what is excluded: it is not looked at only when covering.
  const std::vector<FrameId> held_out = {{.clip_idx = 1, .frame_idx = 0}};
  EXPECT_GT(covering_radii(database, reference, part(), held_out, options)[0], 0.01);
}

TEST(ExampleSelection, RepeatedShapesEndTheChoice) {
  const PerformanceDatabase five = random_database(5, 10);
  PerformanceDatabase repeated;
  for (const MeshSequence& clip : five.clips()) {
    MeshSequence longer(clip.name(), clip.topology(), 6 * clip.frame_count(), 25.0);
    for (std::size_t f = 0; f < longer.frame_count(); ++f) {
      longer.frame(f) = clip.frame(f % clip.frame_count());
    }
    repeated.add(std::move(longer));
  }
  const Positions reference = first_surface(five);
  const ExampleSelection exact =
      select_examples(repeated, reference, part(), {.count = all_examples, .smallest_radius = 0.0});
  EXPECT_EQ(exact.frames.size(), 5U);
  EXPECT_EQ(exact.radii.back(), 0.0);
  // Turned and shifted, the same shapes differ by the rounding of floats only.
  EXPECT_EQ(select_examples(rigidly_moved(repeated), reference, part()).frames.size(), 5U);
  // As soon as all frames are near enough, and not before.
  const std::vector<double>& radii = exact.radii;
  const ExampleSelection stopped =
      select_examples(repeated, reference, part(), {.smallest_radius = 0.5 * (radii[1] + radii[2])});
  EXPECT_EQ(stopped.frames.size(), 3U);
}

TEST(ExampleSelection, IsTheSameForAnyNumberOfThreads) {
  const PerformanceDatabase database = random_database(300, 11);
  std::vector<ExampleSelection> results;
  for (const std::size_t threads : {1, 4}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(select_examples(database, first_surface(database), part(), {.count = 60}));
  }
  EXPECT_EQ(results[0].frames, results[1].frames);
  EXPECT_EQ(results[0].radii, results[1].radii);
}

const BodyPart& part_named(const Markup& markup, const std::string& name) {
  return *std::ranges::find(markup.parts, name, &BodyPart::name);
}

TEST(ExampleSelection, OfTheFigureAreItsExtremePoses) {
  const PerformanceDatabase database = make_figure({.voxel_size = 0.05});
  const Markup& markup = *database.markup();
  const std::size_t wave = database.clip_idx("wave");
  const auto first_choices = [&](const std::string& name) {
    const ExampleSelection selection = select_examples(
        database, markup.reference, part_named(markup, name).vertices, {.count = 8, .stride = 2});
    EXPECT_LT(selection.radii.back(), 0.35 * selection.radii.front()) << name;
    return selection.frames;
  };
  // The hand is raised in one clip only, the legs stand still there.
  EXPECT_EQ(first_choices("right_arm")[1].clip_idx, wave);
  EXPECT_EQ(std::ranges::count(first_choices("left_leg"), wave, &FrameId::clip_idx), 0);
}

TEST(ExampleSelection, OfARealCaptureCoverIt) {
  REPRISE_REQUIRE_DATA();
  PerformanceDatabase database;
  for (const std::string name : {"crane", "jumping"}) {
    const auto reader = open_sequence({.path = test::data_folder() / "ama" / name});
    constexpr std::size_t step = 6;
    MeshSequence clip(name, reader->topology(), reader->frame_count() / step, 25.0 / step);
    for (std::size_t f = 0; f < clip.frame_count(); ++f) clip.frame(f) = reader->read(step * f).positions;
    database.add(std::move(clip));
  }
  const Positions reference = first_surface(database);
  const float waist = 0.5F * (reference.col(1).minCoeff() + reference.col(1).maxCoeff());
  std::vector<std::int32_t> legs;
  for (std::int32_t v = 0; v < reference.rows(); ++v) {
    if (reference(v, 1) < waist) legs.push_back(v);
  }
  const ExampleSelection selection = select_examples(database, reference, legs, {.count = 30});
  const std::vector<FrameId> frames = frames_of(database);
  expect_farthest_points(selection, frames, expected_distances(database, reference, legs, frames), 1e-6);
  // One leg is drawn up in one clip, both bend in the other: the choice needs both.
  EXPECT_NE(selection.frames[0].clip_idx, selection.frames[1].clip_idx);
  EXPECT_GT(selection.radii[0], 0.1);
  EXPECT_LT(selection.radii.back(), 0.4 * selection.radii.front());
}

TEST(ExampleSelection, BadInputIsNamed) {
  const PerformanceDatabase database = random_database(9, 12);
  const Positions reference = first_surface(database);
  const auto choose = [&](const std::vector<std::int32_t>& vertices, const ExampleOptions& options) {
    return [&database, &reference, vertices, options] {
      select_examples(database, reference, vertices, options);
    };
  };
  const auto names = [](const std::string& text) { return ThrowsMessage<InvalidArgument>(HasSubstr(text)); };
  // vertices out of range, unsorted, twice, too few, none
  EXPECT_THAT(choose({0, 5, 18}, {}), names("vertex 18: expected 0 to 17"));
  EXPECT_THAT(choose({-1, 5, 17}, {}), names("vertex -1"));
  EXPECT_THAT(choose({0, 5, 4}, {}), names("found 4 after 5"));
  EXPECT_THAT(choose({0, 5, 5}, {}), names("found 5 after 5"));
  EXPECT_THAT(choose({0, 5}, {}), names("2 vertices lie on a line"));
  EXPECT_THAT(choose({}, {}), names("0 vertices"));
  // options
  EXPECT_THAT(choose(part(), {.count = 0}), names("number of examples is 0"));
  EXPECT_THAT(choose(part(), {.stride = 0}), names("stride"));
  EXPECT_THAT(choose(part(), {.smallest_radius = std::nan("")}), names("smallest radius is nan"));
  EXPECT_THAT(choose(part(), {.excluded = {{.clip_idx = 2}}}), names("clip 2"));
  EXPECT_THAT(choose(part(), {.excluded = {{.clip_idx = 0, .frame_idx = 6}}}), names("6"));
  // nothing is left
  EXPECT_THAT(choose(part(), {.excluded = frames_of(database)}), names("9 of 9 are excluded"));
  EXPECT_THAT([&] { select_examples({}, reference, part()); }, names("no frame is left"));
  // a list with a frame that is not there
  const std::vector<FrameId> missing = {{.clip_idx = 0, .frame_idx = 99}};
  EXPECT_THROW(covering_radii(database, reference, part(), missing), InvalidArgument);
  // another surface
  EXPECT_THAT([&] { select_examples(database, Positions::Zero(17, 3), part()); }, names("has 17 vertices"));
  // not finite
  Positions broken = reference;
  broken(5, 1) = std::numeric_limits<float>::infinity();
  EXPECT_THAT([&] { select_examples(database, broken, part()); }, names("vertex 5"));
  PerformanceDatabase holed;
  for (MeshSequence clip : database.clips()) {
    if (clip.name() == "b") clip.frame(1)(7, 2) = std::nanf("");
    holed.add(std::move(clip));
  }
  EXPECT_THAT([&] { select_examples(holed, reference, part()); }, names("b:1 is not finite at vertex 7"));
}

}  // namespace
}  // namespace reprise
