// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/text_lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/io/number.h"

namespace reprise {
namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

}  // namespace

TextLines::TextLines(std::string_view text, std::filesystem::path path, char comment)
    : text_(text), path_(std::move(path)), comment_(comment) {
  if (text_.starts_with(byte_order_mark)) at_ = byte_order_mark.size();
}

bool TextLines::next() {
  words_.clear();
  while (words_.empty()) {
    if (at_ >= text_.size()) return false;
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view line = text_.substr(at_, end - at_);
    at_ = end + 1;
    ++line_;
    if (comment_ != 0) line = line.substr(0, line.find(comment_));
    for (std::size_t i = 0; i < line.size();) {
      if (is_space(line[i])) {
        ++i;
        continue;
      }
      const std::size_t begin = i;
      while (i < line.size() && !is_space(line[i])) ++i;
      words_.push_back(line.substr(begin, i - begin));
    }
  }
  return true;
}

void TextLines::require_next(std::string_view what) {
  if (!next()) fail(fmt::format("is truncated: expected {}, found the end of the file", what));
}

double TextLines::number(std::string_view word, std::string_view what) const {
  double value = 0.0;
  const char* const end = word.data() + word.size();
  if (word.empty() || parse_double(word.data(), end, value) != end) {
    fail(fmt::format("expected {}, found {}", what, in_quotes(word)));
  }
  if (!(std::abs(value) <= greatest_text_number)) {
    fail(fmt::format("expected {}, found {}, which is not finite or beyond {:g}", what, in_quotes(word),
                     greatest_text_number));
  }
  return value;
}

int TextLines::count(std::string_view word, std::string_view what) const {
  std::int64_t value = -1;
  const auto [after, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || after != word.data() + word.size() || value < 0 ||
      value > std::numeric_limits<std::int32_t>::max()) {
    fail(fmt::format("expected {}, found {}", what, in_quotes(word)));
  }
  return static_cast<int>(value);
}

void TextLines::fail(const std::string& what) const {
  fail_at(line_, what);
}

void TextLines::fail_at(std::size_t line, const std::string& what) const {
  throw FileError(path_, std::to_string(line), what);
}

std::string in_quotes(std::string_view word) {
  constexpr std::size_t longest = 40;
  std::string shown(word.substr(0, longest));
  for (char& c : shown) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  }
  return fmt::format("'{}{}'", shown, word.size() > longest ? "..." : "");
}

bool same_word(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::ranges::equal(a, b, [&](char x, char y) { return lower(x) == lower(y); });
}

}  // namespace reprise
