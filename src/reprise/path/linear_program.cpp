// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/linear_program.h"

#include <cmath>
#include <iterator>
#include <map>
#include <string_view>

#include <fmt/format.h>

namespace reprise::path_detail {
namespace {

constexpr std::size_t line_length = 100;       // of a row, where it can be broken
constexpr std::size_t most_line_length = 250;  // of a comment, which cannot

void add_comment(std::string& text, std::string_view line) {
  std::string clean;
  for (const char character : line.substr(0, most_line_length - 2)) {
    // A control character might end the comment.
    clean += static_cast<unsigned char>(character) < 0x20 ? ' ' : character;
  }
  text += clean.empty() ? "\\\n" : "\\ " + clean + "\n";
}

// Appends words to a line and begins a new one when it is full.
class Line {
 public:
  Line(std::string& text, const std::string& first_word) : text_(text), length_(first_word.size() + 1) {
    text_ += " " + first_word;
  }
  ~Line() { text_ += "\n"; }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;

  void add(const std::string& word) {
    if (length_ + 1 + word.size() > line_length) {
      text_ += "\n   ";
      length_ = 3;
    }
    text_ += " " + word;
    length_ += 1 + word.size();
  }
  void add_term(double factor, const std::string& name) {
    const double size = std::abs(factor);
    add(fmt::format("{} {}{}", factor < 0.0 ? '-' : '+', size == 1.0 ? "" : fmt::format("{} ", size), name));
  }

 private:
  std::string& text_;
  std::size_t length_;
};

void add_objective(std::string& text, const LinearProgram& program) {
  text += "Minimize\n";
  Line line(text, "cost:");
  bool empty = true;
  for (const LinearProgram::Column& column : program.columns) {
    if (column.objective == 0.0) continue;
    line.add_term(column.objective, column.name);
    empty = false;
  }
  // Some readers want a term.
  if (empty) line.add("0 " + program.columns.front().name);
}

void add_row(std::string& text, const LinearProgram& program, const LinearProgram::Row& row) {
  // A reader refuses a column that stands twice in one row.
  std::map<std::size_t, double> factors;
  for (const auto& [column, factor] : row.terms) factors[column] += factor;
  Line line(text, row.name + ":");
  bool empty = true;
  for (const auto& [column, factor] : factors) {
    if (factor == 0.0) continue;
    line.add_term(factor, program.columns[column].name);
    empty = false;
  }
  if (empty) line.add("0 " + program.columns.front().name);
  const char* relation = row.relation == Relation::at_most ? "<="
                         : row.relation == Relation::equal ? "="
                                                           : ">=";
  line.add(fmt::format("{} {}", relation, row.bound));
}

void add_bounds(std::string& text, const LinearProgram::Column& column) {
  const bool has_least = column.least != 0.0;
  const bool has_most = std::isfinite(column.most);
  if (has_most) {
    text += fmt::format(" {} <= {} <= {}\n", column.least, column.name, column.most);
  } else if (has_least) {
    text += fmt::format(" {} >= {}\n", column.name, column.least);
  }
}

}  // namespace

std::string to_lp_text(const LinearProgram& program, const std::vector<std::string>& heading) {
  std::string text;
  for (const std::string& line : heading) add_comment(text, line);
  add_objective(text, program);
  text += "Subject To\n";
  for (const LinearProgram::Row& row : program.rows) add_row(text, program, row);
  text += "Bounds\n";
  for (const LinearProgram::Column& column : program.columns) add_bounds(text, column);
  text += "Generals\n";
  for (const LinearProgram::Column& column : program.columns) {
    if (column.is_integer) text += " " + column.name + "\n";
  }
  text += "End\n";
  return text;
}

std::string lp_label(const std::string& text) {
  std::string label;
  for (const char c : text.substr(0, 60)) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    label += plain ? c : '_';
  }
  return label;
}

}  // namespace reprise::path_detail
