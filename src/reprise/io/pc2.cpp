// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/pc2.h"

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/io/byte_order.h"

namespace reprise {

Pc2Header parse_pc2_header(std::string_view bytes, std::uint64_t file_size,
                           const std::filesystem::path& path) {
  using namespace std::string_view_literals;
  constexpr std::string_view magic = "POINTCACHE2\0"sv;
  if (!bytes.starts_with(magic.substr(0, bytes.size())) || bytes.empty()) {
    throw FileError(path, "is not a PC2 file: expected it to start with 'POINTCACHE2'");
  }
  if (bytes.size() < Pc2Header::size) {
    throw FileError(path, fmt::format("is truncated: expected a header of {} bytes, found {}",
                                      Pc2Header::size, bytes.size()));
  }
  const auto version = load_little_endian<std::int32_t>(bytes.data() + 12);
  const auto vertex_count = load_little_endian<std::int32_t>(bytes.data() + 16);
  const auto frame_count = load_little_endian<std::int32_t>(bytes.data() + 28);
  if (version != 1) throw FileError(path, fmt::format("expected version 1 of PC2, found {}", version));
  if (vertex_count <= 0)
    throw FileError(path, fmt::format("expected at least 1 vertex, found {}", vertex_count));
  if (frame_count <= 0)
    throw FileError(path, fmt::format("expected at least 1 frame, found {}", frame_count));

  Pc2Header header;
  header.vertex_count = static_cast<std::size_t>(vertex_count);
  header.frame_count = static_cast<std::size_t>(frame_count);
  header.first_frame = load_little_endian<float>(bytes.data() + 20);
  header.frames_per_sample = load_little_endian<float>(bytes.data() + 24);
  // 12 x 2^31 x 2^31 < 2^64: no overflow.
  const std::uint64_t expected = header.frame_offset(header.frame_count);
  if (file_size != expected) {
    throw FileError(path, fmt::format("{}: expected {} bytes for {} frames of {} vertices, found {}",
                                      file_size < expected ? "is truncated" : "does not fit its header",
                                      expected, frame_count, vertex_count, file_size));
  }
  return header;
}

}  // namespace reprise
