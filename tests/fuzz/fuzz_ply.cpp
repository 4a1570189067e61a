// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "invariants.h"
#include "reprise/core/error.h"
#include "reprise/io/ply.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace reprise;
  try {
    fuzz::check(parse_ply({reinterpret_cast<const char*>(data), size}, "fuzz.ply"));
  } catch (const FileError&) {
  }
  return 0;
}
