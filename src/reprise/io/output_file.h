// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A file being written, with every failure reported: a full disk must not pass as success.

#pragma once

#include <filesystem>
#include <span>
#include <string_view>

namespace reprise {

class OutputFile {
 public:
  // Creates or replaces the file at `path`. `reported_path`: what errors call it, if it is a temporary one.
  // Throws `FileError`, as do all members.
  explicit OutputFile(const std::filesystem::path& path, const std::filesystem::path& reported_path = {});
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes);
  template <typename T>
  void write_values(std::span<const T> values) {
    write({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
  }
  // Closes the file: some file systems report a full disk only here.
  void finish();

 private:
  std::filesystem::path reported_path_;
  int descriptor_ = -1;
};

}  // namespace reprise
