// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A text file word by word or line by line, for formats in which a mistake is to be named by its line.

#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace reprise {

// Greatest magnitude of a number in a motion file: sums and products of such numbers stay finite.
inline constexpr double greatest_text_number = 1e12;

class TextLines {
 public:
  // `comment`: a character that makes the rest of its line a comment, or 0 for none. `text` must outlive the
  // object.
  TextLines(std::string_view text, std::filesystem::path path, char comment = 0);

  // Goes to the next line that has words. False at the end of the text.
  bool next();
  // As `next()`, but throws `FileError` "is truncated: expected WHAT" at the end.
  void require_next(std::string_view what);

  const std::vector<std::string_view>& words() const { return words_; }
  std::size_t line() const { return line_; }  // from 1
  const std::filesystem::path& path() const { return path_; }

  // The word as a number. Throws `FileError` naming the line if it is none, not finite, or greater than
  // `greatest_text_number`. `what` says in the message what the number is.
  double number(std::string_view word, std::string_view what) const;
  // The word as a whole number from 0 to 2^31 - 1.
  int count(std::string_view word, std::string_view what) const;
  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void fail_at(std::size_t line, const std::string& what) const;

 private:
  std::string_view text_;
  std::filesystem::path path_;
  char comment_;
  std::size_t at_ = 0;
  std::size_t line_ = 0;
  std::vector<std::string_view> words_;
};

// A word for an error message: quoted, shortened, and without bytes that a terminal would obey.
std::string in_quotes(std::string_view word);

// "Hips" == "HIPS": keywords of these formats are written in either case. ASCII only.
bool same_word(std::string_view a, std::string_view b);

}  // namespace reprise
