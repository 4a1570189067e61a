// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/paper_table.h"

#include <algorithm>

#include "reprise/core/error.h"

namespace reprise {
namespace {

constexpr std::size_t rows_per_costume = 4;

constexpr PaperRow rows[] = {
    {"character1", "stand:1", "hit:45", 0.02, 0.04, 0.0001, 0.17, 0.96, 0.0, 0.16, 0.88, 14.43, 7.05},
    {"character1", "stand:1", "walk:16", 0.03, 0.04, 0.0002, 0.21, 0.92, 0.0, 0.17, 0.92, 12.21, 4.74},
    {"character1", "walk:16", "jog:13", 0.03, 0.04, 0.0001, 0.21, 0.96, 0.0, 0.19, 0.96, 13.54, 4.98},
    {"character1", "jog:13", "hit:45", 0.03, 0.04, 0.0002, 0.20, 0.98, 0.0, 0.15, 0.96, 12.20, 3.42},
    {"fashion1", "pose:1", "twirl:85", 0.02, 0.06, 0.0001, 0.23, 0.95, 0.0, 0.15, 0.96, 12.79, 2.92},
    {"fashion1", "pose:1", "walk:15", 0.02, 0.06, 0.0001, 0.47, 0.99, 0.0, 0.17, 0.96, 5.65, 1.46},
    {"fashion1", "walk:15", "walk_pose:37", 0.01, 0.04, 0.0000, 0.33, 1.00, 0.0, 0.23, 1.00, 12.01, 4.85},
    {"fashion1", "walk_pose:37", "twirl:85", 0.02, 0.04, 0.0001, 0.29, 1.00, 0.0, 0.19, 1.00, 10.10, 3.07},
    {"fashion2", "pose:1", "twirl:100", 0.02, 0.04, 0.0000, 0.23, 0.95, 0.0, 0.31, 1.00, 12.87, 3.61},
    {"fashion2", "pose:1", "walk:15", 0.02, 0.05, 0.0008, 0.39, 0.98, 0.0, 0.35, 1.00, 7.09, 1.91},
    {"fashion2", "walk:15", "walk_pose:37", 0.02, 0.04, 0.0002, 0.36, 1.00, 0.0, 0.33, 1.00, 14.95, 6.11},
    {"fashion2", "walk_pose:37", "twirl:100", 0.02, 0.04, 0.0002, 0.28, 1.00, 0.0, 0.33, 0.96, 10.51, 2.77}};

bool has_frame(const PerformanceDatabase& database, const char* frame) {
  try {
    static_cast<void>(database.parse_frame(frame));
    return true;
  } catch (const InvalidArgument&) {
    return false;
  }
}

}  // namespace

std::span<const PaperRow> paper_table() {
  return rows;
}

std::span<const PaperRow> paper_rows(const PerformanceDatabase& database, const std::string& name) {
  std::span<const PaperRow> first;
  for (std::size_t r = 0; r < std::size(rows); r += rows_per_costume) {
    const std::span<const PaperRow> costume(rows + r, rows_per_costume);
    const bool has_all = std::ranges::all_of(costume, [&](const PaperRow& row) {
      return has_frame(database, row.from) && has_frame(database, row.to);
    });
    if (!has_all) continue;
    if (name.find(costume.front().costume) != std::string::npos) return costume;
    if (first.empty()) first = costume;
  }
  return first;
}

}  // namespace reprise
