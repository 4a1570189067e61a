// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/similarity.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <memory>
#include <optional>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/core/hash.h"
#include "reprise/core/progress.h"
#include "reprise/core/ranks.h"
#include "reprise/core/text.h"
#include "reprise/pipeline/matrix_search.h"
#include "reprise/pipeline/matrix_store.h"
#include "reprise/similarity/skeleton_metric.h"
#include "reprise/similarity/vertex_metric.h"
#include "reprise/skeleton/skeleton_extraction.h"

namespace reprise {
namespace {

// Part of the cache key: raise it when the values of a metric change.
constexpr int vertex_metric_revision = 2;
constexpr int skeleton_metric_revision = 1;
constexpr int shape_color_metric_revision = 1;

std::string metric_name(const std::string& asked) {
  const std::vector<std::string>& metrics = similarity_metrics();
  const std::string name = asked == "shape-color" ? "shape-colour" : asked;
  if (std::ranges::count(metrics, name) > 0) return name;
  const std::string nearest = nearest_word(name, metrics);
  throw InvalidArgument(
      nearest.empty()
          ? fmt::format("there is no metric '{}'; the metrics are {}", asked, fmt::join(metrics, ", "))
          : fmt::format("there is no metric '{}'; did you mean '{}'?", asked, nearest));
}

void add_markup(ContentHash& hash, const Markup& markup) {
  for (const Joint& joint : markup.skeleton.joints) {
    hash.add(joint.name).add_number(joint.parent);
    for (const double coordinate : joint.rest_position) hash.add_number(coordinate);
  }
  hash.add(std::span(markup.reference.data(), static_cast<std::size_t>(markup.reference.size())));
  hash.add(std::span<const std::int32_t>(markup.joint_of_vertex));
}

void add_histogram(ContentHash& hash, const HistogramOptions& options) {
  for (const int number :
       {options.radius_bins, options.polar_bins, options.azimuth_bins, options.azimuth_refinement}) {
    hash.add_number(number);
  }
  hash.add_number(options.voxel_size);
  if (!options.use_color) return;
  for (const int bins : options.color_bins) hash.add_number(bins);
  hash.add_number(options.meters_per_color)
      .add_number(options.color_footprint)
      .add_number(options.min_color_share);
}

// What the values depend on, and nothing else.
std::string matrix_key(const PerformanceDatabase& database, const SimilarityOptions& options) {
  ContentHash hash;
  hash.add(database.content_hash()).add(options.metric);
  if (options.metric == "vertex") {
    hash.add_number(vertex_metric_revision);
  } else if (options.metric == "skeleton") {
    hash.add_number(skeleton_metric_revision);
    add_markup(hash, *database.markup());
  } else {
    hash.add_number(shape_color_metric_revision);
    add_histogram(hash, options.histogram);
    if (options.histogram.use_color) hash.add(database.appearance_hash());
  }
  return hash.hex();
}

DissimilarityMatrix compare_skeletons(const PerformanceDatabase& database) {
  std::vector<SkeletalMotion> motions;
  Progress progress("following the skeleton", database.frame_count());
  for (const MeshSequence& clip : database.clips()) {
    motions.push_back(extract_skeleton(clip, *database.markup()));
    progress.advance(clip.frame_count());
  }
  return skeleton_dissimilarity(database, motions);
}

// Metrics that give every pair at once, exactly.
void compute_closed_form(const PerformanceDatabase& database, const SimilarityOptions& options,
                         MatrixStore& store, SimilarityResult& result) {
  result.from_cache = store.load(result.matrix);
  if (!result.from_cache) {
    const std::string key = result.matrix.key();
    result.matrix = options.metric == "vertex" ? vertex_dissimilarity(database) : compare_skeletons(database);
    result.matrix.set_key(key);
    store.save(result.matrix);
  }
  result.transitions = find_transitions(database, result.matrix, options.transitions);
}

// They come from a file that another machine may not see; all ranks must work on the same.
std::vector<TransitionRequest> of_first_rank(const std::vector<TransitionRequest>& own) {
  if (Ranks::count() == 1) return own;
  const std::vector<std::byte> bytes = Ranks::all_gather(std::as_bytes(std::span(own))).front();
  std::vector<TransitionRequest> requests(bytes.size() / sizeof(TransitionRequest));
  std::memcpy(requests.data(), bytes.data(), bytes.size());
  return requests;
}

struct Undecided {};

// The transitions if what is known of the matrix decides them, and those asked for by hand.
std::optional<std::vector<Transition>> decided_transitions(const PerformanceDatabase& database,
                                                           DissimilarityMatrix& matrix,
                                                           const SimilarityOptions& options) {
  const auto undecided = [](std::size_t, std::size_t) -> MatrixEntry { throw Undecided(); };
  try {
    for (const TransitionRequest& request : options.requests) {
      (void)measure_transition(database, matrix, undecided, request, options.transitions);
    }
    return find_transitions(database, matrix, undecided, options.transitions);
  } catch (const Undecided&) {
    return std::nullopt;
  }
}

// Metrics whose entries are bounded first.
void compute_bounded(const PerformanceDatabase& database, const SimilarityOptions& options,
                     MatrixStore& store, SimilarityResult& result) {
  std::vector<PairEntry> found;
  if (store.load(result.matrix)) {
    found = store.load_found(database.frame_count());
    const bool is_complete = options.exact ? result.matrix.exact_count() == result.matrix.pair_count()
                                           : result.matrix.unknown_count() == 0;
    // Cutting all frames into voxels takes a while: not before something is known to be missing.
    if (is_complete && found.empty()) {
      if (auto transitions = decided_transitions(database, result.matrix, options)) {
        result.transitions = std::move(*transitions);
        result.from_cache = true;
        return;
      }
    }
  }
  ShapeColorMetric metric(database, options.histogram);
  MatrixSearch search(
      {.bound_tile = [&](const FrameTile& tile,
                         std::span<MatrixEntry> out) { return metric.bound_tile(tile, out); },
       .exact = [&](std::size_t a, std::size_t b,
                    SearchStatistics& statistics) { return metric.exact(a, b, &statistics); }},
      result.matrix, store);
  if (options.exact) {
    search.make_all_exact(found);
  } else {
    search.bound_all();
  }
  result.transitions = search.find(database, options.transitions, found);
  search.decide(database, options.transitions, options.requests);
  result.statistics = search.statistics();
}

}  // namespace

const std::vector<std::string>& similarity_metrics() {
  static const std::vector<std::string> metrics = {"shape-colour", "shape", "vertex", "skeleton"};
  return metrics;
}

SimilarityResult compute_similarity(const PerformanceDatabase& database,
                                    const std::filesystem::path& database_path,
                                    const SimilarityOptions& asked) {
  const auto start = std::chrono::steady_clock::now();
  SimilarityOptions options = asked;
  options.metric = metric_name(asked.metric);
  options.histogram.use_color = options.metric == "shape-colour";
  // Before hours of work, not after.
  (void)database.frames_per_second();
  validate(options.transitions);
  options.requests = of_first_rank(options.requests);
  for (const TransitionRequest& request : options.requests)
    check_request(request, database, options.transitions);
  if (options.metric.starts_with("shape")) validate(options.histogram);
  if (options.metric == "skeleton" && !database.markup()) {
    throw InvalidArgument(fmt::format(
        "the metric skeleton needs a markup, which says what bone each vertex follows, and {} has "
        "none: give it one with `reprise markup`",
        database_path.string()));
  }

  SimilarityResult result;
  result.transition_options = options.transitions;
  result.matrix = DissimilarityMatrix(options.metric, database);
  result.matrix.set_key(matrix_key(database, options));
  std::filesystem::path file;
  if (options.use_cache) {
    file = database_path;
    file += ".cache";
    file /= fmt::format("{}-{}.matrix", options.metric, result.matrix.key().substr(0, 16));
  }
  MatrixStore store(file, result.matrix.key());
  if (options.metric.starts_with("shape")) {
    compute_bounded(database, options, store, result);
  } else {
    compute_closed_form(database, options, store, result);
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace reprise
