// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A folder of motion-capture trials with an index.

#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "reprise/io/motion_file.h"

namespace reprise {

struct CorpusTrial {
  std::string trial;         // "07_01"
  std::string motion_class;  // "walk", "run", ...
  std::string description;
  std::string tier;        // part of the corpus: "core", "veer", ...
  std::size_t frames = 0;  // of the file, as the index says; 0: it does not
  std::string flags;       // what the index says is wrong with it
  MotionSource source;
};

// Reads an index in CSV with a head row that names its columns: `trial`, and if there are any `subject`,
// `class`, `description`, `tier`, `frames`, `fps`, `flags`; others are not looked at. Fields with commas
// stand in double quotes. The motion of a trial is amc/TRIAL.amc with asf/SUBJECT.asf beside the index (the
// subject is otherwise what stands before the '_'), else bvh/TRIAL.bvh. Throws `FileError` naming the line:
// no such column, too few fields, an open quote, a number that is none, a trial twice or without a motion
// file.
std::vector<CorpusTrial> read_corpus(const std::filesystem::path& index);

// Those of the tiers, if any is given, and of the names, if any is given; in the order of the corpus. Throws
// `InvalidArgument` for a tier or a trial that is not there (offers the nearest), and if none is left.
std::vector<CorpusTrial> chosen_trials(std::vector<CorpusTrial> corpus, const std::vector<std::string>& tiers,
                                       const std::vector<std::string>& trials);

}  // namespace reprise
