// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// `evaluate keyframes`: HSSMG Table III, a grid of targets for pairs of key-frames of one or more databases.

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reprise/path/keyframe_query.h"
#include "reprise/synthesis/correction.h"

namespace reprise {

// One row of the table.
struct GridPair {
  std::string from;  // CLIP:FRAME
  std::string to;
};

struct GridDatabase {
  std::filesystem::path database;
  std::filesystem::path graph;  // empty: made with default options, as `reprise graph` does
  std::vector<GridPair> pairs;  // empty: those of the paper, if the database has their frames
};

struct EvaluateKeyframesOptions {
  int max_distance = 20;  // metres: targets 1 .. max_distance
  int max_time = 40;      // seconds: targets 1 .. max_time
  // Queries whose frames are synthesised and measured, spread evenly over all pairs and targets; 0: none.
  int samples = 200;
  // A target is reachable if its optimum misses it by at most this: metres and seconds. The defaults are the
  // largest errors in the paper's table.
  double reach_distance = 1.0;
  double reach_time = 1.0;
  KeyframeOptions optimizer = {.max_labels = 20'000'000};  // a table wants certificates
  CorrectionOptions correction;
  bool resume = true;  // what an earlier run with the same options and inputs has finished is kept
};

// Writes into `folder`, which is made if it is missing, each whole or not at all:
//   table.md, table.csv   a row a pair and a row a database, beside what the paper prints
//   table.png             the same as a figure
//   queries.csv           every target: the optimum, its certificate, what the correction would make of it
//   times.csv             CPU seconds of every query; the only file, beside table.*, that two runs differ in
//   unreachable.csv       targets out of reach: the path found, and the nearest target within reach
//   samples.csv           predicted and measured figures of the sampled queries
//   errors-DATABASE-FROM-TO.png  distance and time errors over the grid, before and after the correction
//   finished/             what is kept of each pair, so that a run that was stopped continues
// Everything is checked before the long work starts. Throws `InvalidArgument` for options out of range, no
// database, a key-frame a database does not have, a pair listed twice, a graph of another database, and a
// database that has none of the paper's key-frames and no pairs; `FileError`; `Error` if the graph has no
// path for a pair; `Cancelled` if the user asks to stop.
void evaluate_keyframes(const std::vector<GridDatabase>& databases, const std::filesystem::path& folder,
                        const EvaluateKeyframesOptions& options = {});

}  // namespace reprise
