// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/evaluate_keyframes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/io/database_file.h"
#include "reprise/io/image_file.h"
#include "reprise/pipeline/graph.h"
#include "reprise/pipeline/keyframes.h"
#include "support/shapes.h"
#include "support/test_data.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

using CsvRow = std::map<std::string, std::string>;

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  if (text.ends_with(separator)) parts.emplace_back();
  return parts;
}

// No field of these tests holds a comma. Expects as many fields in every line as in the first.
std::vector<CsvRow> read_csv(const fs::path& path) {
  std::vector<std::string> lines = split(read_text_file(path), '\n');
  EXPECT_TRUE(lines.back().empty()) << "the last line ends";
  lines.pop_back();
  const std::vector<std::string> names = split(lines.front(), ',');
  std::vector<CsvRow> rows;
  for (std::size_t l = 1; l < lines.size(); ++l) {
    const std::vector<std::string> fields = split(lines[l], ',');
    EXPECT_EQ(fields.size(), names.size()) << path << " line " << l + 1 << ": " << lines[l];
    CsvRow& row = rows.emplace_back();
    for (std::size_t f = 0; f < std::min(names.size(), fields.size()); ++f) row[names[f]] = fields[f];
  }
  return rows;
}

double number(const CsvRow& row, const char* name) {
  return std::stod(row.at(name));
}

PerformanceDatabase walking_shapes() {
  return test::database_of({test::walk("slow", 60, 0.03, 20.0), test::walk("fast", 50, 0.07, 20.0, 7.0)});
}

class EvaluateKeyframes : public ::testing::Test {
 protected:
  EvaluateKeyframes() { save_database(walking_shapes(), file_); }

  GridDatabase walks() const {
    return {.database = file_, .pairs = {{"slow:3", "fast:40"}, {"fast:2", "slow:50"}}};
  }
  static EvaluateKeyframesOptions tiny() { return {.max_distance = 5, .max_time = 4, .samples = 5}; }

  // A graph of the shapes without transitions from the slow clip to the fast one.
  fs::path cut_graph() const {
    const PerformanceDatabase database = walking_shapes();
    const SimilarityResult similarity = compute_similarity(database, file_, {.use_cache = false});
    const fs::path path = folder_ / "cut.json";
    save_graph(make_graph(database, similarity, {.remove = {"slow->fast"}}, std::nullopt), path);
    return path;
  }

  std::string text(const fs::path& name) const { return read_text_file(folder_ / name); }

  test::TemporaryFolder folder_;
  fs::path file_ = folder_ / "shapes.reprise";
};

// What two runs have in common to the last bit: all but CPU seconds.
constexpr const char* lasting[] = {"queries.csv", "unreachable.csv", "samples.csv",
                                   "errors-shapes-slow_3-fast_40.png", "errors-shapes-fast_2-slow_50.png"};

TEST_F(EvaluateKeyframes, TableIsWhatItsQueriesAddUpTo) {
  evaluate_keyframes({walks()}, folder_ / "out", tiny());
  const std::vector<CsvRow> queries = read_csv(folder_ / "out" / "queries.csv");
  ASSERT_EQ(queries.size(), 2U * 5U * 4U);
  const std::vector<CsvRow> table = read_csv(folder_ / "out" / "table.csv");
  ASSERT_EQ(table.size(), 3U) << "two pairs, and both of them together";
  std::size_t unreachable = 0;
  for (const CsvRow& row : table) {
    std::size_t targets = 0, reachable = 0, proved = 0;
    double squares = 0.0, largest = 0.0, time_squares = 0.0, corrected = 0.0;
    for (const CsvRow& query : queries) {
      if (!row.at("from").empty() && query.at("from") != row.at("from")) continue;
      ++targets;
      if (query.at("gap") == "0") ++proved;
      const double distance = std::abs(number(query, "distance") - number(query, "target_distance"));
      const double time = std::abs(number(query, "time") - number(query, "target_time"));
      EXPECT_EQ(query.at("reachable") == "1", distance <= 1.0 && time <= 1.0);
      EXPECT_NEAR(number(query, "cost"),
                  number(query, "transition_cost") + distance / 0.3 + time * 25.0 / 10.0, 1e-9);
      if (query.at("reachable") != "1") continue;
      ++reachable;
      squares += distance * distance;
      time_squares += time * time;
      largest = std::max(largest, distance);
      corrected = std::max(corrected,
                           std::abs(number(query, "corrected_distance") - number(query, "target_distance")));
    }
    ASSERT_GT(reachable, 0U);
    const auto count = static_cast<double>(reachable);
    EXPECT_EQ(number(row, "targets"), static_cast<double>(targets));
    EXPECT_EQ(number(row, "reachable"), count);
    EXPECT_EQ(number(row, "proved"), static_cast<double>(proved));
    EXPECT_EQ(proved, targets) << "the graph is small";
    EXPECT_NEAR(number(row, "distance_error_rms"), std::sqrt(squares / count), 1e-12);
    EXPECT_NEAR(number(row, "time_error_rms"), std::sqrt(time_squares / count), 1e-12);
    EXPECT_EQ(number(row, "distance_error_max"), largest);
    EXPECT_EQ(number(row, "corrected_distance_error_max"), corrected);
    EXPECT_LE(number(row, "smoothness_max") * 4.0, number(row, "normalized_smoothness_max") + 1e-12);
    EXPECT_GT(number(row, "cpu_total"), 0.0);
    EXPECT_EQ(row.at("paper_cpu_mean"), "") << "shapes are not in the paper";
    if (!row.at("from").empty()) unreachable += targets - reachable;
  }
  const std::vector<CsvRow> missed = read_csv(folder_ / "out" / "unreachable.csv");
  EXPECT_EQ(missed.size(), unreachable);
  EXPECT_GT(unreachable, 0U) << "5 m in 1 s";
  for (const CsvRow& row : missed) {
    const auto nearest = std::ranges::find_if(queries, [&](const CsvRow& query) {
      return query.at("from") == row.at("from") &&
             query.at("target_distance") == row.at("nearest_reachable_distance") &&
             query.at("target_time") == row.at("nearest_reachable_time");
    });
    ASSERT_NE(nearest, queries.end());
    EXPECT_EQ(nearest->at("reachable"), "1");
  }
  EXPECT_EQ(read_csv(folder_ / "out" / "times.csv").size(), queries.size());
  for (const char* picture : {"table.png", "errors-shapes-slow_3-fast_40.png"})
    EXPECT_GT(read_image(folder_ / "out" / picture).width, 300);
}

TEST_F(EvaluateKeyframes, MarkdownTablesAreRectangular) {
  evaluate_keyframes({walks()}, folder_ / "out", tiny());
  std::size_t tables = 0, bars = 0;
  for (const std::string& line : split(text("out/table.md"), '\n')) {
    const auto here = static_cast<std::size_t>(std::ranges::count(line, '|'));
    if (bars == 0 && here > 0) ++tables;
    if (bars > 0 && here > 0) {
      EXPECT_EQ(here, bars) << line;
    }
    bars = here;
  }
  EXPECT_EQ(tables, 7U) << "errors twice, correction, certificates, smoothness, frames twice";
  EXPECT_THAT(text("out/table.md"), HasSubstr("40 queries, 40 of them proved optimal"));
}

TEST_F(EvaluateKeyframes, FramesAreWhatThePathPredicts) {
  evaluate_keyframes({walks()}, folder_ / "out", tiny());
  const std::vector<CsvRow> samples = read_csv(folder_ / "out" / "samples.csv");
  ASSERT_EQ(samples.size(), 3U * 5U);
  for (const CsvRow& sample : samples) {
    EXPECT_NEAR(number(sample, "distance"), number(sample, "predicted_distance"), 0.01);
    EXPECT_EQ(sample.at("frames"), sample.at("predicted_frames"));
    EXPECT_GT(number(sample, "edge_stretch_p99"), 0.9);
  }
  // A run without samples measures none, and finds the same paths.
  EvaluateKeyframesOptions none = tiny();
  none.samples = 0;
  evaluate_keyframes({walks()}, folder_ / "none", none);
  EXPECT_TRUE(read_csv(folder_ / "none" / "samples.csv").empty());
  EXPECT_EQ(text("none/queries.csv"), text("out/queries.csv"));
}

TEST_F(EvaluateKeyframes, AStoppedRunContinuesToTheSameBytes) {
  evaluate_keyframes({walks()}, folder_ / "fresh", tiny());

  // Stopped before anything is finished, and by an error after the first of two databases.
  set_interrupted(true);
  EXPECT_THROW(evaluate_keyframes({walks()}, folder_ / "out", tiny()), Cancelled);
  set_interrupted(false);
  EXPECT_FALSE(fs::exists(folder_ / "out" / "table.md"));
  const std::vector<GridDatabase> halves = {
      {.database = file_, .pairs = {walks().pairs[1]}},
      {.database = file_, .graph = cut_graph(), .pairs = {walks().pairs[0]}}};
  EXPECT_THAT([&] { evaluate_keyframes(halves, folder_ / "out", tiny()); },
              ThrowsMessage<Error>(AllOf(HasSubstr("slow:3 -> fast:40"), HasSubstr("no path"))));
  EXPECT_FALSE(fs::exists(folder_ / "out" / "table.md"));
  const std::string kept = text("out/finished/shapes-fast_2-slow_50.paths.json");

  evaluate_keyframes({walks()}, folder_ / "out", tiny());
  for (const char* name : lasting)
    EXPECT_EQ(text(fs::path("out") / name), text(fs::path("fresh") / name)) << name;
  EXPECT_EQ(text("out/finished/shapes-fast_2-slow_50.paths.json"), kept) << "not computed anew";

  // Now everything is kept, CPU seconds as well.
  const std::string table = text("out/table.md"), table_csv = text("out/table.csv"),
                    times = text("out/times.csv");
  evaluate_keyframes({walks()}, folder_ / "out", tiny());
  EXPECT_EQ(text("out/table.md"), table);
  EXPECT_EQ(text("out/table.csv"), table_csv);
  EXPECT_EQ(text("out/times.csv"), times);

  EvaluateKeyframesOptions anew = tiny();
  anew.resume = false;
  evaluate_keyframes({walks()}, folder_ / "out", anew);
  EXPECT_NE(text("out/times.csv"), times) << "searched again";
  for (const char* name : lasting)
    EXPECT_EQ(text(fs::path("out") / name), text(fs::path("fresh") / name)) << name;
}

TEST_F(EvaluateKeyframes, ChangedInputsAreComputedAnew) {
  const auto expect_as_fresh = [&](const GridDatabase& database, const EvaluateKeyframesOptions& options,
                                   const char* what) {
    evaluate_keyframes({database}, folder_ / "out", options);
    evaluate_keyframes({database}, folder_ / what, options);
    for (const char* name : {"queries.csv", "samples.csv"})
      EXPECT_EQ(text(fs::path("out") / name), text(fs::path(what) / name)) << what;
  };
  GridDatabase database = walks();
  database.pairs.pop_back();
  EvaluateKeyframesOptions options = tiny();
  options.samples = 2;
  evaluate_keyframes({database}, folder_ / "out", options);
  const std::string first = text("out/queries.csv");
  const std::string kept = text("out/finished/shapes-slow_3-fast_40.paths.json");

  options.correction.max_stretch = 0.02;
  expect_as_fresh(database, options, "correction");
  EXPECT_NE(text("out/queries.csv"), first);
  EXPECT_EQ(text("out/finished/shapes-slow_3-fast_40.paths.json"), kept) << "the paths are the same";

  options.optimizer.time_weight = 2.0;
  expect_as_fresh(database, options, "weight");
  EXPECT_NE(text("out/finished/shapes-slow_3-fast_40.paths.json"), kept);
  options.max_time = 3;
  expect_as_fresh(database, options, "grid");
  const PerformanceDatabase other =
      test::database_of({test::walk("slow", 60, 0.03, 20.0), test::walk("fast", 50, 0.08, 20.0, 7.0)});
  save_database(other, file_);
  const std::string before = text("out/queries.csv");
  expect_as_fresh(database, options, "database");
  EXPECT_NE(text("out/queries.csv"), before);

  // A damaged file is as good as none.
  const fs::path file = folder_ / "out" / "finished" / "shapes-slow_3-fast_40.paths.json";
  const std::string whole = read_text_file(file);
  write_text_file(file, whole.substr(0, whole.size() / 2));
  expect_as_fresh(database, options, "database");
}

TEST_F(EvaluateKeyframes, SaysWhatIsWrongBeforeItWorks) {
  const fs::path out = folder_ / "out";
  const auto run = [&](const GridDatabase& database, const EvaluateKeyframesOptions& options = tiny()) {
    return [=] { evaluate_keyframes({database}, out, options); };
  };
  const auto with = [&](auto change) {
    EvaluateKeyframesOptions options = tiny();
    change(options);
    return options;
  };
  using Options = EvaluateKeyframesOptions;
  EXPECT_THROW(evaluate_keyframes({}, out, tiny()), InvalidArgument);
  for (const Options& options :
       {with([](Options& o) { o.max_distance = 0; }), with([](Options& o) { o.max_time = -1; }),
        with([](Options& o) { o.samples = -1; }), with([](Options& o) { o.reach_distance = -0.1; }),
        with([](Options& o) { o.reach_time = NAN; }),
        with([](Options& o) { o.correction.max_stretch = 2.0; }),
        with([](Options& o) { o.optimizer.distance_weight = NAN; })}) {
    EXPECT_THROW(run(walks(), options)(), InvalidArgument);
  }
  EXPECT_THROW(run({.database = folder_ / "none.reprise"})(), FileError);
  EXPECT_THAT(run({.database = file_}), ThrowsMessage<InvalidArgument>(AllOf(
                                            HasSubstr("key-frames of the paper"), HasSubstr("--pair"))));
  EXPECT_THAT(run({.database = file_, .pairs = {{"slow:3", "fats:4"}}}),
              ThrowsMessage<InvalidArgument>(HasSubstr("'fast'")));
  EXPECT_THAT(run({.database = file_, .pairs = {{"slow:3", "fast:50"}}}),
              ThrowsMessage<InvalidArgument>(HasSubstr("49")));
  EXPECT_THAT(run({.database = file_, .pairs = {{"slow:3", "fast:4"}, {"slow:3", "fast:4"}}}),
              ThrowsMessage<InvalidArgument>(HasSubstr("listed twice")));

  save_database(
      test::database_of({test::walk("slow", 60, 0.031, 20.0), test::walk("fast", 50, 0.07, 20.0, 7.0)}),
      folder_ / "other.reprise");
  EXPECT_THROW(run({.database = folder_ / "other.reprise", .graph = cut_graph(), .pairs = walks().pairs})(),
               InvalidArgument)
      << "the graph of another database";
  write_text_file(folder_ / "bad.json", "{");
  EXPECT_THROW(run({.database = file_, .graph = folder_ / "bad.json", .pairs = walks().pairs})(), FileError);
  EXPECT_FALSE(fs::exists(out));
  write_text_file(out, "in the way");
  EXPECT_THROW(run(walks())(), FileError);
  EXPECT_EQ(read_text_file(out), "in the way");
}

}  // namespace
}  // namespace reprise
