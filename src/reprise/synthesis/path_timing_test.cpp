// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/path_timing.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/core/random.h"
#include "reprise/synthesis/smooth_course.h"

namespace reprise {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pointwise;
using ::testing::ThrowsMessage;

// Moments of a capture that a query passes through at a pace that swings about `pace`.
std::vector<double> moments(int count, double pace, double swing, std::uint64_t seed) {
  std::vector<double> times;
  double time = 0.0;
  for (int k = 0; k < count; ++k) {
    times.push_back(time);
    const double slow = std::sin(0.07 * k + static_cast<double>(seed)) + 0.4 * std::sin(0.2 * k);
    time += std::clamp(pace + swing * slow, 0.0, 2.0);
  }
  return times;
}

// The frames nearest to such moments, now and then another one: what is retrieved repeats and skips.
std::vector<int> retrieved(const std::vector<double>& times, std::uint64_t seed) {
  const RandomField field(seed);
  std::vector<int> frames;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const auto frame = static_cast<int>(std::lround(times[k] + 0.3 * field.normal_pair(k, 0)[0]));
    frames.push_back(frames.empty() ? 0 : std::clamp(frame, frames.back(), frames.back() + 2));
  }
  return frames;
}

std::vector<int> uneven_follow(int count, double swing, std::uint64_t seed) {
  return retrieved(moments(count, 1.0, swing, seed), seed);
}

std::vector<double> as_times(const std::vector<int>& frames) {
  return {frames.begin(), frames.end()};
}

// Sum of squared second differences.
double roughness(std::span<const double> times) {
  double sum = 0.0;
  for (std::size_t k = 1; k + 1 < times.size(); ++k) {
    sum += std::pow(times[k + 1] - 2.0 * times[k] + times[k - 1], 2);
  }
  return sum;
}

double roughness(const std::vector<double>& times) {
  return roughness(std::span<const double>(times));
}

TEST(PathTiming, RepeatsAreTheFramesThemselves) {
  const std::vector<int> frames = uneven_follow(100, 0.6, 1);
  EXPECT_EQ(path_times(frames, Timing::repeats), as_times(frames));
}

TEST(PathTiming, LinearIsThePapers) {
  // HSSMG 5.2.2: of n repeats, the j-th is alpha = j / n of the way to what comes next, a skip as well.
  const std::vector<int> frames = {0, 1, 1, 1, 1, 2, 3, 3, 5, 6, 6};
  EXPECT_THAT(path_times(frames, Timing::linear),
              ElementsAre(0.0, 1.0, 1.25, 1.5, 1.75, 2.0, 3.0, 4.0, 5.0, 6.0, 6.0));
}

TEST(PathTiming, AnEvenFollowStaysAsItIs) {
  std::vector<int> frames;
  for (int k = 0; k < 50; ++k) frames.push_back(k + 7);
  for (const Timing timing : {Timing::repeats, Timing::linear, Timing::smooth}) {
    EXPECT_EQ(path_times(frames, timing), as_times(frames));
  }
  // Far from the one repeat in the middle as well.
  frames.insert(frames.begin() + 25, frames[24]);
  const std::vector<double> times = path_times(frames, Timing::smooth);
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (k < 15 || k > 35) {
      EXPECT_EQ(times[k], frames[k]) << k;
    }
  }
}

TEST(PathTiming, NeverGoesBackAndKeepsTheEnds) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const std::vector<int> frames =
        uneven_follow(5 + 30 * static_cast<int>(seed), 0.05 * static_cast<double>(seed), seed);
    for (const Timing timing : {Timing::linear, Timing::smooth}) {
      const std::vector<double> times = path_times(frames, timing);
      ASSERT_EQ(times.size(), frames.size());
      EXPECT_EQ(times.front(), frames.front());
      EXPECT_EQ(times.back(), frames.back());
      EXPECT_TRUE(std::ranges::is_sorted(times)) << seed;
    }
  }
}

TEST(PathTiming, SmoothStaysNearWhatWasRetrieved) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const std::vector<int> frames = uneven_follow(300, 0.1 + 0.05 * static_cast<double>(seed), seed);
    const std::vector<double> smooth = path_times(frames, Timing::smooth);
    EXPECT_THAT(smooth, Pointwise(DoubleNear(1.0 + 1e-12), as_times(frames)));
    EXPECT_LT(roughness(smooth), 0.2 * roughness(path_times(frames, Timing::linear))) << seed;
  }
}

TEST(PathTiming, EachTimingIsNearerToThePaceOfTheQuery) {
  // What was retrieved knows whole frames only; the query's own pace is known here.
  for (const double pace : {0.4, 0.7, 1.0, 1.3}) {
    double squares[3] = {};
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      const std::vector<double> truth = moments(200, pace, 0.3, seed);
      const std::vector<int> frames = retrieved(truth, seed);
      for (const Timing timing : {Timing::repeats, Timing::linear, Timing::smooth}) {
        const std::vector<double> times = path_times(frames, timing);
        for (std::size_t k = 0; k + 1 < times.size(); ++k) {
          squares[static_cast<int>(timing)] +=
              std::pow((times[k + 1] - times[k]) - (truth[k + 1] - truth[k]), 2);
        }
      }
    }
    EXPECT_LT(squares[1], squares[0]) << pace;
    EXPECT_LT(squares[2], 0.2 * squares[1]) << pace;
  }
}

TEST(PathTiming, AnEvenlySlowedMotionIsPlayedAtAnEvenPace) {
  // Two frames of the capture in three of the query: the paper's course still changes its pace all the time.
  std::vector<int> frames;
  for (int k = 0; k <= 60; ++k) frames.push_back((2 * k + 1) / 3);
  const std::vector<double> times = path_times(frames, Timing::smooth);
  for (std::size_t k = 0; k < times.size(); ++k) {
    EXPECT_NEAR(times[k], 2.0 * static_cast<double>(k) / 3.0, 0.01) << k;
  }
  EXPECT_GT(roughness(path_times(frames, Timing::linear)), 1.0);
}

// The optimality of the program itself: no feasible row near the result costs less (it is convex, so none
// anywhere does).
TEST(SmoothCourse, NoAllowedChangeCostsLess) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const CourseLimits limits{.pull = seed % 2 == 0 ? 0.0 : 0.02, .farthest = 0.4};
    const std::vector<double> given = as_times(uneven_follow(60, 0.5, seed));
    std::vector<double> course = given;
    const std::size_t last = course.size() - 1;
    smooth_course(course, 1, last, limits);
    const auto cost = [&](const std::vector<double>& row) {
      double sum = roughness(row);
      for (std::size_t k = 0; k < row.size(); ++k) sum += limits.pull * std::pow(row[k] - given[k], 2);
      return sum;
    };
    const double least = cost(course);
    const auto allowed = [&](const std::vector<double>& row) {
      for (std::size_t k = 0; k < row.size(); ++k) {
        if (std::abs(row[k] - given[k]) > limits.farthest + 1e-12 || (k > 0 && row[k] < row[k - 1]))
          return false;
      }
      return true;
    };
    ASSERT_TRUE(allowed(course));
    // Moves of one sample, of a stretch, and mixtures with another allowed row.
    std::size_t tried = 0;
    for (std::size_t begin = 1; begin < last; ++begin) {
      for (const std::size_t length : {1, 2, 5, 20}) {
        for (const double step : {-0.2, -1e-3, 1e-3, 0.2}) {
          std::vector<double> other = course;
          for (std::size_t k = begin; k < std::min(begin + length, last); ++k) other[k] += step;
          if (!allowed(other)) continue;
          ++tried;
          EXPECT_GE(cost(other), least - 1e-9);
        }
      }
    }
    EXPECT_GT(tried, 100U);
    for (const double share : {1e-3, 0.1, 1.0}) {
      std::vector<double> other = course;
      for (std::size_t k = 0; k < other.size(); ++k) other[k] += share * (given[k] - other[k]);
      EXPECT_GE(cost(other), least - 1e-9);
    }
  }
}

TEST(SmoothCourse, WithoutLimitsInTheWayItIsTheSpline) {
  // Normal equations of the least squares: the fourth difference and the pull are in balance everywhere.
  for (const double pull : {0.0, 0.05}) {
    std::vector<double> given;
    for (int k = 0; k < 40; ++k) given.push_back(k < 20 ? k : 20.0 + 0.8 * (k - 20));
    std::vector<double> course = given;
    smooth_course(course, 2, 38, {.pull = pull, .farthest = 100.0});
    for (std::size_t k = 2; k < 38; ++k) {
      const double fourth =
          course[k - 2] - 4.0 * course[k - 1] + 6.0 * course[k] - 4.0 * course[k + 1] + course[k + 2];
      EXPECT_NEAR(fourth + pull * (course[k] - given[k]), 0.0, 1e-8) << k;
    }
    EXPECT_EQ(course[1], given[1]);
    EXPECT_EQ(course[38], given[38]);
  }
}

TEST(PathTiming, SmallestCases) {
  for (const Timing timing : {Timing::repeats, Timing::linear, Timing::smooth}) {
    EXPECT_THAT(path_times({}, timing), ElementsAre());
    EXPECT_THAT(path_times({4}, timing), ElementsAre(4.0));
    EXPECT_THAT(path_times({0, 2}, timing), ElementsAre(0.0, 2.0));
    EXPECT_THAT(path_times({3, 3, 3}, timing), ElementsAre(3.0, 3.0, 3.0));
  }
}

TEST(PathTiming, RefusesWhatIsNoFollow) {
  EXPECT_THAT(
      [] {
        (void)path_times({0, 1, 0}, Timing::linear);
      },
      ThrowsMessage<InvalidArgument>(HasSubstr("path frame 0 at query frame 2 follows 1")));
  EXPECT_THAT(
      [] {
        (void)path_times({-1, 0}, Timing::smooth);
      },
      ThrowsMessage<InvalidArgument>(HasSubstr("from frame -1")));
}

}  // namespace
}  // namespace reprise
