// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "perform": the database of a synthetic performer.

#pragma once

#include <filesystem>
#include <string>

#include "reprise/synthetic/figure.h"

namespace reprise {

struct PerformOptions {
  std::string costume = "figure";  // the clothed capsule figure
  FigureOptions figure;
};

struct PerformReport {
  std::size_t clips = 0;
  std::size_t frames = 0;
  std::size_t vertices = 0;
};

// Writes the database whole or not at all. Throws `InvalidArgument` for an unknown costume, `FileError`.
PerformReport perform(const std::filesystem::path& database, const PerformOptions& options = {});

}  // namespace reprise
