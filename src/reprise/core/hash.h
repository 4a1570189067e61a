// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Content hashes: they key cached results, so that a stale cache is never used.

#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace reprise {

// 128-bit XXH3 of everything added, in order. Not cryptographic.
class ContentHash {
 public:
  ContentHash();
  ~ContentHash();
  ContentHash(ContentHash&&) noexcept;
  ContentHash& operator=(ContentHash&&) noexcept;

  ContentHash& add_bytes(const void* data, std::size_t size);
  // Text and arrays are added with their length, so that ("ab", "c") and ("a", "bc") differ.
  ContentHash& add(std::string_view text);
  template <typename T>
  ContentHash& add(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>, "only plain values are the same as their bytes");
    return add(std::string_view(reinterpret_cast<const char*>(values.data()), values.size_bytes()));
  }
  ContentHash& add_number(double value) { return add_bytes(&value, sizeof value); }

  // 32 hexadecimal digits.
  std::string hex() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace reprise
