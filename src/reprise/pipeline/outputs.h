// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Before a command works: can it write what it will write, without destroying what it reads?

#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace reprise {

struct Output {
  std::filesystem::path path;  // empty: not asked for, not looked at
  std::string extension;       // such as ".png"; empty: any
};

// Throws `InvalidArgument` if an output is the same file as an input or as another output, whatever way the
// paths are written, or has another extension than the one its content will have; `FileError` if its folder
// does not exist.
void check_outputs(const std::vector<Output>& outputs, const std::vector<std::filesystem::path>& inputs);

// Makes the folder an evaluation writes into, if it is missing, and sees that a file can be written there:
// hours of work should not end at a folder that cannot be written. Throws `FileError`.
void prepare_folder(const std::filesystem::path& folder);

}  // namespace reprise
