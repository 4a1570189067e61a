// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "import": sequences of frames on disk become a database file.

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reprise/io/sequence_reader.h"

namespace reprise {

struct ImportSequence {
  std::string name;  // of the clip
  SequenceSource source;
  double frames_per_second = 0.0;  // 0: the rate the file states, else 25
};

struct ImportOptions {
  std::vector<ImportSequence> sequences;
  bool append = false;  // keep the clips of an existing database and add these
};

struct ImportReport {
  std::size_t clips = 0;   // imported now
  std::size_t frames = 0;  // imported now
  std::size_t bytes = 0;   // of the source files
  double seconds = 0.0;
};

// Parses "NAME=PATH[,fps=25][,topology=FILE][,scale=0.01][,id=SEQUENCE]". Throws `InvalidArgument`.
ImportSequence parse_import_sequence(const std::string& text);

// Frames are read in parallel and written in order as they come, so memory does not grow with the clip. The
// database appears whole or not at all; an older one is kept if anything fails. Throws `FileError`,
// `InvalidArgument`, `Cancelled`.
ImportReport import_sequences(const std::filesystem::path& database, const ImportOptions& options);

}  // namespace reprise
