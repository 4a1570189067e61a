// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The tables and pictures of `evaluate_deformation`.

#pragma once

#include "reprise/pipeline/deformation_bench.h"

namespace reprise {

// For people: Markdown, with the protocol and what was left out.
std::string deformation_markdown(const DeformationEvaluation& evaluation,
                                 const DeformationEvaluationOptions& options);
// For spreadsheets: a row a model, source and number of constraints; metres. Empty: not measured.
std::string deformation_csv(const DeformationEvaluation& evaluation);
// A row a trial.
std::string deformation_frames_csv(const DeformationEvaluation& evaluation);

// Mean and worst errors as a figure.
void plot_deformation(const DeformationEvaluation& evaluation, const std::filesystem::path& png);

// A row a frame: as captured, and what each model makes of the first learnt frame under `count` constraints.
void draw_deformation(const DeformationBench& bench, const std::vector<HeldFrame>& frames, std::size_t count,
                      const std::filesystem::path& png);

}  // namespace reprise
