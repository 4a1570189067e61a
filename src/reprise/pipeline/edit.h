// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "edit": an edit script becomes edited frames, or a clip over which the edits are spread.

#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "reprise/database/performance_database.h"
#include "reprise/editing/edit_model.h"

namespace reprise {

struct EditStageOptions {
  std::filesystem::path script;    // JSON, docs/editing.md
  std::string frame;               // "CLIP:FRAME" of steps that name none, instead of the script's
  std::optional<EditModel> model;  // instead of the script's; without both: part
  std::optional<double> window;    // seconds: spread the edits over their clip; instead of the script's
  bool show_steps = false;         // stills: the captured frame and then every step, not the last one alone
  std::string name;                // of the resulting clip; empty: "edit", or that of the clip edited
};

struct EditResult {
  // Without a window a frame for each frame that was edited, in the order of the script; with one the whole
  // clip. Origins say the captured frames.
  MeshSequence animation;
  // Captured and edited frames by turns, for a picture: what is moved is green, what is held red.
  MeshSequence before_after;
  // model, window, steps (frame, handles, residual, solved_parts, iterations, seconds), and, with a window,
  // changed_frames and their pop ratio. docs/editing.md lists every field.
  nlohmann::json report;
};

// Throws `FileError` naming the field of the script; `InvalidArgument` for what the database lacks, and if
// edits that are to be spread lie in two clips.
EditResult run_edit(const PerformanceDatabase& database, const EditStageOptions& options);

// The two columns of `before_after` as a picture, FILE.png. Throws as `render_sequence`.
void draw_before_after(const EditResult& result, const std::filesystem::path& png);

}  // namespace reprise
