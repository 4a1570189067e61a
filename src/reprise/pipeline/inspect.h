// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stages "info" and "validate": what a database holds, and what is wrong with a database or a folder of
// frames.

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace reprise {

// What a database file holds, without its frames: path, format version, vertices, triangles, UVs, size of the
// texture, markup (joints, parts and layers with their vertex counts), models (part and whole: parts with
// their vertices, components, examples and kept variance), and for each clip its name, frames, rate, seconds,
// and whether it has colours, normals, provenance and truth. What is missing is null.
nlohmann::json describe_database(const std::filesystem::path& database);

struct Finding {
  enum class Severity { warning, error };
  Severity severity = Severity::warning;
  std::string where;  // file, or clip and frame
  std::string what;
};

struct ValidationReport {
  std::size_t frames = 0;  // looked at
  std::vector<Finding> findings;
  bool ok() const;  // no error; warnings may stand
};

// Looks at every frame of a database file, or of a sequence in files, and goes on after a bad one. Errors:
// frames that cannot be read or used. Warnings: open or non-manifold edges, several components, triangles of
// zero area, clips of different rates, and frames in which a vertex moves farther than half the size of the
// surface.
ValidationReport validate_path(const std::filesystem::path& path);

}  // namespace reprise
