// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/skeleton/skeleton_extraction.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Cholesky>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/skeleton/pose_inference.h"
#include "reprise/skeleton/rigid_fit.h"

namespace reprise {
namespace {

using skeleton::fit_rigid_robustly;
using skeleton::KnownBone;
using skeleton::PoseInference;
using skeleton::RigidFit;

using Points = std::vector<Eigen::Vector3d>;

Points gather(const PositionsView& positions, const std::vector<std::int32_t>& vertices) {
  Points points;
  points.reserve(vertices.size());
  for (const std::int32_t v : vertices) points.emplace_back(positions.row(v).transpose().cast<double>());
  return points;
}

// The labelled vertices of one bone and how it moves through the clip.
struct Bone {
  std::vector<std::int32_t> vertices;
  Points rest;
  std::vector<double> weights;
  bool is_known = false;
  std::vector<RigidFit> fits;  // one a frame, if known
};

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

std::vector<Bone> make_bones(const Topology& topology, const Markup& markup, int fewest_vertices) {
  const PositionsView reference(markup.reference.data(), markup.reference.rows(), 3);
  const std::vector<double> areas = vertex_areas(topology, reference);
  std::vector<Bone> bones(markup.skeleton.joints.size());
  for (std::size_t v = 0; v < markup.joint_of_vertex.size(); ++v) {
    const std::int32_t joint = markup.joint_of_vertex[v];
    if (joint >= 0) bones[static_cast<std::size_t>(joint)].vertices.push_back(static_cast<std::int32_t>(v));
  }
  for (Bone& bone : bones) {
    bone.rest = gather(reference, bone.vertices);
    for (const std::int32_t v : bone.vertices) bone.weights.push_back(areas[static_cast<std::size_t>(v)]);
    bone.is_known = bone.vertices.size() >= static_cast<std::size_t>(fewest_vertices) &&
                    skeleton::fixes_rotation(bone.rest, bone.weights);
  }
  return bones;
}

// Vertices that hold their place in the bone throughout the clip say more than those that slide over it: a
// second pass weights each by its mean squared residual of the first.
void fit_bone(const MeshSequence& clip, Bone& bone) {
  const std::size_t n = bone.vertices.size();
  bone.fits.resize(clip.frame_count());
  std::vector<double> residual(n, 0.0);
  for (std::size_t f = 0; f < clip.frame_count(); ++f) {
    const Points points = gather(clip.frame(f), bone.vertices);
    const RigidFit fit = fit_rigid_robustly(bone.rest, points, bone.weights);
    for (std::size_t i = 0; i < n; ++i) residual[i] += (points[i] - fit.carry(bone.rest[i])).squaredNorm();
  }
  std::vector<double> sorted = residual;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(n / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  std::vector<double> weights = bone.weights;
  if (*middle > 0.0) {
    for (std::size_t i = 0; i < n; ++i) weights[i] *= *middle / (*middle + residual[i]);
  }
  for (std::size_t f = 0; f < clip.frame_count(); ++f) {
    bone.fits[f] = fit_rigid_robustly(bone.rest, gather(clip.frame(f), bone.vertices), weights);
  }
}

Eigen::Vector3d mean(const Points& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

// The joint lies in its own bone and at the end of its parent's: where each carries it, weighted by how well
// each knows.
Eigen::Vector3d joint_position(const Skeleton& skeleton, const std::vector<Bone>& bones, std::size_t j,
                               std::size_t frame_idx) {
  const Joint& joint = skeleton.joints[j];
  const RigidFit& own = bones[j].fits[frame_idx];
  const Eigen::Vector3d by_own = own.carry(joint.rest_position);
  if (joint.parent < 0 || !bones[static_cast<std::size_t>(joint.parent)].is_known) return by_own;
  const RigidFit& parent = bones[static_cast<std::size_t>(joint.parent)].fits[frame_idx];
  constexpr double least_variance = 1e-16;  // m^2: exact fits count alike
  const double own_variance = own.variance_at(joint.rest_position) + least_variance;
  const double parent_variance = parent.variance_at(joint.rest_position) + least_variance;
  const double own_weight = parent_variance / (own_variance + parent_variance);
  return own_weight * by_own + (1.0 - own_weight) * parent.carry(joint.rest_position);
}

void check_known(const Skeleton& skeleton, const std::vector<Bone>& bones, int fewest_vertices) {
  if (std::ranges::any_of(bones, &Bone::is_known)) return;
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

std::vector<Bone> fit_bones(const MeshSequence& clip, const Markup& markup,
                            const SkeletonExtractionOptions& options) {
  std::vector<Bone> bones = make_bones(*clip.topology(), markup, options.fewest_vertices);
  check_known(markup.skeleton, bones, options.fewest_vertices);
  parallel_for(0, bones.size(), [&](std::size_t j) {
    if (bones[j].is_known) fit_bone(clip, bones[j]);
  });
  return bones;
}

}  // namespace

SkeletalMotion extract_skeleton(const MeshSequence& clip, const Markup& markup,
                                const SkeletonExtractionOptions& options) {
  check_input(clip, markup, options);
  const Skeleton& skeleton = markup.skeleton;
  const std::vector<Bone> bones = fit_bones(clip, markup, options);

  SkeletalMotion motion{.name = clip.name(),
                        .skeleton = skeleton,
                        .frames_per_second = clip.frames_per_second(),
                        .frames = std::vector<SkeletonPose>(clip.frame_count())};
  std::vector<bool> is_known;
  for (const Bone& bone : bones) is_known.push_back(bone.is_known);
  const PoseInference inference(skeleton, is_known);
  parallel_for(0, clip.frame_count(), [&](std::size_t f) {
    std::vector<std::optional<KnownBone>> known(bones.size());
    for (std::size_t j = 0; j < bones.size(); ++j) {
      if (!bones[j].is_known) continue;
      known[j] = {.rotation = Eigen::Quaterniond(bones[j].fits[f].rotation).normalized(),
                  .position = joint_position(skeleton, bones, j, f)};
    }
    motion.frames[f] = inference.infer(known);
  });

  if (options.position == SkeletonExtractionOptions::JointPosition::centroid) {
    // HSSMG 3: the centre of mass of each labelled vertex set.
    for (std::size_t j = 0; j < bones.size(); ++j) {
      if (bones[j].vertices.empty()) continue;
      motion.skeleton.joints[j].rest_position = mean(bones[j].rest);
      for (std::size_t f = 0; f < clip.frame_count(); ++f) {
        motion.frames[f].position[j] = mean(gather(clip.frame(f), bones[j].vertices));
      }
    }
  }
  return motion;
}

std::vector<bool> followed_bones(const Topology& topology, const Markup& markup,
                                 const SkeletonExtractionOptions& options) {
  validate(markup, topology.vertex_count);
  std::vector<bool> followed;
  for (const Bone& bone : make_bones(topology, markup, options.fewest_vertices))
    followed.push_back(bone.is_known);
  return followed;
}

Skeleton refine_joints(const std::vector<MeshSequence>& clips, const Markup& markup,
                       const SkeletonExtractionOptions& options) {
  constexpr double farthest = 0.05;   // metres
  constexpr double stiffness = 0.02;  // of the old place, beside the squared turning of the bones (radians)
  const std::size_t joints = markup.skeleton.joints.size();
  // Normal equations of (R_parent - R_own) c = t_own - t_parent over all frames, about the old place.
  std::vector<Eigen::Matrix3d> A(joints, Eigen::Matrix3d::Zero());
  std::vector<Eigen::Vector3d> b(joints, Eigen::Vector3d::Zero());
  std::size_t frames = 0;
  for (const MeshSequence& clip : clips) {
    check_input(clip, markup, options);
    const std::vector<Bone> bones = fit_bones(clip, markup, options);
    frames += clip.frame_count();
    for (std::size_t j = 0; j < joints; ++j) {
      const Joint& joint = markup.skeleton.joints[j];
      if (joint.parent < 0 || !bones[j].is_known) continue;
      const Bone& parent = bones[static_cast<std::size_t>(joint.parent)];
      if (!parent.is_known) continue;
      for (std::size_t f = 0; f < clip.frame_count(); ++f) {
        const Eigen::Matrix3d turning = parent.fits[f].rotation - bones[j].fits[f].rotation;
        A[j] += turning.transpose() * turning;
        b[j] += turning.transpose() *
                (bones[j].fits[f].carry(joint.rest_position) - parent.fits[f].carry(joint.rest_position));
      }
    }
  }
  Skeleton refined = markup.skeleton;
  for (std::size_t j = 0; j < joints; ++j) {
    const Eigen::Matrix3d regularised = A[j] + stiffness *
                                                   static_cast<double>(std::max<std::size_t>(frames, 1)) *
                                                   Eigen::Matrix3d::Identity();
    Eigen::Vector3d step = regularised.ldlt().solve(b[j]);
    if (step.norm() > farthest) step *= farthest / step.norm();
    refined.joints[j].rest_position += step;
  }
  return refined;
}

PoseDifference pose_difference(const SkeletalMotion& motion, const std::vector<SkeletonPose>& truth) {
  if (motion.frames.size() != truth.size()) {
    throw InvalidArgument(
        fmt::format("{} frames cannot be compared with {} true ones", motion.frames.size(), truth.size()));
  }
  if (truth.empty()) throw InvalidArgument("there is no frame to compare");
  const std::size_t joints = motion.skeleton.joints.size();
  PoseDifference difference{.mean_distance = std::vector(joints, 0.0),
                            .max_distance = std::vector(joints, 0.0),
                            .mean_angle = std::vector(joints, 0.0),
                            .max_angle = std::vector(joints, 0.0)};
  for (std::size_t f = 0; f < truth.size(); ++f) {
    const SkeletonPose& found = motion.frames[f];
    if (truth[f].position.size() != joints || truth[f].rotation.size() != joints) {
      throw InvalidArgument(fmt::format("frame {} of the truth has {} joints; expected {}", f,
                                        truth[f].position.size(), joints));
    }
    for (std::size_t j = 0; j < joints; ++j) {
      const double distance = (found.position[j] - truth[f].position[j]).norm();
      const double angle = found.rotation[j].angularDistance(truth[f].rotation[j]);
      difference.mean_distance[j] += distance;
      difference.mean_angle[j] += angle;
      difference.max_distance[j] = std::max(difference.max_distance[j], distance);
      difference.max_angle[j] = std::max(difference.max_angle[j], angle);
    }
  }
  for (std::size_t j = 0; j < joints; ++j) {
    difference.mean_distance[j] /= static_cast<double>(truth.size());
    difference.mean_angle[j] /= static_cast<double>(truth.size());
    difference.distance += difference.mean_distance[j] / static_cast<double>(joints);
    difference.angle += difference.mean_angle[j] / static_cast<double>(joints);
  }
  return difference;
}

}  // namespace reprise
