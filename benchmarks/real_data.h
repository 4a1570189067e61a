// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The real captures that benchmarks measure on, read from the folder that REPRISE_DATA names.

#pragma once

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "reprise/core/parallel.h"
#include "reprise/database/performance_database.h"
#include "reprise/io/sequence_reader.h"

namespace reprise::benchmark {

// The folder, or an end of the program that says what is missing.
inline std::filesystem::path data_folder() {
  const char* folder = std::getenv("REPRISE_DATA");
  if (folder == nullptr) {
    std::fputs("this benchmark needs real captures: set REPRISE_DATA to their folder\n", stderr);
    std::exit(2);
  }
  return folder;
}

inline void add_clip(PerformanceDatabase& database, const std::string& name, const SequenceSource& source) {
  const auto reader = open_sequence(source);
  MeshSequence clip(name, reader->topology(), reader->frame_count(), 25.0);
  parallel_for(0, reader->frame_count(), [&](std::size_t f) { clip.frame(f) = reader->read(f).positions; });
  clip.set_colors(reader->read(0).colors);
  database.add(std::move(clip));
}

// Two captured clips, 325 frames of 10,002 vertices.
inline PerformanceDatabase ama() {
  PerformanceDatabase database;
  for (const char* name : {"crane", "jumping"}) {
    add_clip(database, name, {.path = data_folder() / "ama" / name});
  }
  return database;
}

// Nine clips of a simulated clothed woman, 659 frames of 3,302 vertices.
inline PerformanceDatabase fashion() {
  PerformanceDatabase database;
  for (const char* name : {"walk", "stride", "slowwalk", "walk_stop", "run", "run_fast", "run_stop",
                           "veer_left", "turn_around"}) {
    add_clip(database, name,
             {.path = data_folder() / "fashion" / (std::string(name) + ".pc2"),
              .topology = data_folder() / "fashion" / "topology.ply"});
  }
  return database;
}

}  // namespace reprise::benchmark
