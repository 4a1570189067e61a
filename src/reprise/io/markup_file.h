// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Markup and landmarks as JSON files (docs/markup.md): made by hand or by other programs, for captures that
// have none. Errors name the file and the field.

#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "reprise/database/performance_database.h"

namespace reprise {

// Reads a markup for a database. `frame` ("CLIP:FRAME"), if not empty, is the reference surface instead of
// the one the file names. A joint without a position stands in the middle of the border between its vertices
// and those of its parent, or, where the two do not meet, at the centroid of its vertices. Throws `FileError`
// for a damaged file and for contents that do not fit the database.
Markup read_markup_file(const std::filesystem::path& path, const PerformanceDatabase& database,
                        const std::string& frame = {});

// Writes the markup of a database so that `read_markup_file` gives it back, whole or not at all. The
// reference surface is written as a frame's name if it is one, else vertex by vertex. Throws
// `InvalidArgument` if the database has no markup, `FileError` if the file cannot be written.
void write_markup_file(const PerformanceDatabase& database, const std::filesystem::path& path);

// Vertices with names, from which `propose_markup` makes a markup.
struct LandmarkFile {
  std::string frame;  // "CLIP:FRAME" that shows the pose they were chosen on; empty if the file names none
  std::map<std::string, std::int32_t> landmarks;
};
LandmarkFile read_landmark_file(const std::filesystem::path& path);

}  // namespace reprise
