// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/number.h"

#include <bit>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace reprise {
namespace {

// The number that is all of `text`.
double parsed(const std::string& text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  EXPECT_EQ(parse_double(text.data(), end, value), end) << text;
  return value;
}

void expect_like_strtod(const std::string& text) {
  const double expected = std::strtod(text.c_str(), nullptr);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(parsed(text)), std::bit_cast<std::uint64_t>(expected))
      << text << ": expected " << expected << ", found " << parsed(text);
}

TEST(Number, RandomDecimalsAreRoundedLikeStrtod) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 200000; ++i) {
    const int digits = std::uniform_int_distribution(1, 25)(random);
    std::string text = random() % 2 == 0 ? "-" : "";
    const int point = std::uniform_int_distribution(-1, digits)(random);
    for (int k = 0; k < digits; ++k) {
      if (k == point) text += '.';
      text += static_cast<char>('0' + random() % 10);
    }
    if (random() % 3 == 0) text += fmt::format("e{}", std::uniform_int_distribution(-340, 320)(random));
    expect_like_strtod(text);
  }
}

TEST(Number, DoublesAndFloatsInShortestFormComeBackExactly) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 200000; ++i) {
    const auto number = std::bit_cast<double>(random());
    if (!std::isfinite(number)) continue;
    EXPECT_EQ(parsed(fmt::format("{}", number)), number);
    const auto single = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    if (std::isfinite(single)) {
      EXPECT_EQ(static_cast<float>(parsed(fmt::format("{}", single))), single);
    }
  }
}

TEST(Number, EveryWrittenFormIsReadLikeStrtod) {
  for (const char* text : {"0",
                           "-0",
                           "1.",
                           ".5",
                           "+.5e1",
                           "1E5",
                           "1e+5",
                           "1e-5",
                           "007",
                           "9007199254740993",
                           "9007199254740991e22",
                           "1e23",
                           "123456789012345678901234567890",
                           "0.000000000000000000000000000001",
                           "1e400",
                           "-1e400",
                           "1e-400",
                           "-1e-400",
                           "0.0000001e400",
                           "100000000e-400",
                           "0e999999999999",
                           "1e99999999999999999999",
                           "1e-99999999999999999999",
                           "4.9e-324",
                           "2.4e-324",
                           "2.2250738585072011e-308",
                           "inf",
                           "-inf",
                           "infinity"}) {
    expect_like_strtod(text);
  }
  EXPECT_TRUE(std::isnan(parsed("nan")));
}

TEST(Number, StopsBehindTheNumber) {
  const auto rest = [](const std::string& text) {
    double value = 0.0;
    return std::string(parse_double(text.data(), text.data() + text.size(), value),
                       text.data() + text.size());
  };
  EXPECT_EQ(rest("1.5 2"), " 2");
  EXPECT_EQ(rest("1e"), "e");
  EXPECT_EQ(rest("1e+x"), "e+x");
  EXPECT_EQ(rest("1.2.3"), ".3");
}

TEST(Number, AnythingElseIsNoNumber) {
  for (const std::string text : {"", "-", "+", ".", "-.", "e5", "--1", "+-1", "x", " 1"}) {
    double value = 0.0;
    EXPECT_EQ(parse_double(text.data(), text.data() + text.size(), value), text.data()) << text;
  }
}

}  // namespace
}  // namespace reprise
