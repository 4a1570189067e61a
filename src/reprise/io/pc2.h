// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// PC2, the point cache of 3ds Max and Blender: positions of all frames, little-endian, 32 bytes of header.

#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace reprise {

struct Pc2Header {
  static constexpr std::size_t size = 32;

  std::size_t vertex_count = 0;
  std::size_t frame_count = 0;
  float first_frame = 0.0f;
  // Scene frames from one sample to the next, usually 1. This is how Blender and 3ds Max use the field: a PC2
  // file never says how long a scene frame is, so it states no frames per second.
  float frames_per_sample = 1.0f;

  std::uint64_t frame_bytes() const { return std::uint64_t{12} * vertex_count; }
  std::uint64_t frame_offset(std::size_t frame_idx) const { return size + frame_idx * frame_bytes(); }
};

// `bytes`: the first 32 bytes of the file, or all if it is shorter. `file_size`: all bytes of the file.
// Throws `FileError` if the file is no PC2 file of version 1, holds no frame, or has another size than its
// header says (names both).
Pc2Header parse_pc2_header(std::string_view bytes, std::uint64_t file_size,
                           const std::filesystem::path& path);

}  // namespace reprise
