// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The parts of a markup as colours, to see whether they are sensible.

#pragma once

#include <filesystem>

#include "reprise/sequence/mesh_sequence.h"

namespace reprise {

// Gives a clip of `database` one colour a vertex in place of its own: each part has a colour, and the parts
// that hold a vertex are mixed by their weights there (`PartHierarchy`). Throws `InvalidArgument` if the
// database has no parts or `PartHierarchy` refuses them; `FileError`.
void color_parts(MeshSequence& clip, const std::filesystem::path& database);

}  // namespace reprise
