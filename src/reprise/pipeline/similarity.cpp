// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/similarity.h"

#include <chrono>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/hash.h"
#include "reprise/core/log.h"
#include "reprise/similarity/vertex_metric.h"

namespace reprise {
namespace {

// Part of the cache key: raise it when the values of a metric change.
constexpr int vertex_metric_revision = 1;

std::string matrix_key(const PerformanceDatabase& database, const SimilarityOptions& options) {
  return ContentHash()
      .add(database.content_hash())
      .add(options.metric)
      .add_number(vertex_metric_revision)
      .hex();
}

}  // namespace

SimilarityResult compute_similarity(const PerformanceDatabase& database,
                                    const std::filesystem::path& database_path,
                                    const SimilarityOptions& options) {
  if (options.metric != "vertex") {
    throw InvalidArgument(fmt::format("there is no metric '{}'; expected vertex", options.metric));
  }
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const std::string key = matrix_key(database, options);
  std::filesystem::path folder = database_path;
  folder += ".cache";
  const std::filesystem::path file = folder / fmt::format("{}-{}.matrix", options.metric, key.substr(0, 16));

  if (options.use_cache && std::filesystem::exists(file)) {
    try {
      DissimilarityMatrix matrix = DissimilarityMatrix::load(file);
      if (matrix.key() == key) return {.matrix = std::move(matrix), .from_cache = true, .seconds = elapsed()};
    } catch (const FileError& error) {
      spdlog::warn("{}; the matrix is computed anew", error.what());
    }
  }

  DissimilarityMatrix matrix = vertex_dissimilarity(database);
  matrix.set_key(key);
  if (options.use_cache) {
    try {
      std::filesystem::create_directories(folder);
      matrix.save(file);
    } catch (
        const std::exception& error) {  // a read-only folder or a full disk costs the cache, not the result
      spdlog::warn("the matrix is not kept: {}", error.what());
    }
  }
  return {.matrix = std::move(matrix), .from_cache = false, .seconds = elapsed()};
}

}  // namespace reprise
