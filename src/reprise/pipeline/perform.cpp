// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/perform.h"

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/io/database_file.h"

namespace reprise {

PerformReport perform(const std::filesystem::path& database, const PerformOptions& options) {
  if (options.costume != "figure") {
    throw InvalidArgument(fmt::format("there is no costume '{}'; expected figure", options.costume));
  }
  const PerformanceDatabase performance = make_figure(options.figure);
  save_database(performance, database);
  return {.clips = performance.clips().size(),
          .frames = performance.frame_count(),
          .vertices = static_cast<std::size_t>(performance.topology()->vertex_count)};
}

}  // namespace reprise
