// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Opening what the commands work on: one clip of a database file.

#pragma once

#include <filesystem>
#include <string>

#include "reprise/sequence/mesh_sequence.h"

namespace reprise {

// The clip of that name, or the only clip of the file if the name is empty. Throws `InvalidArgument` if the
// file has several clips and none is named (lists them), or none of that name (offers the nearest);
// `FileError`.
MeshSequence open_clip(const std::filesystem::path& database, const std::string& clip_name);

}  // namespace reprise
