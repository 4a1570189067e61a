// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/database_header.h"

#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/io/database_file.h"

namespace reprise {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view signature = "REPRISE DATABASE\n";

struct Header {
  std::int64_t version = 0;
  std::uint64_t bytes = 0;
};

std::string header_text(const Header& header) {
  return fmt::format("{}version {}\nbytes {}\n", signature, header.version, header.bytes);
}

std::string first_bytes(const fs::path& path) {
  std::string bytes(database_header_bytes, '\0');
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw FileError(path, fmt::format("cannot be read: {}", std::strerror(errno)));
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

template <typename T>
bool parse_line(std::string_view& text, std::string_view key, T& value) {
  if (!text.starts_with(key)) return false;
  text.remove_prefix(key.size());
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end == text.data() + text.size() || *end != '\n') return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()) + 1);
  return true;
}

}  // namespace

bool is_database(const fs::path& path) {
  return first_bytes(path).starts_with(signature);
}

int check_database_header(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) throw FileError(path, "there is no such file");
  if (!fs::is_regular_file(path, error)) throw FileError(path, "is not a file; expected a Reprise database");
  const std::string bytes = first_bytes(path);
  if (!bytes.starts_with(signature)) {
    const bool is_cut = !bytes.empty() && signature.starts_with(bytes);
    throw FileError(path, bytes.empty() ? "is empty; expected a Reprise database"
                          : is_cut      ? "is truncated in its header"
                          : bytes.starts_with("\x89HDF\r\n\x1a")
                              ? "is an HDF5 file but not a Reprise database"
                              : "is not a Reprise database");
  }
  std::string_view text = std::string_view(bytes).substr(signature.size());
  Header header;
  const bool has_version = parse_line(text, "version ", header.version);
  if (has_version && header.version > database_format_version) {
    throw FileError(path, fmt::format("has database format version {}; this program reads versions up to {}",
                                      header.version, database_format_version));
  }
  if (bytes.size() < database_header_bytes) throw FileError(path, "is truncated in its header");
  if (!has_version || header.version < 1 || !parse_line(text, "bytes ", header.bytes)) {
    throw FileError(path, "has a damaged header: expected its version and its size");
  }
  if (header.bytes == 0) throw FileError(path, "was never finished");
  const std::uint64_t found = fs::file_size(path);
  if (found < header.bytes) {
    throw FileError(path, fmt::format("is truncated: expected {} bytes, found {}", header.bytes, found));
  }
  return static_cast<int>(header.version);
}

void write_database_header(const fs::path& path, int version, const fs::path& reported_path) {
  std::fstream stream(path, std::ios::binary | std::ios::in | std::ios::out);
  const std::string header = header_text({.version = version, .bytes = fs::file_size(path)});
  stream.write(header.data(), static_cast<std::streamsize>(header.size()));
  stream.close();
  if (!stream) throw FileError(reported_path, "cannot be written");
}

}  // namespace reprise
