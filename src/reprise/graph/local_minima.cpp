// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/graph/local_minima.h"

#include <algorithm>
#include <set>
#include <span>
#include <tuple>

namespace reprise {

LocalMinima::LocalMinima(MatrixBlock& block, const TransitionRegion& region, std::size_t batch_size)
    : block_(block),
      region_(region),
      batch_size_(batch_size),
      states_(static_cast<std::size_t>(block.rows()) * static_cast<std::size_t>(block.columns()),
              State::unknown) {}

template <typename Visit>
void LocalMinima::for_each_neighbor(Pixel p, const Visit& visit) const {
  for (int m = p.m - 1; m <= p.m + 1; ++m) {
    for (int n = p.n - 1; n <= p.n + 1; ++n) {
      const Pixel q{m, n};
      if (q != p && region_.fits(q)) visit(q);
    }
  }
}

bool LocalMinima::has_lower_neighbor(Pixel p, float value) const {
  bool has_lower = false;
  for_each_neighbor(p, [&](Pixel q) { has_lower = has_lower || block_.value(q.m, q.n) < value; });
  return has_lower;
}

bool LocalMinima::is_excluded(Pixel p) const {
  return has_lower_neighbor(p, block_.lower(p.m, p.n));
}

bool LocalMinima::spreads(std::vector<Pixel>& plateau, std::size_t first) {
  const float value = block_.value(plateau.front().m, plateau.front().n);
  for (std::size_t i = first; i < plateau.size(); ++i) {
    bool has_lower = false;
    for_each_neighbor(plateau[i], [&](Pixel q) {
      const float other = block_.value(q.m, q.n);
      // Once a walk has met something lower, all it has visited is marked: the same plateau, no minimum.
      has_lower = has_lower || other < value || (other == value && state(q) == State::no_minimum);
      if (other != value || !block_.is_exact(q) || region_.is_trivial(q) || state(q) != State::unknown)
        return;
      state(q) = State::visited;
      plateau.push_back(q);
    });
    if (has_lower) return false;
  }
  return true;
}

// All that is known is used before anything is asked for: whoever asks first, of one plateau the same is
// asked for, and nothing once it is decided.
bool LocalMinima::completes(std::vector<Pixel>& plateau) {
  const float value = block_.value(plateau.front().m, plateau.front().n);
  const auto by_bound = [&](Pixel q) { return std::tuple(block_.lower(q.m, q.n), q); };
  std::set<std::tuple<float, Pixel>> doubtful;
  std::size_t spread_count = 0;
  while (true) {
    const std::size_t first = spread_count;
    if (!spreads(plateau, first)) return false;
    for (spread_count = first; spread_count < plateau.size(); ++spread_count) {
      for_each_neighbor(plateau[spread_count], [&](Pixel q) {
        if (block_.lower(q.m, q.n) <= value && !block_.is_exact(q)) doubtful.insert(by_bound(q));
      });
    }
    // Lowest bound first.
    std::vector<Pixel> asked;
    while (!doubtful.empty() && asked.size() < batch_size_) {
      asked.push_back(std::get<Pixel>(*doubtful.begin()));
      doubtful.erase(doubtful.begin());
    }
    if (asked.empty()) return true;
    block_.make_exact(asked);
    for (const Pixel q : asked) {
      const float other = block_.value(q.m, q.n);
      if (other < value) return false;
      if (other != value || region_.is_trivial(q) || state(q) != State::unknown) continue;
      state(q) = State::visited;
      plateau.push_back(q);
    }
  }
}

Pixel LocalMinima::representative(std::vector<Pixel> plateau) const {
  const auto room = [&](Pixel p) {
    return std::min({p.m, block_.rows() - 1 - p.m, p.n, block_.columns() - 1 - p.n});
  };
  // Reading order decides, not the order of the walk over the plateau.
  std::ranges::sort(plateau);
  return *std::ranges::max_element(plateau, {}, room);
}

bool LocalMinima::contains(Pixel p) {
  if (state(p) != State::unknown) return state(p) == State::minimum;
  if (is_excluded(p)) {
    state(p) = State::no_minimum;
    return false;
  }
  block_.make_exact(std::span(&p, 1));
  std::vector<Pixel> plateau = {p};
  state(p) = State::visited;
  const bool is_whole = completes(plateau);
  for (const Pixel q : plateau) state(q) = State::no_minimum;
  if (!is_whole) return false;
  const Pixel minimum = representative(plateau);
  state(minimum) = State::minimum;
  return minimum == p;
}

}  // namespace reprise
