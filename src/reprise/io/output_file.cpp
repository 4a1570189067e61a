// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/output_file.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "reprise/core/error.h"

namespace reprise {

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, int error) {
  throw FileError(path, fmt::format("cannot be written: {}", std::strerror(error)));
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& path, const std::filesystem::path& reported_path)
    : reported_path_(reported_path.empty() ? path : reported_path),
      descriptor_(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) fail(reported_path_, errno);
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void OutputFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t put = ::write(descriptor_, bytes.data(), bytes.size());
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) fail(reported_path_, put < 0 ? errno : ENOSPC);
    bytes.remove_prefix(static_cast<std::size_t>(put));
  }
}

void OutputFile::finish() {
  if (::close(std::exchange(descriptor_, -1)) != 0) fail(reported_path_, errno);
}

}  // namespace reprise
