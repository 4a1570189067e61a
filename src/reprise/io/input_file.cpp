// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/input_file.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "reprise/core/error.h"

namespace reprise {

InputFile::InputFile(std::filesystem::path path) : path_(std::move(path)) {
  // Without O_NONBLOCK, opening a named pipe would wait for a writer for ever.
  descriptor_ = open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor_ < 0) throw FileError(path_, fmt::format("cannot be read: {}", std::strerror(errno)));
  struct stat status {};
  if (fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) {
    close(descriptor_);
    throw FileError(path_, S_ISDIR(status.st_mode) ? "is a folder where a file is expected"
                                                   : "cannot be read: it is not a regular file");
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

InputFile::~InputFile() {
  close(descriptor_);
}

void InputFile::read_at(std::uint64_t offset, void* out, std::size_t count) const {
  char* to = static_cast<char*>(out);
  std::size_t done = 0;
  while (done < count) {
    const ssize_t got = pread(descriptor_, to + done, count - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw FileError(path_, fmt::format("cannot be read: {}", std::strerror(errno)));
    if (got == 0) {
      throw FileError(path_, fmt::format("is truncated: expected {} bytes from byte {} on, found {}", count,
                                         offset, done));
    }
    done += static_cast<std::size_t>(got);
  }
}

FileBytes InputFile::read_all() const {
  FileBytes bytes(size_);
  read_at(0, bytes.data(), size_);
  return bytes;
}

}  // namespace reprise
