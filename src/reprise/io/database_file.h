// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The `.reprise` database file: HDF5, versioned, one chunk a frame, written whole or not at all.
// docs/database-file.md describes the layout.

#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "reprise/database/performance_database.h"

namespace reprise {

// The latest version this program reads. A file without learnt models is written as version 2, so that
// earlier programs read it.
inline constexpr int database_format_version = 3;

struct ClipInfo {
  std::string name;
  std::size_t frame_count = 0;
  double frames_per_second = 25.0;
  bool has_normals = false;
  bool has_colors = false;
  bool has_origins = false;
  bool has_truth = false;
};

// Reads frames from a database file without loading it. One thread at a time (HDF5's serial library).
class DatabaseReader {
 public:
  // Throws `FileError` if the file is missing, truncated, not a Reprise database, or of a later version
  // (names both).
  explicit DatabaseReader(const std::filesystem::path& path);
  ~DatabaseReader();
  DatabaseReader(DatabaseReader&&) noexcept;

  const TopologyPtr& topology() const;
  const std::vector<ClipInfo>& clips() const;
  // Version of the format the file was written in.
  int format_version() const;
  // Joints, parts and layers, if the file holds them.
  const std::optional<Markup>& markup() const;
  // What was learnt of the performer, read now: empty if the file holds nothing of it.
  LearntModels read_models() const;
  // Text stored with the file by `DatabaseWriter::set_note`, or empty: for a generated file, the JSON report.
  std::string note() const;

  // One frame with its normals and colours. Throws `FileError` or, for a bad index, `InvalidArgument`.
  Mesh read_frame(std::size_t clip_idx, std::size_t frame_idx) const;
  // A whole clip. Unlike `read_frame`, which shows a frame as it is, refuses frames that cannot be used (NaN,
  // no area).
  MeshSequence read_clip(std::size_t clip_idx) const;
  // The truth of a synthetic clip, if the file holds it.
  std::optional<ClipTruth> read_truth(std::size_t clip_idx) const;

 private:
  friend PerformanceDatabase load_database(const std::filesystem::path& path);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Writes a database file frame by frame; nothing appears at `target` before `commit`.
class DatabaseWriter {
 public:
  // Throws `FileError` if the folder is missing or if something that is not a Reprise database stands at
  // `target`.
  DatabaseWriter(std::filesystem::path target, TopologyPtr topology);
  ~DatabaseWriter();

  // Joints, parts and layers of the performer: once, before any truth. Throws `InvalidArgument` unless it
  // fits the topology.
  void set_markup(const Markup& markup);

  // What was learnt of the performer: once; empty models leave nothing in the file. Throws `InvalidArgument`
  // unless they fit the topology.
  void set_models(const LearntModels& models);

  // Starts a clip; the frames that follow belong to it. Throws `InvalidArgument` for a name that is taken or
  // unfit.
  void begin_clip(const std::string& name, double frames_per_second);
  // Appends a frame on the writer's topology. All frames of a clip have normals, or none; colours likewise.
  // Colours that never change within a clip are stored once.
  void append(const Mesh& mesh);
  // Provenance of the current clip, one entry a frame appended.
  void set_origins(std::span<const FrameOrigin> origins);
  // The truth of the current clip, after all of its frames. Throws `InvalidArgument` unless it fits them and
  // the markup's skeleton.
  void set_truth(const ClipTruth& truth);
  void set_note(const std::string& text);
  // Appends a whole clip.
  void write_clip(const MeshSequence& clip);

  // Finishes the file and puts it in place. Throws `FileError`, for example on a full disk.
  void commit();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Whole databases at once. `load_database` shows progress. `note`: as `DatabaseWriter::set_note`.
PerformanceDatabase load_database(const std::filesystem::path& path);
void save_database(const PerformanceDatabase& database, const std::filesystem::path& target,
                   const std::string& note = {});

}  // namespace reprise
