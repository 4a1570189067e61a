// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Random numbers addressed by position: the same seed and keys give the same number, in any order and on any
// thread.

#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace reprise {

// Mixes 64 bits (the finaliser of SplitMix64, Steele et al. 2014).
constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

class RandomField {
 public:
  explicit constexpr RandomField(std::uint64_t seed) : seed_(mix_bits(seed)) {}

  // A field of its own for a purpose or a name.
  constexpr RandomField branch(std::uint64_t key) const { return RandomField(5 * seed_ + mix_bits(key + 1)); }

  // Uniform in (0, 1), never 0 or 1.
  constexpr double uniform(std::uint64_t a, std::uint64_t b = 0) const {
    return (static_cast<double>(bits(a, b) >> 12) + 0.5) * 0x1p-52;
  }

  // Two independent normal numbers of mean 0 and variance 1 (Box-Muller).
  std::array<double, 2> normal_pair(std::uint64_t a, std::uint64_t b = 0) const {
    const double radius = std::sqrt(-2.0 * std::log(uniform(2 * a, b)));
    const double angle = 2.0 * std::numbers::pi * uniform(2 * a + 1, b);
    return {radius * std::cos(angle), radius * std::sin(angle)};
  }

 private:
  constexpr std::uint64_t bits(std::uint64_t a, std::uint64_t b) const {
    // Odd factors instead of exclusive-or alone: equal keys must not cancel.
    return mix_bits(3 * mix_bits(3 * seed_ + mix_bits(a)) + mix_bits(b + 0x632be59bd9b4e019ULL));
  }

  std::uint64_t seed_;
};

}  // namespace reprise
