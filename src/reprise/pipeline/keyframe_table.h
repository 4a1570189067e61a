// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What `evaluate_keyframes` writes: tables and pictures of the grids.

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reprise/pipeline/keyframe_figures.h"

namespace reprise {

// Rows of the table: each pair, and after the pairs of a database all of them together.
struct TableRow {
  std::string database;
  const GridResult* pair = nullptr;  // null: all pairs of the database
  std::vector<const GridResult*> results;

  std::string name() const;  // "stand:1 -> hit:45", or "all pairs"
};
std::vector<TableRow> table_rows(const std::vector<GridResult>& results);

// For people: Markdown, with the protocol.
std::string keyframe_markdown(const std::vector<GridResult>& results,
                              const EvaluateKeyframesOptions& options);

// For spreadsheets; a field is empty where there is nothing to say. Numbers are written so that reading gives
// back the same bits.
std::string keyframe_table_csv(const std::vector<GridResult>& results);
std::string queries_csv(const std::vector<GridResult>& results);
std::string times_csv(const std::vector<GridResult>& results);
std::string unreachable_csv(const std::vector<GridResult>& results, const KeyframeOptions& options);
std::string samples_csv(const std::vector<GridResult>& results);

// table.png and errors-DATABASE-FROM-TO.png.
void draw_table(const std::vector<GridResult>& results, const std::filesystem::path& png);
void draw_errors(const KeyframeGrid& grid, const EvaluateKeyframesOptions& options,
                 const std::filesystem::path& png);

}  // namespace reprise
