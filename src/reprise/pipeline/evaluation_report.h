// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The tables of `evaluate_similarity`.

#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "reprise/pipeline/evaluate_similarity.h"

namespace reprise {

// For people: Markdown, with the protocol and what was left out.
std::string evaluation_markdown(const SimilarityEvaluation& evaluation,
                                const SimilarityEvaluationOptions& options);
// For spreadsheets: one row a metric; a field is empty where nothing could be measured.
std::string evaluation_csv(const SimilarityEvaluation& evaluation);
// For programs: everything, null where nothing could be measured.
nlohmann::ordered_json evaluation_json(const SimilarityEvaluation& evaluation,
                                       const SimilarityEvaluationOptions& options);

}  // namespace reprise
