// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Bytes of a file, whole or from any place, from several threads at once.

#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string_view>

namespace reprise {

// The contents of a file, in memory.
class FileBytes {
 public:
  explicit FileBytes(std::size_t size) : data_(std::make_unique_for_overwrite<char[]>(size)), size_(size) {}

  char* data() { return data_.get(); }
  std::string_view view() const { return {data_.get(), size_}; }

 private:
  std::unique_ptr<char[]> data_;
  std::size_t size_;
};

// A file open for reading. Reads at given places share no file position, so threads may read side by side.
class InputFile {
 public:
  // Throws `FileError` if there is no such file, it may not be read, or it is not a regular file.
  explicit InputFile(std::filesystem::path path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  // Bytes at the time of opening.
  std::uint64_t size() const { return size_; }

  // Fills `out` with `count` bytes from `offset` on. Throws `FileError` if the file ends before that.
  void read_at(std::uint64_t offset, void* out, std::size_t count) const;
  FileBytes read_all() const;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace reprise
