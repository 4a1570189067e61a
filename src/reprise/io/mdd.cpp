// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/mdd.h"

#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/io/byte_order.h"

namespace reprise {

MddHeader parse_mdd_header(std::string_view bytes, std::uint64_t file_size,
                           const std::filesystem::path& path) {
  if (bytes.size() < 8) {
    throw FileError(path, fmt::format("is truncated: expected a header of 8 bytes, found {}", bytes.size()));
  }
  const auto frame_count = load_big_endian<std::int32_t>(bytes.data());
  const auto vertex_count = load_big_endian<std::int32_t>(bytes.data() + 4);
  if (frame_count <= 0 || vertex_count <= 0) {
    throw FileError(path,
                    fmt::format("is not an MDD file: expected at least 1 frame and 1 vertex, found {} and {}",
                                frame_count, vertex_count));
  }
  MddHeader header;
  header.frame_count = static_cast<std::size_t>(frame_count);
  header.vertex_count = static_cast<std::size_t>(vertex_count);
  const std::uint64_t expected = header.frame_offset(header.frame_count);
  if (file_size != expected) {
    throw FileError(path, fmt::format("{}: expected {} bytes for {} frames of {} vertices, found {}",
                                      file_size < expected ? "is truncated, or not an MDD file"
                                                           : "does not fit its header, or is not an MDD file",
                                      expected, frame_count, vertex_count, file_size));
  }
  return header;
}

std::optional<double> frames_per_second_from_mdd_times(std::string_view bytes) {
  const std::size_t count = bytes.size() / 4;
  if (count < 2) return std::nullopt;
  const auto time = [&](std::size_t frame_idx) {
    return static_cast<double>(load_big_endian<float>(bytes.data() + 4 * frame_idx));
  };
  const double step = (time(count - 1) - time(0)) / static_cast<double>(count - 1);
  if (!(step > 0.0) || !std::isfinite(1.0 / step)) return std::nullopt;
  // Late times have few bits left for the step: 1e-3 of it, or what a float of their size resolves.
  const double tolerance =
      std::max(1e-3 * step, 2.4e-7 * std::max(std::abs(time(0)), std::abs(time(count - 1))));
  for (std::size_t i = 1; i < count; ++i) {
    if (!(std::abs(time(i) - time(0) - static_cast<double>(i) * step) <= tolerance)) return std::nullopt;
  }
  const double rate = 1.0 / step;
  const double whole = std::round(rate);
  return whole >= 1.0 && std::abs(rate - whole) <= 1e-4 * whole ? whole : rate;
}

}  // namespace reprise
