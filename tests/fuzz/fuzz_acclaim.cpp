// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <string_view>

#include "motion_invariants.h"
#include "reprise/core/error.h"
#include "reprise/io/acclaim_skeleton.h"

// The text of an .asf file, and after a line "%%" that of an .amc file for it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace reprise;
  constexpr std::string_view separator = "\n%%\n";
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::size_t at = text.find(separator);
  try {
    const AcclaimSkeleton skeleton = parse_asf(text.substr(0, at), "fuzz.asf");
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
      fuzz::require((b == 0) == (skeleton.bones[b].parent < 0));
      fuzz::require(skeleton.bones[b].parent < static_cast<int>(b));
      fuzz::require(skeleton.bones[b].offset.allFinite());
    }
    if (at == std::string_view::npos) return 0;
    fuzz::check(parse_amc(text.substr(at + separator.size()), "fuzz.amc", skeleton));
  } catch (const FileError&) {
  }
  return 0;
}
