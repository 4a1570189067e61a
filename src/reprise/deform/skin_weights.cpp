// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/skin_weights.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/deform/gradient_field.h"
#include "reprise/mesh/closest_point.h"

namespace reprise {
namespace {

using Eigen::Vector3d;

// Bones as near as the nearest to this share are equally near: a vertex beyond a joint is as far from both of
// its bones.
constexpr double equally_near = 1.0 + 1e-4;
// Shares below this do not move a vertex by what anybody sees.
constexpr double negligible = 1e-4;

struct Segment {
  Vector3d begin, end;

  Vector3d nearest(const Vector3d& point) const {
    const Vector3d along = end - begin;
    const double length2 = along.squaredNorm();
    if (!(length2 > 0.0)) return begin;
    return begin + std::clamp((point - begin).dot(along) / length2, 0.0, 1.0) * along;
  }
};

// The segments of every joint's bone; at least one each.
std::vector<std::vector<Segment>> bones_of(const Markup& markup) {
  const std::vector<Joint>& joints = markup.skeleton.joints;
  std::vector<std::vector<Segment>> bones(joints.size());
  for (const Joint& joint : joints) {
    if (joint.parent < 0) continue;
    const auto parent = static_cast<std::size_t>(joint.parent);
    bones[parent].push_back({joints[parent].rest_position, joint.rest_position});
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (!bones[j].empty()) continue;
    const int parent = joints[j].parent;
    Vector3d end = joints[j].rest_position;
    if (parent >= 0) end += joints[j].rest_position - joints[static_cast<std::size_t>(parent)].rest_position;
    const std::vector<std::int32_t> labelled = markup.vertices_of_joint(static_cast<int>(j));
    if (!labelled.empty()) {
      end.setZero();
      for (const std::int32_t v : labelled) end += markup.reference.row(v).cast<double>().transpose();
      end /= static_cast<double>(labelled.size());
    }
    bones[j].push_back({joints[j].rest_position, end});
  }
  return bones;
}

// What heats a vertex: its own bones, which share alike, and how far they are.
struct Heat {
  std::vector<int> bones;  // none: the vertex only passes heat on
  double distance = 0.0;
};

class HeatSources {
 public:
  HeatSources(const Topology& topology, const Markup& markup)
      : topology_(topology), markup_(markup), bones_(bones_of(markup)), tree_(points(), topology.triangles) {
    const PositionsView reference(markup.reference.data(), markup.reference.rows(), 3);
    normals_ = vertex_normals(topology, reference);
  }

  Heat of_label(std::int32_t v, int joint) const {
    return {.bones = {joint}, .distance = (nearest(joint, point(v)) - point(v)).norm()};
  }

  Heat of_nearest(std::int32_t v, bool must_see) const {
    std::vector<std::pair<double, int>> order;
    for (int j = 0; j < static_cast<int>(bones_.size()); ++j) {
      order.emplace_back((nearest(j, point(v)) - point(v)).norm(), j);
    }
    std::sort(order.begin(), order.end());
    Heat heat;
    for (const auto& [distance, j] : order) {
      if (!heat.bones.empty() && distance > equally_near * heat.distance) break;
      if (must_see && !sees(v, nearest(j, point(v)))) continue;
      if (heat.bones.empty()) heat.distance = distance;
      heat.bones.push_back(j);
    }
    return heat;
  }

 private:
  Vector3d point(std::int32_t v) const { return markup_.reference.row(v).cast<double>().transpose(); }
  std::vector<Vector3d> points() const {
    std::vector<Vector3d> result;
    for (std::int32_t v = 0; v < topology_.vertex_count; ++v) result.push_back(point(v));
    return result;
  }

  Vector3d nearest(int joint, const Vector3d& from) const {
    Vector3d result = Vector3d::Zero();
    double least = std::numeric_limits<double>::infinity();
    for (const Segment& segment : bones_[static_cast<std::size_t>(joint)]) {
      const Vector3d candidate = segment.nearest(from);
      const double distance2 = (candidate - from).squaredNorm();
      if (distance2 < least) {
        least = distance2;
        result = candidate;
      }
    }
    return result;
  }

  // The straight line goes inwards at the vertex and stays inside. A bone may end on the surface.
  bool sees(std::int32_t v, const Vector3d& target) const {
    const Vector3d from = point(v);
    const Vector3d line = target - from;
    if (normals_.row(v).cast<double>().dot(line.transpose()) > 0.0) return false;
    std::vector<RayHit> hits;
    tree_.hits(from, line, 1.0 - 1e-4, hits);
    return std::none_of(hits.begin(), hits.end(), [&](const RayHit& hit) {
      const Triangle& triangle = topology_.triangles[static_cast<std::size_t>(hit.triangle)];
      return std::find(triangle.begin(), triangle.end(), v) == triangle.end();
    });
  }

  const Topology& topology_;
  const Markup& markup_;
  std::vector<std::vector<Segment>> bones_;
  ClosestPointTree tree_;
  Positions normals_;
};

std::vector<Heat> heat_sources(const Topology& topology, const Markup& markup) {
  const HeatSources sources(topology, markup);
  const auto vertex_count = static_cast<std::size_t>(topology.vertex_count);
  std::vector<Heat> heats(vertex_count);
  constexpr std::size_t grain = 64;
  parallel_for(
      0, vertex_count,
      [&](std::size_t v) {
        const int label = markup.joint_of_vertex[v];
        const auto vertex = static_cast<std::int32_t>(v);
        heats[v] = label >= 0 ? sources.of_label(vertex, label) : sources.of_nearest(vertex, true);
      },
      grain);
  const ConnectedComponents components = connected_components(topology);
  std::vector<bool> is_heated(static_cast<std::size_t>(components.count), false);
  for (std::size_t v = 0; v < vertex_count; ++v) {
    if (!heats[v].bones.empty()) is_heated[static_cast<std::size_t>(components.of_vertex[v])] = true;
  }
  for (std::size_t v = 0; v < vertex_count; ++v) {
    if (is_heated[static_cast<std::size_t>(components.of_vertex[v])]) continue;
    heats[v] = sources.of_nearest(static_cast<std::int32_t>(v), false);
  }
  return heats;
}

// The Laplacian with every edge conducting at least a little, also across from obtuse angles and slivers,
// where its entries have the wrong sign; rows sum to zero as before. Then no vertex is colder than 0 or
// hotter than 1, and heat reaches all of a connected component.
Eigen::SparseMatrix<double> conduction(const PoissonReconstruction& poisson) {
  constexpr double least = 1e-3;  // an edge between two equilateral triangles: 0.58
  Eigen::SparseMatrix<double> L = poisson.laplacian();
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(L.rows());
  for (Eigen::Index k = 0; k < L.outerSize(); ++k) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(L, k); it; ++it) {
      if (it.row() == it.col()) continue;
      it.valueRef() = std::min(it.value(), -least);
      diagonal[it.row()] -= it.value();
    }
  }
  for (Eigen::Index k = 0; k < L.rows(); ++k) L.coeffRef(k, k) = diagonal[k];
  return L;
}

// Areas of the vertices, m^2; at least a millionth of the mean.
Eigen::VectorXd vertex_areas(const Topology& topology, const Positions& positions) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(topology.vertex_count);
  for (const Triangle& triangle : topology.triangles) {
    const auto corner = [&](std::size_t k) -> Vector3d {
      return positions.row(triangle[k]).cast<double>().transpose();
    };
    const double area = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
    for (const std::int32_t v : triangle) areas[v] += area / 3.0;
  }
  const double mean = areas.mean();
  return areas.cwiseMax(mean > 0.0 ? 1e-6 * mean : 1.0);
}

// The largest shares of a vertex, less the largest that is dropped, with sum 1.
void append_shares(const Eigen::VectorXd& shares, int most_bones, Eigen::Index vertex,
                   std::vector<Eigen::Triplet<double>>& entries) {
  double dropped = negligible;
  if (most_bones > 0 && most_bones < shares.size()) {
    std::vector<double> sorted(shares.begin(), shares.end());
    std::nth_element(sorted.begin(), sorted.begin() + most_bones, sorted.end(), std::greater<>());
    dropped = std::max(dropped, sorted[static_cast<std::size_t>(most_bones)]);
  }
  double sum = (shares.array() - dropped).cwiseMax(0.0).sum();
  if (!(sum > 0.0)) {
    // More bones than allowed have one and the same share: the first of them have to do.
    const int count = most_bones > 0 ? most_bones : static_cast<int>(shares.size());
    for (int j = 0, kept = 0; j < shares.size() && kept < count; ++j) {
      if (shares[j] < dropped) continue;
      entries.emplace_back(vertex, j, 1.0 / count);
      ++kept;
    }
    return;
  }
  for (int j = 0; j < shares.size(); ++j) {
    if (shares[j] > dropped) entries.emplace_back(vertex, j, (shares[j] - dropped) / sum);
  }
}

void check(const SkinWeightOptions& options) {
  if (!(options.heat > 0.0) || !std::isfinite(options.heat)) {
    throw InvalidArgument(
        fmt::format("skin weights: expected a heat that is positive and finite, found {}", options.heat));
  }
  if (options.most_bones < 0) {
    throw InvalidArgument(
        fmt::format("skin weights: expected most_bones of 0 or more, found {}", options.most_bones));
  }
}

}  // namespace

SkinWeights skin_weights(const TopologyPtr& topology, const Markup& markup,
                         const SkinWeightOptions& options) {
  check(options);
  if (topology == nullptr) throw InvalidArgument("skin weights need a topology, found none");
  validate(markup, topology->vertex_count);
  if (markup.skeleton.joints.empty()) throw InvalidArgument("skin weights need a skeleton with joints");

  const PositionsView reference(markup.reference.data(), markup.reference.rows(), 3);
  Eigen::SparseMatrix<double> A = conduction(PoissonReconstruction(topology, reference));
  const Eigen::VectorXd areas = vertex_areas(*topology, markup.reference);
  // No bone is nearer than a fraction of an edge: a bone that runs through the surface would freeze it.
  const double nearest = 0.5 * std::sqrt(areas.mean());

  const std::vector<Heat> heats = heat_sources(*topology, markup);
  Eigen::MatrixXd shares = Eigen::MatrixXd::Zero(topology->vertex_count, markup.skeleton.size());
  for (Eigen::Index v = 0; v < shares.rows(); ++v) {
    const Heat& heat = heats[static_cast<std::size_t>(v)];
    if (heat.bones.empty()) continue;
    const double d = std::max(heat.distance, nearest);
    const double strength = areas[v] * options.heat / (d * d);
    A.coeffRef(v, v) += strength;
    for (const int j : heat.bones) shares(v, j) = strength / static_cast<double>(heat.bones.size());
  }
  shares = SparseCholesky(A).solve(shares);

  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index v = 0; v < shares.rows(); ++v) {
    append_shares(shares.row(v).transpose(), options.most_bones, v, entries);
  }
  SkinWeights weights(shares.rows(), shares.cols());
  weights.setFromTriplets(entries.begin(), entries.end());
  weights.makeCompressed();
  return weights;
}

void validate(const SkinWeights& weights, std::int32_t vertex_count, int joint_count) {
  if (weights.rows() != vertex_count || weights.cols() != joint_count) {
    throw InvalidArgument(fmt::format("skin weights are {} x {}; expected {} vertices x {} joints",
                                      weights.rows(), weights.cols(), vertex_count, joint_count));
  }
  for (Eigen::Index v = 0; v < weights.rows(); ++v) {
    double sum = 0.0;
    for (SkinWeights::InnerIterator it(weights, v); it; ++it) {
      if (!(it.value() >= 0.0)) {
        throw InvalidArgument(fmt::format("skin weight of vertex {} for joint {} is {}; expected 0 or more",
                                          v, it.col(), it.value()));
      }
      sum += it.value();
    }
    if (!(std::abs(sum - 1.0) <= 1e-6)) {
      throw InvalidArgument(fmt::format("skin weights of vertex {} sum to {}; expected 1", v, sum));
    }
  }
}

}  // namespace reprise
