// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A graph of two walks, and the messages of what is refused.

#pragma once

#include <functional>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/graph/surface_motion_graph.h"
#include "reprise/similarity/vertex_metric.h"
#include "support/captured_log.h"
#include "support/shapes.h"
#include "support/test_data.h"

namespace reprise::test {

using Json = nlohmann::ordered_json;

inline PerformanceDatabase two_walks() {
  PerformanceDatabase database;
  database.add(walk("walk", 50));
  database.add(walk("stroll", 40, 0.02, 26.0, 5.0));
  return database;
}

inline SurfaceMotionGraph found_graph(const PerformanceDatabase& database) {
  const DissimilarityMatrix matrix = vertex_dissimilarity(database);
  const TransitionOptions options{.max_pop_ratio = 100.0};  // these walks differ too much for less
  return build_graph(database, matrix.metric(), find_transitions(database, matrix, options), options);
}

inline std::string argument_error(const std::function<void()>& call) {
  try {
    call();
  } catch (const InvalidArgument& error) {
    return error.what();
  }
  return "";
}

class GraphTest : public ::testing::Test {
 protected:
  // The saved graph with a change, as text.
  std::string changed(const std::function<void(Json&)>& change) const {
    save_graph(graph_, path_);
    Json json = Json::parse(read_text_file(path_));
    change(json);
    return json.dump(2);
  }
  // Message of the error that loading this text gives, or an empty text.
  std::string load_error(const std::string& text) const {
    write_text_file(path_, text);
    try {
      load_graph(path_);
    } catch (const FileError& error) {
      return error.what();
    }
    return "";
  }
  std::string load_error(const std::function<void(Json&)>& change) const {
    return load_error(changed(change));
  }

  PerformanceDatabase database_ = two_walks();
  SurfaceMotionGraph graph_ = found_graph(database_);
  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "graph.json";
};

}  // namespace reprise::test
