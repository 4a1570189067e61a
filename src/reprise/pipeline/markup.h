// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "markup": joints, parts and layers for a database that has none, from landmarks or from a file.

#pragma once

#include <filesystem>
#include <string>

#include "reprise/database/markup.h"

namespace reprise {

struct MarkupOptions {
  std::filesystem::path landmarks;   // JSON of named vertices, from which a markup is proposed
  std::filesystem::path file;        // or JSON of a whole markup
  std::string frame;                 // "CLIP:FRAME" to mark up; empty: the one the file names
  bool keep_joints = false;          // leave proposed joints where the landmarks put them
  std::filesystem::path write_json;  // where to write the markup as JSON; empty: nowhere
};

// Proposed joints are then moved to where the bones on both sides of them agree best through all clips
// (`refine_joints`).
//
// Reads a database, gives it a markup and writes it to `output` with everything else it holds (the truth of
// its clips only if the skeleton stays). Without landmarks and file the markup it has is written as JSON, and
// `output` must be empty. Returns the markup. Throws `InvalidArgument`, `FileError`.
Markup mark_up(const std::filesystem::path& database, const MarkupOptions& options,
               const std::filesystem::path& output);

}  // namespace reprise
