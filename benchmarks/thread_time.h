// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <ctime>

namespace reprise::benchmark {

// Processor time of this thread in milliseconds: other work on the machine does not count.
inline double thread_ms() {
  timespec time = {};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

}  // namespace reprise::benchmark
