// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Parallel loops. Results never depend on the number of threads: each index writes only its own output.

#pragma once

#include <cstddef>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace reprise {

// Calls `body(i)` for every i in [begin, end), in parallel and in no particular order. An exception thrown by
// any call ends the loop and is thrown on. `grain` > 0: smallest number of indices worth handing to another
// thread.
template <typename Body>
void parallel_for(std::size_t begin, std::size_t end, const Body& body, std::size_t grain = 1) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end, grain),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
                    });
}

}  // namespace reprise
