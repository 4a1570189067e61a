// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Options that several commands share: which metric, and what the transitions are.

#pragma once

#include <CLI/CLI.hpp>

#include "reprise/pipeline/similarity.h"

namespace reprise::cli {

// --metric, --exact and the options of the histograms.
void add_metric_options(CLI::App& command, SimilarityOptions& options);
// --bins, --voxel and what else histograms are made with.
void add_histogram_options(CLI::App& command, HistogramOptions& options);

void add_transition_options(CLI::App& command, TransitionOptions& options);

}  // namespace reprise::cli
