// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Output that appears whole or not at all: written beside its final place, then renamed.

#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace reprise {

// A file or a directory under construction. Write to `path()`, then `commit()`. Without a commit the
// destructor removes what was written and leaves an older result at `target` untouched.
class AtomicOutput {
 public:
  enum class Kind { file, directory };

  // `target`: final place; its parent folder must exist. A symbolic link is followed, so the link stays and
  // what it names is replaced. Throws `FileError` if the parent folder is missing, if something of another
  // kind stands at `target` (a folder where a file is to be written, a file where a folder is, a device or a
  // pipe), or if the temporary directory cannot be made.
  AtomicOutput(std::filesystem::path target, Kind kind);
  ~AtomicOutput();
  AtomicOutput(const AtomicOutput&) = delete;
  AtomicOutput& operator=(const AtomicOutput&) = delete;

  // Temporary place in the same folder as the target, with the target's extension.
  const std::filesystem::path& path() const { return temporary_; }
  const std::filesystem::path& target() const { return target_; }

  // Moves the finished output to its target. An older directory there is replaced as a whole, with everything
  // it holds: a caller whose target may hold files of the user checks that before it commits. Throws
  // `FileError`; the older result is then still in place.
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path temporary_;
  Kind kind_;
  bool committed_ = false;
};

// Writes `text` to `target` whole or not at all. Throws `FileError`, for example on a full disk.
void write_text_file(const std::filesystem::path& target, std::string_view text);

// Reads a whole file. Throws `FileError` if it is missing or cannot be read.
std::string read_text_file(const std::filesystem::path& path);

}  // namespace reprise
