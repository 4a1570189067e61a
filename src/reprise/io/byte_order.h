// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Numbers from bytes of a stated order, at any alignment.

#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace reprise {

template <typename T, std::endian order>
T load(const char* bytes) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes, sizeof(T));
  if constexpr (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

template <typename T>
T load_little_endian(const char* bytes) {
  return load<T, std::endian::little>(bytes);
}

template <typename T>
T load_big_endian(const char* bytes) {
  return load<T, std::endian::big>(bytes);
}

}  // namespace reprise
