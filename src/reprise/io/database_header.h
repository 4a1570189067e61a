// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The text in front of a database file (HDF5's user block): tells what the file is, whether it is whole, and
// what version it has, before HDF5 looks at a single byte.
//   REPRISE DATABASE\nversion 2\nbytes 1234567\n, then zeros

#pragma once

#include <cstddef>
#include <filesystem>

namespace reprise {

inline constexpr std::size_t database_header_bytes = 512;
// Attribute "format" of the root group.
inline constexpr const char* database_format_name = "Reprise performance database";

bool is_database(const std::filesystem::path& path);

// The version of the file. Throws `FileError` unless it is a whole database of a version this program knows.
int check_database_header(const std::filesystem::path& path);

// Of the finished file `path`, which errors call `reported_path`: only now does it say that it is whole.
void write_database_header(const std::filesystem::path& path, int version,
                           const std::filesystem::path& reported_path);

}  // namespace reprise
