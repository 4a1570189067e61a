// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <string_view>

#include "motion_invariants.h"
#include "reprise/core/error.h"
#include "reprise/io/bvh.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace reprise;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const SkeletalMotion motion = parse_bvh(text, "fuzz.bvh");
    fuzz::check(motion);
    // What was read can be written and read again.
    std::string written;
    try {
      written = format_bvh(motion);
    } catch (const InvalidArgument&) {
      return 0;  // two names that differ in what becomes '_'
    }
    const SkeletalMotion again = parse_bvh(written, "again.bvh");
    fuzz::check(again);
    fuzz::require(again.frames.size() == motion.frames.size());
  } catch (const FileError&) {
  }
  return 0;
}
