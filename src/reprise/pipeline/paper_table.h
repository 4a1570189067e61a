// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What HSSMG Table III prints.

#pragma once

#include <span>
#include <string>

#include "reprise/database/performance_database.h"

namespace reprise {

struct PaperRow {
  const char* costume;
  const char* from;  // CLIP:FRAME, with the clip names of the built-in performer
  const char* to;
  // Metres. The printed columns are swapped: what stands under "min" is the greater one.
  double smoothness_min, smoothness_max;
  double distance_min, distance_rms, distance_max;  // metres
  double time_min, time_rms, time_max;              // seconds
  double cpu_mean, cpu_deviation;                   // seconds a query
};

// Its twelve rows, four a costume, in the order of the paper.
std::span<const PaperRow> paper_table();

// The rows of one costume that the database has the key-frames of: the costume that `name` (that of the
// database) mentions, otherwise the first; empty if there is none.
std::span<const PaperRow> paper_rows(const PerformanceDatabase& database, const std::string& name);

}  // namespace reprise
