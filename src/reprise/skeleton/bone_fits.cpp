// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/skeleton/bone_fits.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"

namespace reprise::skeleton {
namespace {

// A third of the area of the triangles around each vertex: densely meshed hands and faces count no more than
// their surface.
std::vector<double> vertex_areas(const Topology& topology, const PositionsView& positions) {
  std::vector<double> areas(static_cast<std::size_t>(topology.vertex_count), 0.0);
  for (const Triangle& triangle : topology.triangles) {
    const Eigen::Vector3d a = positions.row(triangle[0]).transpose().cast<double>();
    const Eigen::Vector3d b = positions.row(triangle[1]).transpose().cast<double>();
    const Eigen::Vector3d c = positions.row(triangle[2]).transpose().cast<double>();
    const double area = (b - a).cross(c - a).norm() / 6.0;
    for (const std::int32_t v : triangle) areas[static_cast<std::size_t>(v)] += area;
  }
  return areas;
}

Eigen::Vector3d mean(const Points& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

// The joint lies in its own bone and at the end of its parent's: where each carries it, weighted by how well
// each knows. `parent` may be null.
Eigen::Vector3d joint_position(const Eigen::Vector3d& rest_position, const RigidFit& own,
                               const RigidFit* parent) {
  if (parent == nullptr) return own.carry(rest_position);
  constexpr double least_variance = 1e-16;  // m^2: exact fits count alike
  const double own_variance = own.variance_at(rest_position) + least_variance;
  const double parent_variance = parent->variance_at(rest_position) + least_variance;
  const double own_weight = parent_variance / (own_variance + parent_variance);
  return own_weight * own.carry(rest_position) + (1.0 - own_weight) * parent->carry(rest_position);
}

std::vector<bool> followed(const std::vector<LabelledBone>& bones) {
  std::vector<bool> result;
  for (const LabelledBone& bone : bones) result.push_back(bone.is_followed);
  return result;
}

}  // namespace

Points gather(const PositionsView& positions, const std::vector<std::int32_t>& vertices) {
  Points points;
  points.reserve(vertices.size());
  for (const std::int32_t v : vertices) points.emplace_back(positions.row(v).transpose().cast<double>());
  return points;
}

std::vector<LabelledBone> label_bones(const Topology& topology, const Markup& markup, int fewest_vertices) {
  const PositionsView reference(markup.reference.data(), markup.reference.rows(), 3);
  const std::vector<double> areas = vertex_areas(topology, reference);
  std::vector<LabelledBone> bones(markup.skeleton.joints.size());
  for (std::size_t v = 0; v < markup.joint_of_vertex.size(); ++v) {
    const std::int32_t joint = markup.joint_of_vertex[v];
    if (joint >= 0) bones[static_cast<std::size_t>(joint)].vertices.push_back(static_cast<std::int32_t>(v));
  }
  for (LabelledBone& bone : bones) {
    bone.rest = gather(reference, bone.vertices);
    for (const std::int32_t v : bone.vertices) bone.weights.push_back(areas[static_cast<std::size_t>(v)]);
    bone.is_followed = bone.vertices.size() >= static_cast<std::size_t>(fewest_vertices) &&
                       fixes_rotation(bone.rest, bone.weights);
  }
  return bones;
}

void check_followed(const Skeleton& skeleton, const std::vector<LabelledBone>& bones, int fewest_vertices) {
  if (std::ranges::any_of(bones, &LabelledBone::is_followed)) return;
  std::vector<std::string> counts;
  for (std::size_t j = 0; j < bones.size(); ++j) {
    counts.push_back(fmt::format("{} {}", skeleton.joints[j].name, bones[j].vertices.size()));
  }
  throw InvalidArgument(fmt::format(
      "no bone can be followed: each needs {} labelled vertices that do not lie on a line; found {}",
      fewest_vertices, fmt::join(counts, ", ")));
}

void check_input(const MeshSequence& clip, const Markup& markup, const SkeletonExtractionOptions& options) {
  if (options.fewest_vertices < 3) {
    throw InvalidArgument(fmt::format(
        "fewest_vertices: expected 3 or more, for fewer fix no rotation; found {}", options.fewest_vertices));
  }
  if (!clip.topology()) throw InvalidArgument("the clip has no topology");
  try {
    validate(markup, static_cast<std::int32_t>(clip.vertex_count()));
  } catch (const InvalidArgument& error) {
    throw InvalidArgument(fmt::format("the markup does not fit clip '{}': {}", clip.name(), error.what()));
  }
}

std::vector<double> steady_weights(const LabelledBone& bone, const std::vector<double>& residuals) {
  std::vector<double> sorted = residuals;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  std::vector<double> weights = bone.weights;
  if (*middle > 0.0) {
    for (std::size_t i = 0; i < weights.size(); ++i) weights[i] *= *middle / (*middle + residuals[i]);
  }
  return weights;
}

void add_residuals(const LabelledBone& bone, const Points& points, const RigidFit& fit,
                   std::vector<double>& residuals) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    residuals[i] += (points[i] - fit.carry(bone.rest[i])).squaredNorm();
  }
}

PoseFromFits::PoseFromFits(const Skeleton& skeleton, const std::vector<LabelledBone>& bones)
    : skeleton_(skeleton), inference_(skeleton, followed(bones)) {}

SkeletonPose PoseFromFits::operator()(std::span<const RigidFit* const> fits) const {
  std::vector<std::optional<KnownBone>> known(fits.size());
  for (std::size_t j = 0; j < fits.size(); ++j) {
    if (fits[j] == nullptr) continue;
    const Joint& joint = skeleton_.joints[j];
    const RigidFit* parent = joint.parent < 0 ? nullptr : fits[static_cast<std::size_t>(joint.parent)];
    known[j] = {.rotation = Eigen::Quaterniond(fits[j]->rotation).normalized(),
                .position = joint_position(joint.rest_position, *fits[j], parent)};
  }
  return inference_.infer(known);
}

void put_joints_at_centroids(const std::vector<LabelledBone>& bones, Skeleton& skeleton) {
  for (std::size_t j = 0; j < bones.size(); ++j) {
    if (!bones[j].vertices.empty()) skeleton.joints[j].rest_position = mean(bones[j].rest);
  }
}

void put_joints_at_centroids(const std::vector<LabelledBone>& bones, const PositionsView& frame,
                             SkeletonPose& pose) {
  for (std::size_t j = 0; j < bones.size(); ++j) {
    if (!bones[j].vertices.empty()) pose.position[j] = mean(gather(frame, bones[j].vertices));
  }
}

}  // namespace reprise::skeleton
