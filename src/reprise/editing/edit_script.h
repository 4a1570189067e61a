// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// An editing session as a JSON file (docs/editing.md).

#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "reprise/editing/editing_session.h"

namespace reprise {

// Where a step drags a handle to.
struct ScriptedDrag {
  Handle handle;
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();        // metres, from the captured place
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // about the centroid there
};

struct ScriptStep {
  FrameId frame;
  std::optional<std::vector<Handle>> anchors;  // none: those of the step before
  std::vector<ScriptedDrag> drags;
};

struct EditScript {
  std::optional<EditModel> model;
  // Given: edits are spread over time (`SpaceTimeOptions::window`). Otherwise they are stills.
  std::optional<double> window;
  std::vector<ScriptStep> steps;  // at least one; those of one frame in a row
};

// Reads a script for a database and finds the vertices of its handles. `frame` ("CLIP:FRAME"), if not empty,
// is that of steps which name none, instead of the file's. Throws `FileError` naming file and field for a
// damaged file and for contents that do not fit the database; warns of unknown fields.
EditScript read_edit_script(const std::filesystem::path& path, const PerformanceDatabase& database,
                            const std::string& frame = {});

}  // namespace reprise
