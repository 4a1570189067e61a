// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "evaluate mocap": how well the character follows a corpus of motion capture (HSSMG 6.2, Figures 13
// and 14), and how near the result is to what the performer really does.

#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "reprise/pipeline/mocap_trial.h"

namespace reprise {

struct MocapEvaluationOptions {
  std::filesystem::path corpus;     // index in CSV (`read_corpus`)
  std::vector<std::string> tiers;   // of the corpus; empty: all
  std::vector<std::string> trials;  // empty: all
  // Other databases of the same surface: a clip TRIAL is what the performer does in that trial.
  std::vector<std::filesystem::path> truth;
  // Trial -> clip of the database that shows the performer in that very trial: for it nothing is shown of
  // the clip nor learnt from it, and the clip is the truth.
  std::map<std::string, std::string> held;
  MocapStageOptions mocap;
};

// A JSON object {"walk": "07_01", ...}: clip -> trial. Throws `FileError` for anything else, and for a trial
// or a clip named twice.
std::map<std::string, std::string> read_held_clips(const std::filesystem::path& path);

// Writes into `folder`, which is made if it is missing, each whole or not at all:
//   mocap.md, mocap.csv    a row a trial, and means of the walks and the runs beside the paper's
//   walks.png, runs.png    Figures 13 and 14
//   truth.csv, truth.png   errors of every method against the truth, if there is one
//   times.csv              the only file, beside mocap.md, that two runs differ in
// Whole trials are shared over MPI ranks; the first writes. A trial that fails is listed with its reason, the
// others go on. Returns all trials in the order of the corpus. Throws before the long work: `InvalidArgument`
// for a trial, tier or clip that does not exist, a truth of another surface or rate; what `MocapStage`
// throws; `FileError`; `Cancelled`.
std::vector<MocapTrial> evaluate_mocap(const std::filesystem::path& database,
                                       const std::filesystem::path& folder,
                                       const MocapEvaluationOptions& options);

}  // namespace reprise
