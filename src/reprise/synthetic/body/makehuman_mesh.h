// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Reading the package's mesh files (three.js JSON, format 3.1).

#pragma once

#include <filesystem>

#include "reprise/synthetic/body/makehuman.h"

namespace reprise::makehuman {

// Both throw `FileError` naming file and field, what was expected and what was found.
MakehumanBody read_body(const std::filesystem::path& path);
MakehumanProxy read_proxy(const std::filesystem::path& path);

}  // namespace reprise::makehuman
