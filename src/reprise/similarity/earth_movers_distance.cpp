// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/earth_movers_distance.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/similarity/transport_simplex.h"

namespace reprise {
namespace {

constexpr Int128 no_cutoff = Int128{1} << 120;

// Masses of two histograms in a common unit: a's times `a`, b's times `b` sum to `total` each.
struct CommonUnit {
  std::int64_t a = 1;
  std::int64_t b = 1;
  std::int64_t total = 0;
};

CommonUnit common_unit(const Signature& a, const Signature& b) {
  if (a.total <= 0 || b.total <= 0) {
    throw InvalidArgument("earth mover's distance of an empty histogram: expected some mass on both sides");
  }
  const std::int64_t divisor = std::gcd(a.total, b.total);
  return {b.total / divisor, a.total / divisor, a.total / divisor * b.total};
}

double to_meters(Int128 cost, std::int64_t total) {
  return static_cast<double>(cost) / static_cast<double>(total) * BinGrid::distance_unit;
}

// Calls `visit(bin, mass)` with the signed difference of the masses, in order of bin.
template <typename Visit>
void for_each_difference(const Signature& a, const Signature& b, const CommonUnit& unit, const Visit& visit) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() || j < b.size()) {
    if (j == b.size() || (i < a.size() && a.bins[i] < b.bins[j])) {
      visit(a.bins[i], a.masses[i] * unit.a);
      ++i;
    } else if (i == a.size() || b.bins[j] < a.bins[i]) {
      visit(b.bins[j], -b.masses[j] * unit.b);
      ++j;
    } else {
      visit(a.bins[i], a.masses[i] * unit.a - b.masses[j] * unit.b);
      ++i;
      ++j;
    }
  }
}

}  // namespace

void PotentialFunction::set(const Potential& potential) {
  anchors_.clear();
  values_.clear();
  for (const std::int32_t k : potential.anchors) {
    anchors_.push_back(grid_->place(potential.bins[static_cast<std::size_t>(k)]));
    values_.push_back(potential.values[static_cast<std::size_t>(k)]);
  }
  distances_.resize(anchors_.size());
}

std::int64_t PotentialFunction::operator()(BinId bin) {
  grid_->distances(bin, anchors_, distances_.data());
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  for (std::size_t k = 0; k < anchors_.size(); ++k) {
    const std::int64_t value = values_[k] + distances_[k];
    least = value < least ? value : least;
  }
  return least;
}

struct EarthMoversSolver::State {
  std::shared_ptr<const BinGrid> grid;
  TransportSimplex simplex;
  Potential potential;

  std::vector<BinId> source_bins, sink_bins;
  std::vector<std::int64_t> supplies, demands;
  std::vector<BinGrid::Place> sink_places;
  std::vector<std::int32_t> source_of_place, sink_of_place, new_sinks;

  void keep_potential();
  void start_from(const Potential& guess);
};

EarthMoversSolver::EarthMoversSolver(std::shared_ptr<const BinGrid> grid)
    : state_(std::make_unique<State>()) {
  state_->grid = std::move(grid);
}
EarthMoversSolver::~EarthMoversSolver() = default;
EarthMoversSolver::EarthMoversSolver(EarthMoversSolver&&) noexcept = default;
EarthMoversSolver& EarthMoversSolver::operator=(EarthMoversSolver&&) noexcept = default;

const Potential& EarthMoversSolver::potential() const {
  return state_->potential;
}

// On all nodes, which all have mass: there, the dual solution is the value of its own extension from the
// sinks.
void EarthMoversSolver::State::keep_potential() {
  const std::int64_t* u = simplex.source_potentials();
  const std::int64_t* v = simplex.sink_potentials();
  const std::int64_t least = *std::min_element(v, v + sink_bins.size());
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < source_bins.size() || j < sink_bins.size()) {
    if (j == sink_bins.size() || (i < source_bins.size() && source_bins[i] < sink_bins[j])) {
      potential.bins.push_back(source_bins[i]);
      potential.values.push_back(static_cast<std::int32_t>(u[i] - least));
      ++i;
    } else {
      potential.anchors.push_back(static_cast<std::int32_t>(potential.bins.size()));
      potential.bins.push_back(sink_bins[j]);
      potential.values.push_back(static_cast<std::int32_t>(v[j] - least));
      ++j;
    }
  }
}

// Values of the sinks; the simplex finds those of the sources.
void EarthMoversSolver::State::start_from(const Potential& guess) {
  if (guess.empty()) return;
  const auto find_nodes = [&](const std::vector<BinId>& bins, std::vector<std::int32_t>& node_of) {
    node_of.assign(guess.bins.size(), -1);
    std::size_t place = 0;
    for (std::size_t k = 0; k < bins.size(); ++k) {
      while (place < guess.bins.size() && guess.bins[place] < bins[k]) ++place;
      if (place == guess.bins.size()) break;
      if (guess.bins[place] == bins[k]) node_of[place] = static_cast<std::int32_t>(k);
    }
  };
  find_nodes(source_bins, source_of_place);
  find_nodes(sink_bins, sink_of_place);
  std::int64_t* v = simplex.sink_potentials();
  constexpr std::int64_t unknown = std::numeric_limits<std::int64_t>::min();
  std::fill_n(v, sink_bins.size(), unknown);
  for (std::size_t place = 0; place < guess.bins.size(); ++place) {
    if (sink_of_place[place] >= 0) v[sink_of_place[place]] = guess.values[place];
  }
  // A sink that is new: as low as the known sources allow.
  new_sinks.clear();
  for (std::size_t j = 0; j < sink_bins.size(); ++j) {
    if (v[j] == unknown) new_sinks.push_back(static_cast<std::int32_t>(j));
  }
  for (std::size_t place = 0; place < guess.bins.size() && !new_sinks.empty(); ++place) {
    if (source_of_place[place] < 0) continue;
    const std::int32_t* costs = simplex.cost_row(static_cast<std::size_t>(source_of_place[place]));
    for (const std::int32_t j : new_sinks) {
      v[j] = std::max(v[j], static_cast<std::int64_t>(guess.values[place]) - costs[j]);
    }
  }
  for (const std::int32_t j : new_sinks) {
    if (v[j] == unknown) v[j] = 0;
  }
}

EarthMoversDistance EarthMoversSolver::solve(const Signature& a, const Signature& b, const Potential* guess,
                                             double cutoff) {
  State& s = *state_;
  const CommonUnit unit = common_unit(a, b);
  // The ground distance is a metric: what both have in a bin may stay there.
  s.source_bins.clear();
  s.sink_bins.clear();
  s.supplies.clear();
  s.demands.clear();
  for_each_difference(a, b, unit, [&](BinId bin, std::int64_t mass) {
    if (mass > 0) {
      s.source_bins.push_back(bin);
      s.supplies.push_back(mass);
    } else if (mass < 0) {
      s.sink_bins.push_back(bin);
      s.demands.push_back(-mass);
    }
  });
  if (s.source_bins.empty()) {
    s.potential = {.bins = {a.bins.front()}, .values = {0}, .anchors = {0}};
    return {};
  }
  s.simplex.resize(s.source_bins.size(), s.sink_bins.size());
  std::ranges::copy(s.supplies, s.simplex.supplies());
  std::ranges::copy(s.demands, s.simplex.demands());
  s.sink_places.clear();
  for (const BinId bin : s.sink_bins) s.sink_places.push_back(s.grid->place(bin));
  for (std::size_t i = 0; i < s.source_bins.size(); ++i) {
    s.grid->distances(s.source_bins[i], s.sink_places, s.simplex.cost_row(i));
  }
  if (guess != nullptr) s.start_from(*guess);
  s.potential = {};  // only now: the guess may be our own last one
  const double most = cutoff / BinGrid::distance_unit * static_cast<double>(unit.total);
  const bool finished = s.simplex.solve(most < 1e36 ? static_cast<Int128>(most) : no_cutoff);
  const double lower_bound = to_meters(s.simplex.dual_bound(), unit.total);
  if (!finished) {
    return {.distance = std::numeric_limits<double>::infinity(), .lower_bound = lower_bound, .exact = false};
  }
  s.keep_potential();
  return {.distance = to_meters(s.simplex.cost(), unit.total), .lower_bound = lower_bound, .exact = true};
}

}  // namespace reprise
