// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/shape_color_metric.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "reprise/math/ground_transform.h"
#include "reprise/similarity/tile_search.h"

namespace reprise {
namespace {

constexpr std::size_t tile_frames = 10;
// Turns are given in 200ths of the circle, the number the paper tries.
// At these the middle of a tile is solved, relative to its own best one: close together where the distance is
// least, for a potential says less and less about turns farther away (up to `reach`).
struct Probe {
  int turn = 0;
  int reach = 0;
  bool restarts = false;  // far from the one before: starts from the first
};
constexpr std::array<Probe, 19> probes = {{{0, 8, false},
                                           {4, 8, false},
                                           {9, 8, false},
                                           {15, 8, false},
                                           {22, 9, false},
                                           {31, 11, false},
                                           {43, 14, false},
                                           {58, 17, false},
                                           {78, 22, false},
                                           {100, 22, false},
                                           {-4, 8, true},
                                           {-9, 8, false},
                                           {-15, 8, false},
                                           {-22, 9, false},
                                           {-31, 11, false},
                                           {-43, 14, false},
                                           {-58, 17, false},
                                           {-78, 22, false},
                                           {-90, 12, false}}};
// How far from a solved turn its potential is asked about others.
constexpr int reach_of_potential = 10;
// Solves beyond one a pair, in hundredths of the pairs, spent where bounds are below this share of the value.
constexpr std::size_t extra_solves = 40;
constexpr double good_share = 0.93;
constexpr double promising_share = 0.98;  // of a value: a bound below it may lead to a better one

std::size_t apart(std::size_t a, std::size_t b) {
  return a > b ? a - b : b - a;
}

// Mass that two histograms have in the same bins, as a share.
double overlap(const Signature& a, const Signature& b) {
  double sum = 0.0;
  std::size_t j = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    while (j < b.size() && b.bins[j] < a.bins[i]) ++j;
    if (j == b.size()) break;
    if (b.bins[j] == a.bins[i]) {
      sum += std::min(a.masses[i] / static_cast<double>(a.total), b.masses[j] / static_cast<double>(b.total));
    }
  }
  return sum;
}

}  // namespace

ShapeColorMetric::ShapeColorMetric(const PerformanceDatabase& database, const HistogramOptions& options)
    : histograms_(database, options), grid_(histograms_.shared_grid()) {
  for (const MeshSequence& clip : database.clips()) {
    const std::size_t first = tile_start_.size();
    for (std::size_t f = 0; f < clip.frame_count(); ++f) {
      tile_start_.push_back(first + f / tile_frames * tile_frames);
    }
  }
}

std::vector<FrameTile> ShapeColorMetric::tiles(std::span<const std::size_t> clip_frame_counts) {
  std::vector<FrameTile> result;
  std::size_t first_a = 0;
  for (std::size_t i = 0; i < clip_frame_counts.size(); ++i) {
    const std::size_t end_a = first_a + clip_frame_counts[i];
    std::size_t first_b = first_a;
    for (std::size_t j = i; j < clip_frame_counts.size(); ++j) {
      const std::size_t end_b = first_b + clip_frame_counts[j];
      for (std::size_t a = first_a; a < end_a; a += tile_frames) {
        for (std::size_t b = i == j ? a : first_b; b < end_b; b += tile_frames) {
          result.push_back({a, std::min(a + tile_frames, end_a), b, std::min(b + tile_frames, end_b)});
        }
      }
      first_b = end_b;
    }
    first_a = end_a;
  }
  return result;
}

const ShapeColorMetric::TileMemory* ShapeColorMetric::memory_of(std::size_t a, std::size_t b) const {
  const std::lock_guard lock(mutex_);
  const auto found = memory_.find({tile_start_.at(a), tile_start_.at(b)});
  return found == memory_.end() ? nullptr : &found->second;
}

MatrixEntry ShapeColorMetric::entry_at(std::size_t a, std::size_t b, int turn, double lower,
                                       double value) const {
  const double step = 2.0 * std::numbers::pi / grid_->turn_count();
  const double yaw = histograms_.frame(b).yaw - histograms_.frame(a).yaw + step * turn;
  return {.lower = static_cast<float>(std::min(lower, value)),
          .value = static_cast<float>(value),
          .yaw = static_cast<float>(wrap_angle(yaw))};
}

int ShapeColorMetric::turn_of_most_overlap(std::size_t a, std::size_t b) const {
  Signature turned_a;
  Signature turned_b;
  int best = 0;
  double most = -1.0;
  for (int position = 0; position < grid_->turn_count(); ++position) {
    const int turn = grid_->turn_at(position);
    histograms_.signature(a, -turn, turned_a);
    histograms_.signature(b, turn, turned_b);
    const double shared = overlap(turned_a, turned_b);
    if (shared > most) {
      most = shared;
      best = turn;
    }
  }
  return best;
}

SearchStatistics ShapeColorMetric::bound_tile(const FrameTile& tile, std::span<MatrixEntry> out) {
  const std::size_t rows = tile.a_last - tile.a_first;
  const std::size_t columns = tile.b_last - tile.b_first;
  const bool is_diagonal = tile.a_first == tile.b_first;
  if (is_diagonal && rows < 2) return {};
  const int turns = grid_->turn_count();
  const auto of_circle = [&](int share) { return share * turns / 200; };
  TileSearch search(histograms_, tile);

  // The middle pair, all round.
  const std::size_t middle_row = is_diagonal ? rows / 4 : rows / 2;
  const std::size_t middle_column = is_diagonal ? (3 * columns) / 4 : columns / 2;
  const int middle = turn_of_most_overlap(tile.a_first + middle_row, tile.b_first + middle_column);
  Potential first;
  Potential guess;
  for (const Probe& probe : probes) {
    if (probe.restarts) guess = first;
    search.solve(middle_row, middle_column, middle + of_circle(probe.turn), guess.empty() ? nullptr : &guess,
                 std::max(1, of_circle(probe.reach)));
    guess = search.potential();
    if (first.empty()) first = guess;
  }

  // Every pair at its most promising turn, going to and fro so that each starts from a neighbour.
  const int reach = std::max(1, of_circle(reach_of_potential));
  const auto least_of = [&](std::size_t pair) {
    const auto bounds = search.bounds(pair);
    return static_cast<int>(std::ranges::min_element(bounds) - bounds.begin());
  };
  std::vector<std::size_t> pairs;
  guess = first;
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t k = 0; k < columns; ++k) {
      const std::size_t column = row % 2 == 0 ? k : columns - 1 - k;
      if (tile.a_first + row >= tile.b_first + column) continue;
      pairs.push_back(search.pair(row, column));
      search.solve(row, column, least_of(pairs.back()), &guess, reach);
      guess = search.potential();
    }
  }
  // The pair that is known worst once more, until all are known well.
  for (std::size_t budget = pairs.size() * extra_solves / 100; budget > 0; --budget) {
    std::size_t worst = pairs.front();
    double least_share = std::numeric_limits<double>::infinity();
    for (const std::size_t pair : pairs) {
      const double value = search.best(pair).value;
      const double share =
          value > 0.0 ? search.bounds(pair)[static_cast<std::size_t>(least_of(pair))] / value : 1.0;
      if (share < least_share) {
        least_share = share;
        worst = pair;
      }
    }
    if (least_share >= good_share) break;
    // Where a neighbour is at its best, if that may help; else where least is known.
    const auto bounds = search.bounds(worst);
    const double promising = promising_share * search.best(worst).value;
    int position = -1;
    for (const std::size_t pair : pairs) {
      const std::size_t distance =
          apart(pair / columns, worst / columns) + apart(pair % columns, worst % columns);
      const int place = search.best(pair).position;
      const double bound = bounds[static_cast<std::size_t>(place)];
      if (distance != 1 || bound > promising) continue;
      if (position < 0 || bound < bounds[static_cast<std::size_t>(position)]) position = place;
    }
    search.solve(worst / columns, worst % columns, position >= 0 ? position : least_of(worst), &guess, reach);
    guess = search.potential();
  }

  TileMemory memory{.pairs = std::vector<KnownTurns>(rows * columns), .columns = columns};
  for (const std::size_t pair : pairs) {
    const std::size_t a = tile.a_first + pair / columns;
    const std::size_t b = tile.b_first + pair % columns;
    const auto bounds = search.bounds(pair);
    const auto [value, position] = search.best(pair);
    out[pair] =
        entry_at(a, b, grid_->turn_at(position), bounds[static_cast<std::size_t>(least_of(pair))], value);
    // The arc of turns that are left: all but the longest run of others.
    int longest = 0;
    int longest_end = position + turns - 1;
    int run = 0;
    for (int p = position + 1; p < position + turns; ++p) {
      run = bounds[static_cast<std::size_t>(p % turns)] > value ? run + 1 : 0;
      if (run > longest) {
        longest = run;
        longest_end = p;
      }
    }
    const int first_open = (longest_end + 1) % turns;
    memory.pairs[pair] = {.value = value,
                          .first_bound = static_cast<std::int32_t>(memory.bounds.size()),
                          .best = static_cast<std::int16_t>(position),
                          .first = static_cast<std::int16_t>(first_open),
                          .count = static_cast<std::int16_t>(turns - longest)};
    for (int k = 0; k < turns - longest; ++k) {
      const double bound = bounds[static_cast<std::size_t>((first_open + k) % turns)];
      memory.bounds.push_back(static_cast<std::uint16_t>(std::clamp(bound / bound_unit, 0.0, 65535.0)));
    }
  }
  const std::lock_guard lock(mutex_);
  const std::size_t size =
      memory.pairs.size() * sizeof(KnownTurns) + memory.bounds.size() * sizeof(std::uint16_t);
  if (memory_size_ + size <= max_memory &&
      memory_.try_emplace({tile.a_first, tile.b_first}, std::move(memory)).second) {
    memory_size_ += size;
  }
  return search.statistics();
}

MatrixEntry ShapeColorMetric::exact(std::size_t a, std::size_t b, SearchStatistics* statistics) const {
  const int turns = grid_->turn_count();
  const int reach = std::max(1, reach_of_potential * turns / 200);
  TileSearch search(histograms_, {a, a + 1, b, b + 1});
  const auto bounds = search.bounds(0);
  // Turns that may still be the best.
  std::vector<bool> is_open(static_cast<std::size_t>(turns), true);
  const auto most_promising = [&] {
    int least = -1;
    for (int k = 0; k < turns; ++k) {
      const auto position = static_cast<std::size_t>(k);
      if (!is_open[position]) continue;
      if (bounds[position] > search.best(0).value) {
        is_open[position] = false;
      } else if (least < 0 || bounds[position] < bounds[static_cast<std::size_t>(least)]) {
        least = k;
      }
    }
    return least;
  };
  int next = 0;
  if (const TileMemory* memory = memory_of(a, b)) {
    const KnownTurns& known = memory->pairs[(a - tile_start_[a]) * memory->columns + (b - tile_start_[b])];
    search.set_best(0, known.value, known.best);
    is_open.assign(is_open.size(), false);
    for (int k = 0; k < known.count; ++k) {
      const auto position = static_cast<std::size_t>(search.wrapped(known.first + k));
      is_open[position] = static_cast<int>(position) != known.best;
      bounds[position] = bound_unit * memory->bounds[static_cast<std::size_t>(known.first_bound + k)];
    }
    next = most_promising();
  } else {
    next = search.wrapped(turn_of_most_overlap(a, b));
  }
  Potential guess;
  while (next >= 0) {
    is_open[static_cast<std::size_t>(next)] = false;
    // A potential is worth its time only where it may rule out others.
    bool has_open_neighbors = false;
    for (int k = next - reach; k <= next + reach; ++k) {
      has_open_neighbors = has_open_neighbors || is_open[static_cast<std::size_t>(search.wrapped(k))];
    }
    const double cutoff = has_open_neighbors ? std::numeric_limits<double>::infinity() : search.best(0).value;
    if (search.solve(0, 0, next, guess.empty() ? nullptr : &guess, reach, cutoff)) guess = search.potential();
    next = most_promising();
  }
  if (statistics != nullptr) *statistics += search.statistics();
  return entry_at(a, b, grid_->turn_at(search.best(0).position), search.best(0).value, search.best(0).value);
}

MatrixEntry ShapeColorMetric::brute_force(std::size_t a, std::size_t b, SearchStatistics* statistics) const {
  EarthMoversSolver solver(grid_);
  Signature turned_a;
  Signature turned_b;
  Potential guess;  // saves time, and changes no optimum
  double best = std::numeric_limits<double>::infinity();
  int best_turn = 0;
  for (int turn = -(grid_->turn_count() - 1) / 2; turn <= grid_->turn_count() / 2; ++turn) {
    histograms_.signature(a, -turn, turned_a);
    histograms_.signature(b, turn, turned_b);
    const double distance = solver.solve(turned_a, turned_b, &guess).distance;
    guess = solver.potential();
    if (distance < best ||
        (distance == best && std::pair(std::abs(turn), turn) < std::pair(std::abs(best_turn), best_turn))) {
      best = distance;
      best_turn = turn;
    }
  }
  if (statistics != nullptr) statistics->exact_solves += static_cast<std::uint64_t>(grid_->turn_count());
  return entry_at(a, b, best_turn, best, best);
}

}  // namespace reprise
