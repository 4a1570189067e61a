// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/performance_truth.h"

#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/similarity/vertex_metric.h"

namespace reprise {
namespace {

DissimilarityMatrix joint_distances(const PerformanceDatabase& database,
                                    const std::vector<const SkeletonPose*>& poses) {
  std::vector<Positions> joints;
  for (const SkeletonPose* pose : poses) {
    Positions& rows = joints.emplace_back(static_cast<Eigen::Index>(pose->position.size()), 3);
    for (std::size_t j = 0; j < pose->position.size(); ++j)
      rows.row(static_cast<Eigen::Index>(j)) = pose->position[j].transpose().cast<float>();
  }
  std::vector<PositionsView> views;
  for (const Positions& rows : joints) views.emplace_back(rows.data(), rows.rows(), 3);
  DissimilarityMatrix matrix("true pose", database);
  set_aligned_distances(views, matrix);
  return matrix;
}

// F x 3 coordinates of one vertex as seen from a bone.
void track(const PerformanceDatabase& database, const std::vector<const SkeletonPose*>& poses,
           std::size_t vertex, std::size_t joint, std::vector<Eigen::Vector3d>& out) {
  out.clear();
  for (const MeshSequence& clip : database.clips()) {
    for (std::size_t f = 0; f < clip.frame_count(); ++f) {
      const SkeletonPose& pose = *poses[out.size()];
      const Eigen::Vector3d point =
          clip.frame(f).row(static_cast<Eigen::Index>(vertex)).transpose().cast<double>();
      out.push_back(pose.rotation[joint].conjugate() * (point - pose.position[joint]));
    }
  }
}

double variance(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  double sum = 0.0;
  for (const Eigen::Vector3d& p : points) sum += (p - mean).squaredNorm();
  return sum / static_cast<double>(points.size());
}

// Frames x (3 x free vertices): what hangs free, in the coordinates of bones.
Eigen::MatrixXf free_points(const PerformanceDatabase& database,
                            const std::vector<const SkeletonPose*>& poses,
                            const std::vector<std::size_t>& vertices) {
  // Column-major, so that a vertex is written in one place and no two threads share a column.
  Eigen::MatrixXf points(static_cast<Eigen::Index>(poses.size()),
                         3 * static_cast<Eigen::Index>(vertices.size()));
  const auto joint_count = static_cast<std::size_t>(database.markup()->skeleton.size());
  parallel_for(0, vertices.size(), [&](std::size_t i) {
    std::vector<Eigen::Vector3d> tracked;
    std::vector<Eigen::Vector3d> steadiest;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t joint = 0; joint < joint_count; ++joint) {
      track(database, poses, vertices[i], joint, tracked);
      const double moved = variance(tracked);
      if (moved >= least) continue;
      least = moved;
      steadiest.swap(tracked);
    }
    for (std::size_t f = 0; f < steadiest.size(); ++f)
      points.block<1, 3>(static_cast<Eigen::Index>(f), 3 * static_cast<Eigen::Index>(i)) =
          steadiest[f].transpose().cast<float>();
  });
  return points;
}

}  // namespace

bool has_truth(const PerformanceDatabase& database) {
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    if (database.truth(c) == nullptr) return false;
  }
  return !database.empty();
}

PerformanceTruth performance_truth(const PerformanceDatabase& database) {
  std::vector<const SkeletonPose*> poses;
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    const ClipTruth* truth = database.truth(c);
    if (truth == nullptr) {
      throw InvalidArgument(fmt::format("clip '{}' carries no truth: expected a synthetic performance",
                                        database.clip(c).name()));
    }
    for (const SkeletonPose& pose : truth->poses) poses.push_back(&pose);
  }
  PerformanceTruth result{.pose_and_shape = DissimilarityMatrix("true pose and shape", database),
                          .pose = joint_distances(database, poses),
                          .clothing = DissimilarityMatrix("true clothing", database)};

  std::vector<PositionsView> surfaces;
  for (const MeshSequence& clip : database.clips()) {
    for (std::size_t f = 0; f < clip.frame_count(); ++f) surfaces.push_back(clip.frame(f));
  }
  set_aligned_distances(surfaces, result.pose_and_shape);

  const std::vector<std::int32_t>& joint_of_vertex = database.markup()->joint_of_vertex;
  std::vector<std::size_t> free_vertices;
  for (std::size_t v = 0; v < joint_of_vertex.size(); ++v) {
    if (joint_of_vertex[v] < 0) free_vertices.push_back(v);
  }
  result.free_vertices = free_vertices.size();
  // Frames in columns: a pair reads two contiguous runs.
  const Eigen::MatrixXf free = free_points(database, poses, free_vertices).transpose();

  const std::size_t frame_count = database.frame_count();
  parallel_for(0, frame_count, [&](std::size_t a) {
    for (std::size_t b = a + 1; b < frame_count; ++b) {
      const double surface = result.pose_and_shape.value(a, b);
      const double joints = result.pose.value(a, b);
      result.pose_and_shape.set(a, b,
                                static_cast<float>(std::sqrt(0.5 * (surface * surface + joints * joints))),
                                result.pose_and_shape.yaw(a, b));
      double cloth = 0.0;
      if (!free_vertices.empty()) {
        const double squared =
            (free.col(static_cast<Eigen::Index>(a)) - free.col(static_cast<Eigen::Index>(b))).squaredNorm();
        cloth = std::sqrt(squared / static_cast<double>(free_vertices.size()));
      }
      result.clothing.set(a, b, static_cast<float>(cloth), 0.0F);
    }
  });
  return result;
}

}  // namespace reprise
