// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The surface as a tree of overlapping parts that are edited on their own and put together again (LPBM IV.B).

#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "reprise/database/markup.h"
#include "reprise/mesh/mesh.h"

namespace reprise {

// N x 3, metres, one vertex a row: what solves compute with.
using Coordinates = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

struct PartDistances;

struct PartHierarchyOptions {
  double takeover = 0.16;  // metres from its border over which a part takes over from a parent all around it
};

// Immutable; solver, file and session share one.
//
// Distances are geodesic (`EdgeGraph`) on the reference. With D_p(v) the distance from vertex v to the
// nearest vertex outside of part p, the weight of p at v is D_p(v) / sum_q D_q(v) over the parts that hold v:
// a partition of unity, continuous everywhere, 1 where one part alone holds v, and the linear interpolation
// of LPBM IV.B where two parts meet. Where a part has no border, D_p is infinite and it takes all (several
// such parts: equal shares).
//
// A parent that holds a child whole (a whole-body root with limbs below it) would never end there. It ends
// where the child has taken over: farther than `takeover` from the border of the child and all below it, or
// half way to its innermost vertex if that is nearer. That interior counts as outside of the parent. Children
// that overlap do so together: no border of one that lies inside of another.
class PartHierarchy {
 public:
  // I_jp: a vertex that a part shares with its parent.
  struct FrontierVertex {
    std::int32_t vertex = 0;        // of the whole surface
    std::int32_t local = 0;         // of the part
    std::int32_t parent_local = 0;  // of the parent
    // In [0, 1], for the weight of an anchor: 1 at the border of the child and all below it, falling
    // linearly to 0 where the parent ends (as above). 1 everywhere if the child has no border.
    double parent_share = 0.0;
  };

  // A connected component that nothing holds: in a child, one without `parent_share`; in the root, any but
  // the one with most vertices. A solver holds it by its place relative to `carrier`.
  struct LooseComponent {
    std::vector<std::int32_t> vertices;  // local, ascending
    std::int32_t carrier = 0;            // local: the nearest vertex on the reference that is not loose
  };

  struct Part {
    std::string name;
    int parent = -1;  // -1: the root
    std::vector<int> children;
    int level = 0;                       // 0: the root
    std::vector<std::int32_t> vertices;  // ascending: of the whole surface by local index
    TopologyPtr topology;                // the triangles with all corners in the part, in local indices
    std::vector<FrontierVertex> frontier;
    std::vector<LooseComponent> loose;

    // Index into `vertices`; -1 if the part does not hold it.
    std::int32_t local(std::int32_t vertex) const;
  };

  // A part's say in the place of a vertex; only positive weights are kept.
  struct Share {
    int part_idx = 0;
    std::int32_t local = 0;
    double weight = 0.0;
  };

  // `parts`: one tree, root first, parents before children. `reference`: N x 3, any frame of the performer.
  // Vertices of a part that are corners of none of its triangles are left out of it. Surfaces may be open,
  // disconnected and non-manifold. Throws `InvalidArgument` that names the parts: no part; what `validate`
  // finds wrong with parts (indices, names, order); a vertex in no part; a triangle inside of no part; a part
  // without triangles; one that shares no vertex with its parent, or none but vertices in one line; a
  // reference that does not fit or is not finite.
  PartHierarchy(TopologyPtr topology, const PositionsView& reference, const std::vector<BodyPart>& parts,
                const PartHierarchyOptions& options = {});

  const TopologyPtr& topology() const { return topology_; }
  std::int32_t vertex_count() const { return topology_->vertex_count; }

  // Parents before children: solve them in this order.
  const std::vector<Part>& parts() const { return parts_; }
  const Part& part(int part_idx) const { return parts_.at(static_cast<std::size_t>(part_idx)); }
  // Throws `InvalidArgument` that offers the nearest name and lists what is there.
  int part_idx(std::string_view name) const;
  // The parts by level; those of one level depend only on levels before.
  std::vector<std::vector<int>> levels() const;
  // All parts below, ascending.
  std::vector<int> descendants(int part_idx) const;

  // At least one; part indices ascend, weights add up to 1.
  std::span<const Share> shares(std::int32_t vertex) const;
  // The part with the largest weight there, the lower of equals.
  int main_part(std::int32_t vertex) const;

  // `part_positions`: one matrix a part, a row for each of its vertices. `out`: resized to N x 3. Where all
  // parts that hold a vertex agree, their common position comes back unchanged to the last bit. Throws
  // `InvalidArgument` if a shape does not fit.
  void recombine(std::span<const Coordinates> part_positions, Coordinates& out) const;
  // The same for some vertices only; the other rows of `out` (N x 3) stay.
  void recombine(std::span<const Coordinates> part_positions, std::span<const std::int32_t> vertices,
                 Coordinates& out) const;

 private:
  void make_shares(const std::vector<PartDistances>& distances);
  void check_shapes(std::span<const Coordinates> part_positions) const;
  void recombine_vertex(std::span<const Coordinates> part_positions, std::int32_t vertex,
                        Coordinates& out) const;

  TopologyPtr topology_;
  std::vector<Part> parts_;
  std::vector<Share> shares_;             // vertex by vertex
  std::vector<std::size_t> first_share_;  // of each vertex; one more entry than vertices
};

}  // namespace reprise
