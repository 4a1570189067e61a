// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Lists of example frames as JSON files (docs/learning.md): the user's own choice, or an automatic one to
// look through and edit. Errors name the file and the field.

#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "reprise/database/performance_database.h"

namespace reprise {

struct ExampleList {
  std::vector<FrameId> frames;  // for every part without a list of its own; may be empty
  std::map<std::string, std::vector<FrameId>> frames_of_part;

  // The frames a part is to learn from; empty if the list does not say.
  const std::vector<FrameId>& of(const std::string& part) const;
};

// Reads a list for a database: frames as `parse_frames` takes them, in the order given, repeated ones once.
// Throws `FileError` for a damaged file, frames that the database does not have, a part that is not in
// `part_names`, and a list without frames.
ExampleList read_example_file(const std::filesystem::path& path, const PerformanceDatabase& database,
                              std::span<const std::string> part_names);

// Writes a list so that `read_example_file` gives it back, whole or not at all; runs of frames as ranges.
// Throws `InvalidArgument` for a frame that the database does not have and for a list without frames,
// `FileError` if the file cannot be written.
void write_example_file(const ExampleList& list, const PerformanceDatabase& database,
                        const std::filesystem::path& path);

}  // namespace reprise
