// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/matrix_search.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <mutex>
#include <shared_mutex>
#include <unordered_map>

#include "reprise/core/interrupt.h"
#include "reprise/core/log.h"
#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"
#include "reprise/core/ranks.h"

namespace reprise {
namespace {

// Ranks meet this many times less often than a process alone keeps what it has: each waits for the slowest.
constexpr double work_per_meeting = 3.0;

std::uint64_t pair_id(std::size_t a, std::size_t b) {
  return (static_cast<std::uint64_t>(a) << 32U) | b;
}

template <typename T>
void append(std::vector<std::byte>& bytes, std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto more = std::as_bytes(values);
  bytes.insert(bytes.end(), more.begin(), more.end());
}

// Reads what `append` wrote; moves `at` on.
template <typename T>
void take(const std::vector<std::byte>& bytes, std::size_t& at, std::span<T> values) {
  std::memcpy(values.data(), bytes.data() + at, values.size_bytes());
  at += values.size_bytes();
}

// Which rank searches a pair of clips for transitions.
class ClipPairOwners {
 public:
  // The largest pairs first, each to the rank with the least so far.
  explicit ClipPairOwners(const DissimilarityMatrix& matrix) {
    const std::vector<std::size_t>& counts = matrix.clip_frame_counts();
    for (std::size_t clip = 0; clip < counts.size(); ++clip)
      first_frames_.push_back(matrix.first_frame(clip));
    struct Work {
      std::uint64_t pairs;
      std::size_t a;
      std::size_t b;
    };
    std::vector<Work> work;
    for (std::size_t a = 0; a < counts.size(); ++a) {
      for (std::size_t b = a; b < counts.size(); ++b) {
        work.push_back({counts[a] * counts[b] / (a == b ? 2 : 1), a, b});
      }
    }
    std::ranges::stable_sort(work, std::greater(), &Work::pairs);
    std::vector<std::uint64_t> load(static_cast<std::size_t>(Ranks::count()));
    for (const Work& w : work) {
      const auto least = std::ranges::min_element(load);
      *least += w.pairs;
      rank_of_[{w.a, w.b}] = static_cast<int>(least - load.begin());
    }
  }

  int rank_of(std::size_t clip_a, std::size_t clip_b) const { return rank_of_.at({clip_a, clip_b}); }
  int rank_of(const FrameTile& tile) const { return rank_of(clip_of(tile.a_first), clip_of(tile.b_first)); }

 private:
  std::size_t clip_of(std::size_t frame) const {
    return static_cast<std::size_t>(std::ranges::upper_bound(first_frames_, frame) - first_frames_.begin()) -
           1;
  }

  std::vector<std::size_t> first_frames_;
  std::map<std::pair<std::size_t, std::size_t>, int> rank_of_;
};

std::size_t cell_count(const FrameTile& tile) {
  return (tile.a_last - tile.a_first) * (tile.b_last - tile.b_first);
}

// Calls visit(a, b, cell) for the pairs of a tile, row after row.
template <typename Visit>
void for_each_pair(const FrameTile& tile, const Visit& visit) {
  for (std::size_t a = tile.a_first; a < tile.a_last; ++a) {
    for (std::size_t b = std::max(tile.b_first, a + 1); b < tile.b_last; ++b) {
      visit(a, b, (a - tile.a_first) * (tile.b_last - tile.b_first) + (b - tile.b_first));
    }
  }
}

std::size_t pair_count(const FrameTile& tile) {
  std::size_t count = 0;
  for_each_pair(tile, [&](std::size_t, std::size_t, std::size_t) { ++count; });
  return count;
}

std::size_t pair_count(const std::vector<FrameTile>& tiles) {
  std::size_t count = 0;
  for (const FrameTile& tile : tiles) count += pair_count(tile);
  return count;
}

}  // namespace

MatrixSearch::MatrixSearch(BoundedMetric metric, DissimilarityMatrix& matrix, MatrixStore& store)
    : metric_(std::move(metric)), matrix_(matrix), store_(store) {}

std::vector<FrameTile> MatrixSearch::missing_tiles(const IsMissing& is_missing) const {
  std::vector<FrameTile> tiles = ShapeColorMetric::tiles(matrix_.clip_frame_counts());
  std::erase_if(tiles, [&](const FrameTile& tile) {
    bool is_needed = false;
    for_each_pair(tile, [&](std::size_t a, std::size_t b, std::size_t) {
      is_needed = is_needed || is_missing(matrix_.entry(a, b));
    });
    return !is_needed;
  });
  // A rank begins with what it will search for transitions: what a metric remembers of bounds serves it
  // there.
  if (Ranks::count() > 1) {
    const ClipPairOwners owners(matrix_);
    std::ranges::stable_sort(tiles, {}, [&](const FrameTile& tile) { return owners.rank_of(tile); });
  }
  return tiles;
}

void MatrixSearch::work(std::span<const FrameTile> tiles, std::span<std::uint8_t> is_done,
                        const ComputeTile& compute, const ComputedTile& computed) {
  const auto start = std::chrono::steady_clock::now();
  const auto time = work_per_meeting * store_.pause();
  std::shared_mutex matrix_mutex;  // shared by those who write an entry each, for the one who keeps them all
  std::mutex save_mutex;
  std::mutex statistics_mutex;
  try {
    parallel_for(0, tiles.size(), [&](std::size_t t) {
      if (Ranks::count() > 1 && t > 0 && std::chrono::steady_clock::now() - start > time) return;
      std::vector<MatrixEntry> entries(cell_count(tiles[t]));
      const SearchStatistics statistics = compute(tiles[t], entries);
      {
        const std::shared_lock lock(matrix_mutex);
        computed(tiles[t], entries);
        is_done[t] = 1;
      }
      {
        const std::scoped_lock lock(statistics_mutex);
        statistics_ += statistics;
      }
      const std::unique_lock saving(save_mutex, std::try_to_lock);
      if (saving.owns_lock() && store_.is_due()) {
        const std::unique_lock lock(matrix_mutex);
        store_.save(matrix_);
        spdlog::debug("the matrix as it is was kept");
      }
    });
  } catch (...) {
    store_.save(matrix_);
    throw;
  }
}

// Every rank tells which tiles it has done, and their entries.
void MatrixSearch::exchange(std::span<const FrameTile> tiles, std::span<std::uint8_t> is_done,
                            const ComputedTile& computed) const {
  std::vector<std::byte> done;
  for (std::uint32_t t = 0; t < tiles.size(); ++t) {
    if (is_done[t] == 0) continue;
    append<std::uint32_t>(done, {&t, 1});
    for_each_pair(tiles[t], [&](std::size_t a, std::size_t b, std::size_t) {
      const MatrixEntry entry = matrix_.entry(a, b);
      append<MatrixEntry>(done, {&entry, 1});
    });
  }
  const auto all = Ranks::all_gather(done);
  for (std::size_t r = 0; r < all.size(); ++r) {
    if (static_cast<int>(r) == Ranks::index()) continue;
    for (std::size_t at = 0; at < all[r].size();) {
      std::uint32_t t = 0;
      take<std::uint32_t>(all[r], at, {&t, 1});
      std::vector<MatrixEntry> entries(cell_count(tiles[t]));
      for_each_pair(tiles[t], [&](std::size_t, std::size_t, std::size_t cell) {
        take<MatrixEntry>(all[r], at, {&entries[cell], 1});
      });
      computed(tiles[t], entries);
      is_done[t] = 1;
    }
  }
}

void MatrixSearch::fill(const std::string& label, const IsMissing& is_missing, const ComputeTile& compute) {
  std::vector<FrameTile> todo = missing_tiles(is_missing);
  if (todo.empty()) return;
  Progress progress(label, pair_count(todo));
  const auto computed = [&](const FrameTile& tile, std::span<const MatrixEntry> entries) {
    for_each_pair(tile, [&](std::size_t a, std::size_t b, std::size_t cell) {
      if (is_missing(matrix_.entry(a, b))) matrix_.set(a, b, entries[cell]);
    });
    progress.advance(pair_count(tile));
  };
  const auto ranks = static_cast<std::size_t>(Ranks::count());
  const auto rank = static_cast<std::size_t>(Ranks::index());
  while (!todo.empty()) {
    // Every rank works for a while on its share of what is left: one that is slower gets less by and by.
    const std::size_t first = todo.size() * rank / ranks;
    const std::size_t count = todo.size() * (rank + 1) / ranks - first;
    std::vector<std::uint8_t> is_done(todo.size(), 0);
    work(std::span(todo).subspan(first, count), std::span(is_done).subspan(first, count), compute, computed);
    if (ranks > 1) exchange(todo, is_done, computed);
    std::size_t left = 0;
    for (std::size_t t = 0; t < todo.size(); ++t) {
      if (is_done[t] == 0) todo[left++] = todo[t];
    }
    todo.resize(left);
    if (todo.empty() || store_.is_due()) store_.save(matrix_);
    spdlog::debug("{}: {} pairs left", label, pair_count(todo));
  }
}

void MatrixSearch::bound_all() {
  fill(
      "bounding pairs of frames", [](const MatrixEntry& entry) { return std::isinf(entry.value); },
      metric_.bound_tile);
}

void MatrixSearch::make_all_exact(std::span<const PairEntry> found) {
  for (const PairEntry& f : found) matrix_.set(f.a, f.b, f.entry);
  fill(
      "comparing pairs of frames", [](const MatrixEntry& entry) { return !entry.is_exact(); },
      [&](const FrameTile& tile, std::span<MatrixEntry> out) {
        // Bounds again, though they may be known: they make the rest much faster.
        SearchStatistics statistics = metric_.bound_tile(tile, out);
        for_each_pair(tile, [&](std::size_t a, std::size_t b, std::size_t cell) {
          if (!matrix_.is_exact(a, b) && !out[cell].is_exact()) out[cell] = metric_.exact(a, b, statistics);
          throw_if_interrupted();
        });
        return statistics;
      });
}

std::vector<Transition> MatrixSearch::find_share(const PerformanceDatabase& database,
                                                 const TransitionOptions& options,
                                                 const ClipPairFilter& share, std::vector<PairEntry>& found) {
  // Entries found before are not put into the matrix but given when they are asked for: the search then takes
  // the same way as if it had never been stopped.
  std::unordered_map<std::uint64_t, MatrixEntry> known;
  for (const PairEntry& f : found) known.emplace(pair_id(f.a, f.b), f.entry);
  std::mutex mutex;
  const auto exact_entry = [&](std::size_t a, std::size_t b) {
    throw_if_interrupted();
    if (const auto at = known.find(pair_id(a, b)); at != known.end()) return at->second;
    SearchStatistics statistics;
    const MatrixEntry entry = metric_.exact(a, b, statistics);
    const std::scoped_lock lock(mutex);
    statistics_ += statistics;
    found.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), entry});
    if (store_.is_due()) store_.save_found(found);
    return entry;
  };
  try {
    return find_transitions(database, matrix_, exact_entry, options, share);
  } catch (...) {
    store_.save_found(found);
    throw;
  }
}

std::vector<Transition> MatrixSearch::find(const PerformanceDatabase& database,
                                           const TransitionOptions& options,
                                           std::span<const PairEntry> found_before) {
  std::vector<PairEntry> found(found_before.begin(), found_before.end());
  ClipPairFilter share;  // empty: all
  if (Ranks::count() > 1) {
    share = [owners = ClipPairOwners(matrix_)](std::size_t clip_a, std::size_t clip_b) {
      return owners.rank_of(clip_a, clip_b) == Ranks::index();
    };
  }
  std::vector<Transition> transitions = find_share(database, options, share, found);
  if (Ranks::count() > 1) {
    const auto all = Ranks::all_gather(std::as_bytes(std::span(found).subspan(found_before.size())));
    found.resize(found_before.size());
    for (const std::vector<std::byte>& part : all) {
      std::vector<PairEntry> entries(part.size() / sizeof(PairEntry));
      std::size_t at = 0;
      take<PairEntry>(part, at, entries);
      found.insert(found.end(), entries.begin(), entries.end());
    }
  }
  for (const PairEntry& f : found) matrix_.set(f.a, f.b, f.entry);
  if (!found.empty()) store_.save(matrix_);
  // Each rank has the transitions of its share; the entries of all now decide the whole list.
  if (Ranks::count() > 1) transitions = find_share(database, options, {}, found);
  return transitions;
}

void MatrixSearch::decide(const PerformanceDatabase& database, const TransitionOptions& options,
                          std::span<const TransitionRequest> requests) {
  std::mutex mutex;
  bool is_new = false;
  const auto exact_entry = [&](std::size_t a, std::size_t b) {
    throw_if_interrupted();
    SearchStatistics statistics;
    const MatrixEntry entry = metric_.exact(a, b, statistics);
    const std::scoped_lock lock(mutex);
    statistics_ += statistics;
    is_new = true;
    return entry;
  };
  for (const TransitionRequest& request : requests) {
    (void)measure_transition(database, matrix_, exact_entry, request, options);
  }
  if (is_new) store_.save(matrix_);
}

SearchStatistics MatrixSearch::statistics() const {
  SearchStatistics sum;
  for (const std::vector<std::byte>& part : Ranks::all_gather(std::as_bytes(std::span(&statistics_, 1)))) {
    SearchStatistics statistics;
    std::size_t at = 0;
    take<SearchStatistics>(part, at, {&statistics, 1});
    sum += statistics;
  }
  return sum;
}

}  // namespace reprise
