// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/halfedges.h"

#include <algorithm>
#include <tuple>

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {

Halfedges::Halfedges(std::int32_t vertex_count, const std::vector<Triangle>& triangles)
    : from_(3 * triangles.size()), twin_(3 * triangles.size(), removed), out_(vertex_count, removed) {
  struct Edge {
    std::int32_t low, high, halfedge;
  };
  std::vector<Edge> edges(from_.size());
  std::vector<std::int32_t> uses(vertex_count, 0);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto h = static_cast<std::int32_t>(3 * t) + k;
      const std::int32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      if (a < 0 || a >= vertex_count || a == b) {
        throw InvalidArgument(
            fmt::format("triangle {}: expected three different indices below {}", t, vertex_count));
      }
      from_[h] = a;
      out_[a] = h;
      ++uses[a];
      edges[h] = {std::min(a, b), std::max(a, b), h};
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.halfedge) < std::tie(b.low, b.high, b.halfedge);
  });
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
    if (end - i != 2 || from_[edges[i].halfedge] == from_[edges[i + 1].halfedge]) {
      throw InvalidArgument(fmt::format(
          "edge {}-{}: expected two triangles that run through it in opposite directions, found {}",
          edges[i].low, edges[i].high, end - i));
    }
    glue(edges[i].halfedge, edges[i + 1].halfedge);
    i = end;
  }
  for (std::int32_t v = 0; v < vertex_count; ++v) {
    if (out_[v] == removed) continue;
    ++live_vertices_;
    if (valence(v) != uses[v]) {
      throw InvalidArgument(fmt::format("vertex {}: expected one fan of triangles around it, found more", v));
    }
  }
}

int Halfedges::valence(std::int32_t v) const {
  int count = 0;
  std::int32_t h = out_[v];
  do {
    ++count;
    h = rotate(h);
  } while (h != out_[v]);
  return count;
}

bool Halfedges::adjacent(std::int32_t a, std::int32_t b) const {
  std::int32_t h = out_[a];
  do {
    if (to(h) == b) return true;
    h = rotate(h);
  } while (h != out_[a]);
  return false;
}

std::int32_t Halfedges::split(std::int32_t h) {
  const std::int32_t g = twin_[h];
  const std::int32_t a = from_[h], b = from_[g], c = apex(h), d = apex(g);
  const std::int32_t bc = twin_[next(h)], ad = twin_[next(g)];
  const auto m = vertex_count();
  out_.push_back(h);
  ++live_vertices_;
  // (a b c) becomes (a m c) in place and (m b c) new, (b a d) becomes (b m d) and (m a d).
  const auto p = halfedge_count();
  const auto q = p + 3;
  from_.insert(from_.end(), {m, b, c, m, a, d});
  twin_.insert(twin_.end(), 6, removed);
  from_[next(h)] = m;
  from_[next(g)] = m;
  glue(h, q);
  glue(g, p);
  glue(p + 1, bc);
  glue(p + 2, next(h));
  glue(q + 1, ad);
  glue(q + 2, next(g));
  out_[m] = p;
  out_[a] = h;
  out_[b] = g;
  out_[c] = p + 2;
  out_[d] = q + 2;
  return m;
}

bool Halfedges::can_collapse(std::int32_t h) const {
  const std::int32_t g = twin_[h];
  const std::int32_t a = from_[h], b = from_[g], c = apex(h), d = apex(g);
  if (c == d || valence(c) <= 3 || valence(d) <= 3) return false;
  // Link condition: no other common neighbour.
  std::int32_t i = out_[a];
  do {
    const std::int32_t v = to(i);
    if (v != b && v != c && v != d && adjacent(v, b)) return false;
    i = rotate(i);
  } while (i != out_[a]);
  return true;
}

void Halfedges::collapse(std::int32_t h) {
  const std::int32_t g = twin_[h];
  const std::int32_t a = from_[h], b = from_[g], c = apex(h), d = apex(g);
  for (std::int32_t i = rotate(h); i != h; i = rotate(i)) from_[i] = b;
  const std::int32_t bc = twin_[next(h)], ca = twin_[prev(h)];
  const std::int32_t ad = twin_[next(g)], db = twin_[prev(g)];
  glue(bc, ca);
  glue(ad, db);
  out_[a] = removed;
  out_[b] = ca;  // ca runs from a, now b, to c
  out_[c] = bc;
  out_[d] = ad;
  for (const std::int32_t i : {h, next(h), prev(h), g, next(g), prev(g)}) from_[i] = removed;
  --live_vertices_;
}

bool Halfedges::can_flip(std::int32_t h) const {
  const std::int32_t g = twin_[h];
  const std::int32_t c = apex(h), d = apex(g);
  return c != d && valence(from_[h]) > 3 && valence(from_[g]) > 3 && !adjacent(c, d);
}

void Halfedges::flip(std::int32_t h) {
  const std::int32_t g = twin_[h];
  const std::int32_t a = from_[h], b = from_[g], c = apex(h), d = apex(g);
  const std::int32_t bc = twin_[next(h)], ca = twin_[prev(h)];
  const std::int32_t ad = twin_[next(g)], db = twin_[prev(g)];
  // (a b c), (b a d) become (d c a), (c d b).
  const std::int32_t h1 = next(h), h2 = prev(h), g1 = next(g), g2 = prev(g);
  from_[h] = d;
  from_[h1] = c;
  from_[h2] = a;
  from_[g] = c;
  from_[g1] = d;
  from_[g2] = b;
  glue(h1, ca);
  glue(h2, ad);
  glue(g1, db);
  glue(g2, bc);
  out_[a] = h2;
  out_[b] = g2;
  out_[c] = h1;
  out_[d] = g1;
}

std::vector<Triangle> Halfedges::triangles() const {
  std::vector<Triangle> result;
  for (std::int32_t h = 0; h < halfedge_count(); h += 3) {
    if (!is_removed(h)) result.push_back({from_[h], from_[h + 1], from_[h + 2]});
  }
  return result;
}

}  // namespace reprise
