// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Local minima of a block of the matrix of which only bounds are known.

#pragma once

#include <cstdint>
#include <cstdlib>
#include <vector>

#include "reprise/graph/matrix_block.h"

namespace reprise {

// Where the centre of a transition may lie: the shortest window fits into both clips, and a clip does not
// meet itself at nearly the same time.
class TransitionRegion {
 public:
  TransitionRegion(const MatrixBlock& block, bool is_self, const TransitionOptions& options)
      : first_(options.min_half_window),
        last_m_(block.rows() - 1 - options.min_half_window),
        last_n_(block.columns() - 1 - options.min_half_window),
        min_gap_(is_self ? options.self_min_gap : 0) {}

  int first() const { return first_; }
  int last_m() const { return last_m_; }
  int last_n() const { return last_n_; }
  bool fits(Pixel p) const { return p.m >= first_ && p.m <= last_m_ && p.n >= first_ && p.n <= last_n_; }
  bool is_trivial(Pixel p) const { return std::abs(p.m - p.n) < min_gap_; }
  bool contains(Pixel p) const { return fits(p) && !is_trivial(p); }

 private:
  int first_;
  int last_m_;
  int last_n_;
  int min_gap_;
};

// Local minima among the eight neighbours, one for a plateau of equal values: where the longest window fits,
// of several the first in reading order. Neighbours whose window would not fit do not count: a clip's end may
// cut a valley. Those near the diagonal of a clip with itself do count: the slope down to "no transition at
// all" is not a valley.
class LocalMinima {
 public:
  // `batch_size`: entries that are made exact at a time.
  LocalMinima(MatrixBlock& block, const TransitionRegion& region, std::size_t batch_size);

  // True if bounds alone show that p is no minimum. Requires that the region contains p.
  bool is_excluded(Pixel p) const;

  // True if `contains` has been asked for p, or has met it on the way.
  bool is_known(Pixel p) const { return states_[index(p)] != State::unknown; }

  // Makes exact what the answer depends on. Requires that the region contains p.
  bool contains(Pixel p);

 private:
  enum class State : std::uint8_t { unknown, visited, no_minimum, minimum };

  std::size_t index(Pixel p) const {
    return static_cast<std::size_t>(p.m) * static_cast<std::size_t>(block_.columns()) +
           static_cast<std::size_t>(p.n);
  }
  State& state(Pixel p) { return states_[index(p)]; }
  template <typename Visit>
  void for_each_neighbor(Pixel p, const Visit& visit) const;
  bool has_lower_neighbor(Pixel p, float value) const;
  // Adds to `plateau` what is known to belong to it, from its `first`th pixel on; false if a neighbour of
  // those is known to be lower.
  bool spreads(std::vector<Pixel>& plateau, std::size_t first);
  // Adds to `plateau`, a pixel, until it is whole; false if it is no minimum.
  bool completes(std::vector<Pixel>& plateau);
  Pixel representative(std::vector<Pixel> plateau) const;

  MatrixBlock& block_;
  TransitionRegion region_;
  std::size_t batch_size_;
  std::vector<State> states_;
};

}  // namespace reprise
