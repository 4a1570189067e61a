// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A linear program with integer columns, as text.

#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace reprise::path_detail {

enum class Relation { at_most, at_least, equal };

// Minimises the sum of objective times column subject to the rows and to the columns' bounds.
struct LinearProgram {
  struct Column {
    std::string name;
    double objective = 0.0;
    double least = 0.0;  // finite
    double most = std::numeric_limits<double>::infinity();
    bool is_integer = false;
  };
  struct Row {
    std::string name;
    std::vector<std::pair<std::size_t, double>> terms;  // column, factor; a column named twice counts twice
    Relation relation = Relation::equal;
    double bound = 0.0;
  };
  std::vector<Column> columns;
  std::vector<Row> rows;

  std::size_t add_column(Column column) {
    columns.push_back(std::move(column));
    return columns.size() - 1;
  }
};

// CPLEX LP text. `heading`: lines of a comment. Numbers are written so that they are read back to the last
// bit; no line is longer than 250 characters (the format's old limit is 255). Preconditions: names are
// distinct, of 1 to 200 letters, digits, '_' or '.', and begin with a letter other than e or E (which readers
// take for an exponent); no bound is a NaN; there is a column.
std::string to_lp_text(const LinearProgram& program, const std::vector<std::string>& heading);

// `text` with all but letters and digits of ASCII replaced by '_', at most 60 characters.
std::string lp_label(const std::string& text);

}  // namespace reprise::path_detail
