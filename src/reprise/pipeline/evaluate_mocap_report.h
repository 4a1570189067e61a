// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The tables and pictures of `evaluate_mocap`.

#pragma once

#include "reprise/pipeline/evaluate_mocap.h"

namespace reprise {

std::string mocap_markdown(const std::vector<MocapTrial>& trials, const MocapEvaluationOptions& options);
std::string mocap_csv(const std::vector<MocapTrial>& trials);
std::string mocap_times_csv(const std::vector<MocapTrial>& trials);
std::string mocap_truth_csv(const std::vector<MocapTrial>& trials);
// walks.png and runs.png in `folder`, as far as there are such trials.
void plot_mocap(const std::vector<MocapTrial>& trials, const std::filesystem::path& folder);
void plot_mocap_truth(const std::vector<MocapTrial>& trials, const std::filesystem::path& png);

}  // namespace reprise
