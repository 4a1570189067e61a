// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <cmath>

#include "invariants.h"
#include "reprise/core/error.h"
#include "reprise/io/mdd.h"
#include "reprise/io/pc2.h"

// A header that is accepted describes frames that lie inside the file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace reprise;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    const Pc2Header header = parse_pc2_header(bytes.substr(0, Pc2Header::size), size, "fuzz.pc2");
    fuzz::require(header.frame_offset(header.frame_count - 1) + header.frame_bytes() == size);
  } catch (const FileError&) {
  }
  try {
    const MddHeader header = parse_mdd_header(bytes.substr(0, 8), size, "fuzz.mdd");
    fuzz::require(header.frame_offset(header.frame_count - 1) + header.frame_bytes() == size);
    const std::optional<double> rate =
        frames_per_second_from_mdd_times(bytes.substr(header.times_offset(), 4 * header.frame_count));
    fuzz::require(!rate || (*rate > 0.0 && std::isfinite(*rate)));
  } catch (const FileError&) {
  }
  return 0;
}
