// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Numbers from text, fast: nearly all the time of a text reader goes here.

#pragma once

#include <array>
#include <charconv>
#include <cstdint>
#include <limits>
#include <system_error>

namespace reprise {

// Reads the number at `begin` and sets `value` to the double nearest to it, as `strtod` does: an optional
// sign, digits with an optional point and exponent, or "nan" or "inf"; beyond the range of a double, infinity
// or zero. Returns the first character after the number, or `begin` if there is none.
inline const char* parse_double(const char* begin, const char* end, double& value) {
  static constexpr std::array<double, 23> powers_of_ten = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                           1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                           1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  const char* p = begin;
  const bool negative = p != end && *p == '-';
  if (p != end && (*p == '-' || *p == '+')) ++p;
  const char* const unsigned_begin = p;

  const auto digit = [](char c) { return static_cast<unsigned>(static_cast<unsigned char>(c)) - '0'; };
  std::uint64_t mantissa = 0;
  for (; p != end && digit(*p) < 10; ++p) mantissa = 10 * mantissa + digit(*p);
  std::ptrdiff_t digits = p - unsigned_begin;
  std::int64_t exponent = 0;
  if (p != end && *p == '.') {
    const char* const fraction = ++p;
    for (; p != end && digit(*p) < 10; ++p) mantissa = 10 * mantissa + digit(*p);
    exponent = fraction - p;
    digits += p - fraction;
  }
  if (digits > 0 && p != end && (*p == 'e' || *p == 'E')) {
    const char* q = p + 1;
    const bool negative_exponent = q != end && *q == '-';
    if (q != end && (*q == '-' || *q == '+')) ++q;
    if (q != end && digit(*q) < 10) {
      std::int64_t written = 0;
      for (; q != end && digit(*q) < 10; ++q) {
        if (written < 100000) written = 10 * written + digit(*q);
      }
      exponent += negative_exponent ? -written : written;
      p = q;
    }
  }
  // Up to 19 digits cannot have overflowed `mantissa`. A mantissa below 2^53 and a power of ten up to 10^22
  // are exact doubles, so that their product or quotient is rounded once, hence correctly.
  if (digits > 0 && digits <= 19 && mantissa < (std::uint64_t{1} << 53) && exponent >= -22 &&
      exponent <= 22) {
    const double exact = static_cast<double>(mantissa);
    const double magnitude = exponent < 0 ? exact / powers_of_ten[static_cast<std::size_t>(-exponent)]
                                          : exact * powers_of_ten[static_cast<std::size_t>(exponent)];
    value = negative ? -magnitude : magnitude;
    return p;
  }

  // `from_chars` takes a sign of its own: "--1" is no number.
  if (unsigned_begin == end || *unsigned_begin == '-' || *unsigned_begin == '+') return begin;
  double magnitude = 0.0;
  const auto [after, error] = std::from_chars(unsigned_begin, end, magnitude);
  if (error == std::errc::invalid_argument) return begin;
  if (error == std::errc::result_out_of_range) {
    // The value lies far outside on one side: its power of ten tells which.
    for (const char* q = unsigned_begin; q != after && (*q == '0' || *q == '.'); ++q) digits -= *q == '0';
    magnitude = digits + exponent > 0 ? std::numeric_limits<double>::infinity() : 0.0;
  }
  value = negative ? -magnitude : magnitude;
  return after;
}

}  // namespace reprise
