// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// MDD, the point cache of LightWave: frame times, then positions of all frames, big-endian.

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

namespace reprise {

struct MddHeader {
  std::size_t vertex_count = 0;
  std::size_t frame_count = 0;

  std::uint64_t times_offset() const { return 8; }
  std::uint64_t frame_bytes() const { return std::uint64_t{12} * vertex_count; }
  std::uint64_t frame_offset(std::size_t frame_idx) const {
    return times_offset() + std::uint64_t{4} * frame_count + frame_idx * frame_bytes();
  }
};

// `bytes`: the first 8 bytes of the file, or all if it is shorter. `file_size`: all bytes of the file.
// Throws `FileError` if the file holds no frame or has another size than its header says (names both); an MDD
// file has no signature, so its size is how a foreign file shows.
MddHeader parse_mdd_header(std::string_view bytes, std::uint64_t file_size,
                           const std::filesystem::path& path);

// `bytes`: the big-endian float times in seconds, 4 bytes a frame. The rate if all steps are equal within 0.1
// %, taken as the nearest whole number if that is within 0.01 %. Nothing for uneven times or a single frame.
std::optional<double> frames_per_second_from_mdd_times(std::string_view bytes);

}  // namespace reprise
