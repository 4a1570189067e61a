// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/log.h"
#include "reprise/core/ranks.h"
#include "reprise/pipeline/mocap.h"
#include "reprise/pipeline/outputs.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;

void check_names(const std::vector<MocapQuery>& queries) {
  if (queries.empty()) throw InvalidArgument("expected at least one motion, found none");
  std::set<std::string> names;
  for (const MocapQuery& query : queries) {
    if (query.name.empty() || query.name == "." || query.name == ".." ||
        query.name.find_first_of("/:") != std::string::npos) {
      throw InvalidArgument(fmt::format("'{}' cannot be the name of a clip and a file", query.name));
    }
    if (!names.insert(query.name).second) {
      throw InvalidArgument(
          fmt::format("two motions are called '{}': their animations would be one file", query.name));
    }
  }
}

MocapOutcome run_one(const MocapStage& stage, const MocapQuery& query, const fs::path& output) {
  MocapOutcome outcome{.name = query.name, .output = output};
  try {
    const auto result = stage.run(query, output);
    if (result) {
      outcome.report = full_report(*result);
    } else {
      outcome.failure = "no retrieval: " + result.error().reason;
    }
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    outcome.failure = error.what();
  }
  return outcome;
}

nlohmann::json to_json(const MocapOutcome& outcome, std::size_t idx) {
  return {{"idx", idx}, {"failure", outcome.failure}, {"report", outcome.report}};
}

}  // namespace

std::vector<int> shares_of_ranks(const std::vector<std::uintmax_t>& sizes, int rank_count) {
  std::vector<std::size_t> order(sizes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return sizes[a] > sizes[b]; });
  std::vector<std::uintmax_t> load(static_cast<std::size_t>(rank_count), 0);
  std::vector<int> rank_of(sizes.size(), 0);
  for (const std::size_t q : order) {
    const auto least = std::ranges::min_element(load);
    *least += sizes[q];
    rank_of[q] = static_cast<int>(least - load.begin());
  }
  return rank_of;
}

std::vector<MocapOutcome> run_mocap_folder(const MocapStage& stage, const std::vector<MocapQuery>& queries,
                                           const fs::path& folder) {
  check_names(queries);
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder)) {
    throw FileError(folder, fmt::format("the folder cannot be made: {}",
                                        error ? error.message() : "there is something else of that name"));
  }
  std::vector<std::uintmax_t> sizes;
  for (const MocapQuery& query : queries) {
    // Lines of text are frames; a file that is not there says so when it is read.
    const std::uintmax_t size = fs::file_size(query.source.motion, error);
    sizes.push_back(error ? 0 : size);
  }
  const std::vector<int> rank_of = shares_of_ranks(sizes, Ranks::count());
  std::vector<MocapOutcome> outcomes(queries.size());
  nlohmann::json own = nlohmann::json::array();
  for (std::size_t q = 0; q < queries.size(); ++q) {
    const fs::path output = folder / (queries[q].name + ".reprise");
    outcomes[q] = {.name = queries[q].name, .output = output};
    if (rank_of[q] != Ranks::index()) continue;
    outcomes[q] = run_one(stage, queries[q], output);
    if (!outcomes[q].failure.empty()) spdlog::error("{}: {}", queries[q].name, outcomes[q].failure);
    own.push_back(to_json(outcomes[q], q));
  }
  const std::string text = own.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  for (const std::vector<std::byte>& part : Ranks::all_gather(std::as_bytes(std::span(text)))) {
    const char* const begin = reinterpret_cast<const char*>(part.data());
    for (nlohmann::json& entry : nlohmann::json::parse(begin, begin + part.size())) {
      MocapOutcome& outcome = outcomes[entry["idx"].get<std::size_t>()];
      outcome.failure = entry["failure"].get<std::string>();
      outcome.report = std::move(entry["report"]);
    }
  }
  return outcomes;
}

}  // namespace reprise
