// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/linear_program.h"

#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glpk.h>
#include <gtest/gtest.h>

#include "support/test_data.h"

namespace reprise::path_detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Reads a text with GLPK (GPL, tests only).
class Reading {
 public:
  explicit Reading(const std::string& text) : problem_(glp_create_prob()) {
    const test::TemporaryFolder folder;
    const std::string path = (folder / "program.lp").string();
    std::ofstream(path) << text;
    glp_term_out(GLP_OFF);
    read_ = glp_read_lp(problem_, nullptr, path.c_str()) == 0;
    if (read_) glp_create_index(problem_);
  }
  ~Reading() { glp_delete_prob(problem_); }
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;

  bool read() const { return read_; }
  glp_prob* problem() const { return problem_; }
  int column(const std::string& name) const { return glp_find_col(problem_, name.c_str()); }
  int row(const std::string& name) const { return glp_find_row(problem_, name.c_str()); }
  std::map<std::string, double> terms(int row) const {
    std::vector<int> columns(static_cast<std::size_t>(glp_get_num_cols(problem_)) + 1);
    std::vector<double> values(columns.size());
    const int count = glp_get_mat_row(problem_, row, columns.data(), values.data());
    std::map<std::string, double> by_name;
    for (int i = 1; i <= count; ++i) {
      const auto idx = static_cast<std::size_t>(i);
      by_name[glp_get_col_name(problem_, columns[idx])] = values[idx];
    }
    return by_name;
  }

 private:
  glp_prob* problem_;
  bool read_ = false;
};

// What GLPK says of a bound that is none.
double bound_of(double value) {
  return value <= -1e300 ? -infinity : value >= 1e300 ? infinity : value;
}

LinearProgram random_program(std::mt19937& random) {
  const auto integer = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  // Numbers of all sizes, some of them whole.
  const auto number = [&] {
    const double size =
        std::pow(10.0, integer(-12, 6)) * std::uniform_real_distribution<double>(1.0, 10.0)(random);
    return (integer(0, 1) == 0 ? -1.0 : 1.0) * (integer(0, 2) == 0 ? integer(1, 3) : size);
  };
  LinearProgram program;
  for (int i = 0; i < 30; ++i) {
    LinearProgram::Column column;
    column.name = fmt::format("take.{}.{}", i, std::string(static_cast<std::size_t>(integer(1, 150)), 'x'));
    if (integer(0, 1) == 0) column.objective = number();
    if (integer(0, 1) == 0) column.least = integer(0, 5);
    if (integer(0, 1) == 0) column.most = column.least + integer(0, 1000) / 7.0;
    column.is_integer = integer(0, 1) == 0;
    program.add_column(column);
  }
  for (int i = 0; i < 20; ++i) {
    LinearProgram::Row row;
    row.name = fmt::format("row.{}", i);
    for (std::size_t j = 0; j < program.columns.size(); ++j) {
      if (integer(0, 2) == 0) row.terms.emplace_back(j, number());
    }
    row.relation = std::array{Relation::at_most, Relation::equal,
                              Relation::at_least}[static_cast<std::size_t>(integer(0, 2))];
    row.bound = integer(0, 2) == 0 ? 0.0 : number();
    program.rows.push_back(row);
  }
  return program;
}

TEST(LinearProgram, IsReadBackToTheLastBit) {
  std::mt19937 random(1);
  for (int i = 0; i < 50; ++i) {
    SCOPED_TRACE(i);
    const LinearProgram program = random_program(random);
    const std::string text = to_lp_text(program, {"A heading.", ""});
    const Reading reading(text);
    ASSERT_TRUE(reading.read()) << text;
    glp_prob* problem = reading.problem();
    EXPECT_EQ(glp_get_obj_dir(problem), GLP_MIN);
    for (const LinearProgram::Column& column : program.columns) {
      const int idx = reading.column(column.name);
      if (idx == 0) continue;  // in no row and without bounds: checked below
      EXPECT_EQ(glp_get_obj_coef(problem, idx), column.objective);
      EXPECT_EQ(bound_of(glp_get_col_lb(problem, idx)), column.least);
      EXPECT_EQ(bound_of(glp_get_col_ub(problem, idx)), column.most);
      EXPECT_EQ(glp_get_col_kind(problem, idx) != GLP_CV, column.is_integer);
    }
    ASSERT_EQ(glp_get_num_rows(problem), static_cast<int>(program.rows.size()));
    for (const LinearProgram::Row& row : program.rows) {
      const int idx = reading.row(row.name);
      ASSERT_GT(idx, 0);
      std::map<std::string, double> terms;
      for (const auto& [column, factor] : row.terms) terms[program.columns[column].name] = factor;
      EXPECT_EQ(reading.terms(idx), terms);
      const double least = bound_of(glp_get_row_lb(problem, idx));
      const double most = bound_of(glp_get_row_ub(problem, idx));
      EXPECT_EQ(least, row.relation == Relation::at_most ? -infinity : row.bound);
      EXPECT_EQ(most, row.relation == Relation::at_least ? infinity : row.bound);
    }
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 250u);
  }
}

TEST(LinearProgram, AColumnNamedTwiceCountsTwice) {
  LinearProgram program;
  const std::size_t x = program.add_column({.name = "x"});
  const std::size_t y = program.add_column({.name = "y"});
  program.rows.push_back({"sum", {{x, 1.0}, {y, 3.0}, {x, 1.5}, {y, -3.0}}, Relation::at_least, 1.0});
  const Reading reading(to_lp_text(program, {}));
  ASSERT_TRUE(reading.read());
  EXPECT_EQ(reading.terms(1), (std::map<std::string, double>{{"x", 2.5}}));
}

TEST(LinearProgram, EmptyRowsAndObjectivesAreReadable) {
  LinearProgram program;
  program.add_column({.name = "x", .most = 1.0, .is_integer = true});
  program.rows.push_back({"nothing", {}, Relation::at_least, 1.0});
  const Reading reading(to_lp_text(program, {}));
  ASSERT_TRUE(reading.read());
  EXPECT_EQ(glp_get_num_rows(reading.problem()), 1);
  EXPECT_EQ(glp_get_num_int(reading.problem()) + glp_get_num_bin(reading.problem()), 2);  // x counts as both
}

TEST(LinearProgram, NoCommentReachesTheProgram) {
  LinearProgram program;
  const std::size_t x = program.add_column({.name = "x", .most = 1.0});
  program.rows.push_back({"row", {{x, 1.0}}, Relation::at_least, 0.5});
  const Reading reading(to_lp_text(program, {"first\nEnd\r\n", std::string(5000, 'x') + "\n y: x >= 3"}));
  ASSERT_TRUE(reading.read());
  EXPECT_EQ(glp_get_num_cols(reading.problem()), 1);
  EXPECT_EQ(glp_get_num_rows(reading.problem()), 1);
}

TEST(LinearProgram, LabelsAreLettersDigitsAndUnderscores) {
  EXPECT_EQ(lp_label("walk_2"), "walk_2");
  EXPECT_EQ(lp_label("a b.c<=d\n"), "a_b_c__d_");
  EXPECT_EQ(lp_label("\xc3\xa9"), "__");
  EXPECT_EQ(lp_label(std::string(100, 'a')).size(), 60u);
  EXPECT_EQ(lp_label(""), "");
}

}  // namespace
}  // namespace reprise::path_detail
