// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/trellis_sweep.h"

#include <algorithm>
#include <array>
#include <limits>

#include "reprise/core/parallel.h"

namespace reprise::path_detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Nodes that are swept together: what they need stays in the first cache.
constexpr std::size_t part_size = 512;
// Parts worth sharing out among threads: a row of fewer takes less time than waking one up.
constexpr std::size_t parallel_parts = 32;
constexpr std::size_t unreachable = 2;  // nodes before the first, so that i - 2 needs no test

}  // namespace

TrellisSweep::TrellisSweep(const Trellis& trellis, const SweepOptions& options, std::size_t row_count)
    : trellis_(trellis),
      options_(options),
      nodes_(trellis.node_count()),
      best_(infinity),
      skip_cost_(options.skip_cost),
      last_(nodes_ + unreachable, infinity),
      next_(nodes_ + unreachable, infinity),
      arrivals_(nodes_ * (static_cast<std::size_t>(options.most_repeats) + 1)) {
  // What must not be shown has an infinite c_skel, which no limit lets through.
  options_.limit = std::min(options_.limit, static_cast<double>(std::numeric_limits<float>::max()));
  const bool counted = options.rule == SweepRule::sum;
  if (!counted) skip_cost_ = 0.0;
  if (!options.allow_skips) skip_cost_ = infinity;
  const std::size_t entered_count = trellis.entered_nodes().size();
  for (std::size_t n = 0; n < entered_count; ++n) {
    first_entry_.push_back(entry_from_.size());
    for (const Trellis::Entry& entry : trellis.entries(n)) {
      entry_from_.push_back(entry.from);
      entry_cost_.push_back((counted ? entry.cost : 0.0) + (entry.is_skip() ? skip_cost_ : 0.0));
    }
  }
  first_entry_.push_back(entry_from_.size());
  const std::size_t kept_rows = options.rule == SweepRule::sum ? row_count : 1;
  codes_ = std::make_unique_for_overwrite<std::uint8_t[]>(kept_rows * nodes_);
  choices_ = std::make_unique_for_overwrite<std::uint16_t[]>(kept_rows * entered_count);
}

void TrellisSweep::arrive(std::size_t first, std::size_t end, double* arrivals, std::uint8_t* codes) {
  if (row_ == 0) {
    // A walk begins with a captured frame.
    const std::size_t captured = std::clamp(trellis_.captured_count(), first, end);
    std::fill(arrivals, arrivals + (captured - first), 0.0);
    std::fill(arrivals + (captured - first), arrivals + (end - first), infinity);
    std::fill(codes, codes + (end - first), static_cast<std::uint8_t>(Arrival::start));
    return;
  }
  const double* const last = last_.data() + unreachable + first;
  for (std::size_t i = 0; i < end - first; ++i) {
    const double step = *(last + i - 1);
    const double skip = *(last + i - 2) + skip_cost_;
    arrivals[i] = skip < step ? skip : step;
    codes[i] = static_cast<std::uint8_t>(skip < step ? Arrival::skip : Arrival::step);
  }
  begin_runs(first, end, arrivals, codes);
  const auto entered = trellis_.entered_nodes();
  const std::size_t kept_row = options_.rule == SweepRule::sum ? row_ : 0;
  std::uint16_t* const choices = choices_.get() + kept_row * entered.size();
  auto n = static_cast<std::size_t>(std::ranges::lower_bound(entered, static_cast<std::int32_t>(first)) -
                                    entered.begin());
  for (; n < entered.size() && static_cast<std::size_t>(entered[n]) < end; ++n) {
    const std::size_t i = static_cast<std::size_t>(entered[n]) - first;
    // Without branches, which nobody could predict here.
    double least = arrivals[i];
    const std::size_t none = first_entry_[n + 1];
    std::size_t choice = none;
    for (std::size_t e = first_entry_[n]; e < none; ++e) {
      const double cost = last_[unreachable + static_cast<std::size_t>(entry_from_[e])] + entry_cost_[e];
      choice = cost < least ? e : choice;
      least = cost < least ? cost : least;
    }
    arrivals[i] = least;
    codes[i] = choice < none ? static_cast<std::uint8_t>(Arrival::entry) : codes[i];
    choices[n] = static_cast<std::uint16_t>(choice - first_entry_[n]);
  }
}

// The nodes before the first of a run belong to another.
void TrellisSweep::begin_runs(std::size_t first, std::size_t end, double* arrivals,
                              std::uint8_t* codes) const {
  const auto runs = trellis_.runs();
  auto run = std::ranges::partition_point(runs, [&](const Trellis::Run& r) { return r.first + 1 < first; });
  for (; run != runs.end() && run->first < end; ++run) {
    if (run->first >= first) arrivals[run->first - first] = infinity;
    const std::size_t second = run->first + 1;
    if (second < first || second >= std::min(end, run->end)) continue;
    arrivals[second - first] = last_[unreachable + run->first];
    codes[second - first] = static_cast<std::uint8_t>(Arrival::step);
  }
}

template <SweepRule rule>
double TrellisSweep::sweep_part(const float* dissimilarities, std::size_t first, std::size_t end) {
  const std::size_t size = end - first;
  const std::size_t ring = static_cast<std::size_t>(options_.most_repeats) + 1;
  std::uint8_t* const codes = codes_.get() + (rule == SweepRule::sum ? row_ * nodes_ : 0) + first;
  double* const newest = arrivals_.data() + (row_ % ring) * nodes_ + first;
  arrive(first, end, newest, codes);

  std::array<double, part_size> node_cost;
  const float* const row = dissimilarities + first;
  const double weight = rule == SweepRule::sum ? options_.weight : 1.0;
  for (std::size_t i = 0; i < size; ++i) {
    const double dissimilarity = row[i];
    node_cost[i] = dissimilarity <= options_.limit ? weight * dissimilarity : infinity;
  }
  double* const best = next_.data() + unreachable + first;
  for (std::size_t i = 0; i < size; ++i) {
    newest[i] = rule == SweepRule::sum ? newest[i] + node_cost[i] : std::max(newest[i], node_cost[i]);
    best[i] = newest[i];
  }
  std::array<std::uint8_t, part_size> repeats;
  std::fill_n(repeats.begin(), size, std::uint8_t{0});
  const std::size_t most = std::min(ring - 1, row_);
  for (std::size_t r = 1; r <= most; ++r) {
    double* const older = arrivals_.data() + ((row_ - r) % ring) * nodes_ + first;
    const double repeat_cost = options_.repeat_cost;
    const auto shown = static_cast<std::uint8_t>(4 * r);
    for (std::size_t i = 0; i < size; ++i) {
      const double cost =
          rule == SweepRule::sum ? older[i] + (node_cost[i] + repeat_cost) : std::max(older[i], node_cost[i]);
      older[i] = cost;
      repeats[i] = cost < best[i] ? shown : repeats[i];
      best[i] = cost < best[i] ? cost : best[i];
    }
  }
  double least = infinity;
  for (std::size_t i = 0; i < size; ++i) {
    codes[i] = static_cast<std::uint8_t>(codes[i] + repeats[i]);
    least = best[i] < least ? best[i] : least;
  }
  return least;
}

bool TrellisSweep::advance(const float* dissimilarities) {
  const std::size_t parts = (nodes_ + part_size - 1) / part_size;
  std::vector<double> least(parts);
  const auto sweep = [&](std::size_t part) {
    const std::size_t first = part * part_size;
    const std::size_t end = std::min(first + part_size, nodes_);
    least[part] = options_.rule == SweepRule::sum
                      ? sweep_part<SweepRule::sum>(dissimilarities, first, end)
                      : sweep_part<SweepRule::greatest>(dissimilarities, first, end);
  };
  if (parts < parallel_parts) {
    for (std::size_t part = 0; part < parts; ++part) sweep(part);
  } else {
    parallel_for(0, parts, sweep, parallel_parts / 4);
  }
  best_ = *std::ranges::min_element(least);
  last_.swap(next_);
  ++row_;
  return best_ < infinity;
}

std::vector<TrellisSweep::Visit> TrellisSweep::walk() const {
  std::vector<Visit> visits;
  const auto costs = last_.begin() + unreachable;
  auto node = static_cast<std::size_t>(std::min_element(costs, last_.end()) - costs);
  std::size_t row = row_ - 1;
  while (true) {
    const unsigned repeats = codes_[row * nodes_ + node] / 4U;
    visits.insert(visits.end(), repeats, {.node = node, .arrival = Arrival::repeat});
    row -= repeats;
    Visit visit{.node = node, .arrival = static_cast<Arrival>(codes_[row * nodes_ + node] % 4U)};
    if (visit.arrival == Arrival::entry) {
      const auto entered = trellis_.entered_nodes();
      const auto n = static_cast<std::size_t>(
          std::ranges::lower_bound(entered, static_cast<std::int32_t>(node)) - entered.begin());
      visit.entry = &trellis_.entries(n)[choices_[row * entered.size() + n]];
    }
    visits.push_back(visit);
    if (visit.arrival == Arrival::start) break;
    --row;
    node = visit.entry ? static_cast<std::size_t>(visit.entry->from)
                       : node - (visit.arrival == Arrival::skip ? 2 : 1);
  }
  std::ranges::reverse(visits);
  return visits;
}

}  // namespace reprise::path_detail
