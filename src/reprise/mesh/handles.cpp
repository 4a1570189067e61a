// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/handles.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

#include "reprise/mesh/halfedges.h"
#include "reprise/mesh/remesh.h"

namespace reprise {
namespace {

// Loops up to so much longer than the shortest are cut with it.
constexpr double much_the_same = 4.0;

// A closed walk of half-edges without a vertex twice.
using Loop = std::vector<std::int32_t>;

class LoopFinder {
 public:
  LoopFinder(const TriangleMesh& mesh, const Halfedges& edges, std::int32_t root)
      : mesh_(mesh), edges_(edges) {
    grow_tree(root);
    grow_cotree();
  }

  // One loop for each edge in neither tree; together they are a basis of the loops of the surface. Shortest
  // first.
  std::vector<std::pair<double, Loop>> loops() const {
    std::vector<std::pair<double, Loop>> found;
    for (std::int32_t h = 0; h < edges_.halfedge_count(); ++h) {
      const std::int32_t g = edges_.twin(h);
      if (g < h || in_tree(h) || in_cotree_[h]) continue;
      Loop loop = close(h);
      double length = 0.0;
      for (const std::int32_t i : loop)
        length += (mesh_.points[edges_.from(i)] - mesh_.points[edges_.to(i)]).norm();
      found.emplace_back(length, std::move(loop));
    }
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  bool in_tree(std::int32_t h) const {
    return to_parent_[edges_.from(h)] == h || to_parent_[edges_.to(h)] == edges_.twin(h);
  }

  void grow_tree(std::int32_t root) {
    const auto count = static_cast<std::size_t>(edges_.vertex_count());
    std::vector<double> distance(count, std::numeric_limits<double>::infinity());
    to_parent_.assign(count, Halfedges::removed);
    depth_.assign(count, 0);
    using Entry = std::pair<double, std::int32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    distance[root] = 0.0;
    queue.emplace(0.0, root);
    while (!queue.empty()) {
      const auto [d, v] = queue.top();
      queue.pop();
      if (d > distance[v]) continue;
      std::int32_t h = edges_.out(v);
      do {
        const std::int32_t other = edges_.to(h);
        const double length = d + (mesh_.points[v] - mesh_.points[other]).norm();
        if (length < distance[other]) {
          distance[other] = length;
          to_parent_[other] = edges_.twin(h);
          depth_[other] = depth_[v] + 1;
          queue.emplace(length, other);
        }
        h = edges_.rotate(h);
      } while (h != edges_.out(v));
    }
  }

  void grow_cotree() {
    in_cotree_.assign(static_cast<std::size_t>(edges_.halfedge_count()), false);
    std::vector<bool> seen(mesh_.triangles.size(), false);
    std::vector<std::int32_t> queue{0};
    seen[0] = true;
    for (std::size_t i = 0; i < queue.size(); ++i) {
      for (std::int32_t h = 3 * queue[i]; h < 3 * queue[i] + 3; ++h) {
        const std::int32_t g = edges_.twin(h);
        if (seen[g / 3] || in_tree(h)) continue;
        seen[g / 3] = true;
        in_cotree_[h] = in_cotree_[g] = true;
        queue.push_back(g / 3);
      }
    }
  }

  // Along h and back through the tree, without the stretch both ways share.
  Loop close(std::int32_t h) const {
    std::int32_t a = edges_.from(h), b = edges_.to(h);
    Loop forward{h}, backward;
    while (a != b) {
      if (depth_[b] >= depth_[a]) {
        forward.push_back(to_parent_[b]);
        b = edges_.to(to_parent_[b]);
      } else {
        backward.push_back(edges_.twin(to_parent_[a]));
        a = edges_.to(to_parent_[a]);
      }
    }
    forward.insert(forward.end(), backward.rbegin(), backward.rend());
    return forward;
  }

  const TriangleMesh& mesh_;
  const Halfedges& edges_;
  std::vector<std::int32_t> to_parent_;
  std::vector<int> depth_;
  std::vector<bool> in_cotree_;
};

// Parts the surface along the loop: triangles to its right get vertices of their own. Both sides are capped.
void cut(const Loop& loop, const Halfedges& edges, TriangleMesh& mesh) {
  const std::size_t count = loop.size();
  std::vector<std::int32_t> left(count), right(count);
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    left[i] = edges.from(loop[i]);
    right[i] = static_cast<std::int32_t>(mesh.points.size());
    const Eigen::Vector3d point = mesh.points[left[i]];
    mesh.points.push_back(point);
    center += point / static_cast<double>(count);
    // Clockwise from the loop's way out to its way in lies the right side.
    const std::int32_t way_in = edges.twin(loop[(i + count - 1) % count]);
    for (std::int32_t h = loop[i]; h != way_in;) {
      h = edges.rotate(h);
      for (std::int32_t& v : mesh.triangles[h / 3])
        if (v == left[i]) v = right[i];
    }
  }
  const auto left_center = static_cast<std::int32_t>(mesh.points.size());
  mesh.points.push_back(center);
  mesh.points.push_back(center);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t j = (i + 1) % count;
    mesh.triangles.push_back({left[j], left[i], left_center});
    mesh.triangles.push_back({right[i], right[j], left_center + 1});
  }
}

}  // namespace

TriangleMesh without_handles(TriangleMesh mesh) {
  while (true) {
    const Halfedges edges(static_cast<std::int32_t>(mesh.points.size()), mesh.triangles);
    if (genus(mesh) <= 0) return mesh;
    std::vector<std::pair<double, Loop>> loops = LoopFinder(mesh, edges, 0).loops();
    // Every handle has a short loop and, across it, a long one that is not to be cut. A tree that starts
    // elsewhere knows the long ones only as detours: look again from where the shortest passes.
    const std::int32_t root = edges.from(loops.front().second.front());
    auto again = LoopFinder(mesh, edges, root).loops();
    if (again.front().first < loops.front().first) loops = std::move(again);
    const double bound = much_the_same * loops.front().first;
    std::vector<bool> taken(mesh.points.size(), false);
    // Loops of a basis that do not meet can be cut at once: together they separate nothing. A loop that
    // touches a cut one waits for the next round.
    for (const auto& [length, loop] : loops) {
      if (length > bound) break;
      bool free = true;
      for (const std::int32_t h : loop) free = free && !taken[edges.from(h)];
      if (!free) continue;
      for (const std::int32_t h : loop) {
        const std::int32_t v = edges.from(h);
        taken[v] = true;
        std::int32_t i = edges.out(v);
        do {
          taken[edges.to(i)] = true;
          i = edges.rotate(i);
        } while (i != edges.out(v));
      }
      cut(loop, edges, mesh);
    }
  }
}

}  // namespace reprise
