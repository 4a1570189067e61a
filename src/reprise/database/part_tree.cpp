// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/database/part_tree.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

using Counts = std::vector<std::vector<std::size_t>>;

Counts count_shared(const std::vector<BodyPart>& parts) {
  Counts shared(parts.size(), std::vector<std::size_t>(parts.size(), 0));
  for (std::size_t a = 0; a < parts.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      std::vector<std::int32_t> both;
      std::ranges::set_intersection(parts[a].vertices, parts[b].vertices, std::back_inserter(both));
      shared[a][b] = shared[b][a] = both.size();
    }
  }
  return shared;
}

void check(std::vector<BodyPart> parts, int root_idx) {
  if (root_idx < 0 || static_cast<std::size_t>(root_idx) >= parts.size()) {
    throw InvalidArgument(
        fmt::format("the root part {} is out of range: there are {} parts", root_idx, parts.size()));
  }
  for (std::size_t p = 0; p < parts.size(); ++p) parts[p].parent = p == 0 ? -1 : 0;
  validate(parts, std::numeric_limits<std::int32_t>::max());
}

// A part hangs on any with which it shares this much of what it shares with its best neighbour.
constexpr double near_share = 0.5;

// For every part its parent, -1 for the root and for parts that the tree does not reach.
std::vector<int> grow(const Counts& shared, std::size_t root) {
  std::vector<int> parents(shared.size(), -1);
  std::vector<int> levels(shared.size(), -1);
  levels[root] = 0;
  std::vector<std::size_t> tree = {root};
  struct Join {
    bool is_near = false;  // the two share much
    int level = 0;         // of the parent, from 0
    std::size_t shared = 0;
    std::size_t child = 0;
    std::size_t parent = 0;
    bool operator>(const Join& other) const {
      return std::tuple(is_near, is_near ? -level : 0, shared) >
             std::tuple(other.is_near, other.is_near ? -other.level : 0, other.shared);
    }
  };
  while (true) {
    std::optional<Join> best;
    for (std::size_t c = 0; c < shared.size(); ++c) {
      if (levels[c] >= 0) continue;
      const double most = static_cast<double>(std::ranges::max(shared[c]));
      for (const std::size_t p : tree) {
        if (shared[c][p] == 0) continue;
        const Join join{.is_near = static_cast<double>(shared[c][p]) >= near_share * most,
                        .level = levels[p],
                        .shared = shared[c][p],
                        .child = c,
                        .parent = p};
        if (!best || join > *best) best = join;
      }
    }
    if (!best) return parents;
    parents[best->child] = static_cast<int>(best->parent);
    levels[best->child] = best->level + 1;
    tree.push_back(best->child);
  }
}

void check_all_reached(const std::vector<BodyPart>& parts, const Counts& shared,
                       const std::vector<int>& parents, std::size_t root) {
  std::vector<std::string> reached;
  std::vector<std::string> others;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    (p == root || parents[p] >= 0 ? reached : others).push_back(parts[p].name);
    if (parts.size() > 1 && std::ranges::count(shared[p], 0U) == static_cast<std::ptrdiff_t>(parts.size())) {
      throw InvalidArgument(fmt::format("part '{}' shares no vertex with any other part", parts[p].name));
    }
  }
  if (others.empty()) return;
  throw InvalidArgument(
      fmt::format("the parts do not hang together: no vertex is both in one of '{}' and in one of '{}'",
                  fmt::join(reached, "', '"), fmt::join(others, "', '")));
}

}  // namespace

std::vector<BodyPart> derive_hierarchy(std::vector<BodyPart> parts, int root_idx) {
  check(parts, root_idx);
  const auto root = static_cast<std::size_t>(root_idx);
  const Counts shared = count_shared(parts);
  const std::vector<int> parents = grow(shared, root);
  check_all_reached(parts, shared, parents, root);

  std::vector<BodyPart> sorted;
  std::vector<int> new_idx(parts.size(), -1);
  while (sorted.size() < parts.size()) {
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const bool is_next =
          sorted.empty() ? p == root : new_idx[p] < 0 && new_idx[static_cast<std::size_t>(parents[p])] >= 0;
      if (!is_next) continue;
      new_idx[p] = static_cast<int>(sorted.size());
      parts[p].parent = p == root ? -1 : new_idx[static_cast<std::size_t>(parents[p])];
      sorted.push_back(std::move(parts[p]));
      break;
    }
  }
  return sorted;
}

}  // namespace reprise
