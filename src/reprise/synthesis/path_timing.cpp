// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/path_timing.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/synthesis/smooth_course.h"

namespace reprise {
namespace {

// Frames on both sides of a repeat or a skip over which the pace may change. Beyond, captured frames are
// shown as they are.
constexpr std::size_t near = 8;

void check(const std::vector<int>& path_frame) {
  if (!path_frame.empty() && path_frame.front() < 0) {
    throw InvalidArgument(fmt::format("the path is shown from frame {}: expected 0 or more", path_frame[0]));
  }
  for (std::size_t k = 1; k < path_frame.size(); ++k) {
    if (path_frame[k] < path_frame[k - 1]) {
      throw InvalidArgument(
          fmt::format("path frame {} at query frame {} follows {}: expected an ascending row", path_frame[k],
                      k, path_frame[k - 1]));
    }
  }
}

// HSSMG 5.2.2: alpha(j) = j / n from each run of n repeats to what comes next.
std::vector<double> linear_times(const std::vector<int>& path_frame) {
  const std::size_t count = path_frame.size();
  std::vector<double> times(path_frame.begin(), path_frame.end());
  for (std::size_t begin = 0; begin < count;) {
    std::size_t end = begin + 1;
    while (end < count && path_frame[end] == path_frame[begin]) ++end;
    if (end < count) {
      const double n = static_cast<double>(end - begin);
      for (std::size_t k = begin; k < end; ++k) {
        times[k] += (path_frame[end] - path_frame[begin]) * (static_cast<double>(k - begin) / n);
      }
    }
    begin = end;
  }
  return times;
}

// Samples that stay: the ends, and those with an even pace all around.
std::vector<bool> fixed_samples(const std::vector<int>& path_frame) {
  const std::size_t count = path_frame.size();
  std::vector<bool> is_fixed(count, true);
  for (std::size_t k = 0; k + 1 < count; ++k) {
    if (path_frame[k + 1] == path_frame[k] + 1) continue;
    const std::size_t first = k + 1 > near ? k + 1 - near : 1;
    const std::size_t last = std::min(count - 1, k + near + 1);
    std::fill(is_fixed.begin() + static_cast<std::ptrdiff_t>(std::min(first, last)),
              is_fixed.begin() + static_cast<std::ptrdiff_t>(last), false);
  }
  return is_fixed;
}

std::vector<double> smooth_times(const std::vector<int>& path_frame) {
  // What is retrieved is off by half a frame, the nearest being shown, and by more among frames that hardly
  // differ. This pull rounds off what lasts less than some 15 frames.
  constexpr CourseLimits limits{.pull = 0.03, .farthest = 1.0};
  std::vector<double> times(path_frame.begin(), path_frame.end());
  const std::vector<bool> is_fixed = fixed_samples(path_frame);
  for (std::size_t begin = 0; begin < times.size();) {
    if (is_fixed[begin]) {
      ++begin;
      continue;
    }
    std::size_t end = begin;
    while (!is_fixed[end]) ++end;  // the last one is
    // With one sample more on each side, where there is one: the pace there is kept as well.
    const std::size_t first = begin - std::min<std::size_t>(begin, 2);
    const std::size_t last = std::min(times.size(), end + 2);
    smooth_course(std::span(times).subspan(first, last - first), begin - first, end - first, limits);
    begin = end;
  }
  return times;
}

}  // namespace

std::vector<double> path_times(const std::vector<int>& path_frame, Timing timing) {
  check(path_frame);
  switch (timing) {
    case Timing::linear:
      return linear_times(path_frame);
    case Timing::smooth:
      return smooth_times(path_frame);
    case Timing::repeats:
      break;
  }
  return {path_frame.begin(), path_frame.end()};
}

}  // namespace reprise
