// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Half-edges of a closed triangle mesh that can be edited: split, collapse, flip.

#pragma once

#include <cstdint>
#include <vector>

#include "reprise/mesh/topology.h"

namespace reprise {

// Half-edge 3 t + k runs from corner k of triangle t to the next corner. Edits keep the mesh closed, oriented
// and manifold; what they remove is marked and stays in place.
class Halfedges {
 public:
  static constexpr std::int32_t removed = -1;

  // Throws `InvalidArgument` naming the edge if the triangles are not closed, consistently oriented and
  // manifold (one fan of triangles around every vertex; a vertex may be unused).
  Halfedges(std::int32_t vertex_count, const std::vector<Triangle>& triangles);

  static std::int32_t next(std::int32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::int32_t prev(std::int32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  std::int32_t twin(std::int32_t h) const { return twin_[h]; }
  std::int32_t from(std::int32_t h) const { return from_[h]; }
  std::int32_t to(std::int32_t h) const { return from_[next(h)]; }
  std::int32_t apex(std::int32_t h) const { return from_[prev(h)]; }
  // The next half-edge that leaves the same vertex, clockwise.
  std::int32_t rotate(std::int32_t h) const { return next(twin_[h]); }
  // Some half-edge that leaves the vertex, or `removed`.
  std::int32_t out(std::int32_t v) const { return out_[v]; }

  std::int32_t halfedge_count() const { return static_cast<std::int32_t>(from_.size()); }
  std::int32_t vertex_count() const { return static_cast<std::int32_t>(out_.size()); }
  std::int32_t live_vertices() const { return live_vertices_; }
  bool is_removed(std::int32_t h) const { return from_[h] == removed; }
  int valence(std::int32_t v) const;
  bool adjacent(std::int32_t a, std::int32_t b) const;

  // Puts a new vertex on the edge; gives its index. No condition.
  std::int32_t split(std::int32_t h);
  // May from(h) be moved into to(h) and stay manifold?
  bool can_collapse(std::int32_t h) const;
  // Removes from(h), two triangles and three edges. Only if `can_collapse`.
  void collapse(std::int32_t h);
  // Will the edge between the two opposite corners be a new one, and no vertex fall below three edges?
  bool can_flip(std::int32_t h) const;
  void flip(std::int32_t h);

  // What is left, with old vertex indices.
  std::vector<Triangle> triangles() const;

 private:
  void glue(std::int32_t a, std::int32_t b) {
    twin_[a] = b;
    twin_[b] = a;
  }

  std::vector<std::int32_t> from_;
  std::vector<std::int32_t> twin_;
  std::vector<std::int32_t> out_;
  std::int32_t live_vertices_ = 0;
};

}  // namespace reprise
