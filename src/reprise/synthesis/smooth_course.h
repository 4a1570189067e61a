// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The smoothest row of numbers beside a given one. Internal.

#pragma once

#include <cstddef>
#include <span>

namespace reprise {

struct CourseLimits {
  double pull = 0.0;      // of each sample towards where it was, per squared distance
  double farthest = 1.0;  // no sample moves farther than this
};

// Changes the samples first .. last - 1 of `course` so that the sum of the squared second differences of all
// of it and of `pull` times the squared distances moved is least, within `farthest` and without going
// backwards anywhere. `course` goes nowhere backwards; `first` > 0 and `last` < its size. A quadratic program
// with five diagonals, solved by an interior-point method in time linear in the number of samples.
void smooth_course(std::span<double> course, std::size_t first, std::size_t last, const CourseLimits& limits);

}  // namespace reprise
