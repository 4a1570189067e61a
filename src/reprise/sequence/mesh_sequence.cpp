// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/sequence/mesh_sequence.h"

#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {

MeshSequence::MeshSequence(std::string name, TopologyPtr topology, std::size_t frame_count,
                           double frames_per_second)
    : name_(std::move(name)),
      topology_(std::move(topology)),
      frame_count_(frame_count),
      frames_per_second_(frames_per_second) {
  if (!topology_) throw InvalidArgument(fmt::format("sequence '{}' has no topology", name_));
  if (!(frames_per_second > 0.0) || !std::isfinite(frames_per_second)) {
    throw InvalidArgument(fmt::format("sequence '{}': {} frames per second; expected a positive, finite rate",
                                      name_, frames_per_second));
  }
  vertex_count_ = static_cast<std::size_t>(topology_->vertex_count);
  positions_.resize(frame_count_ * vertex_count_ * 3);
}

void MeshSequence::share_topology(TopologyPtr topology) {
  if (!topology || static_cast<std::size_t>(topology->vertex_count) != vertex_count_) {
    throw InvalidArgument(fmt::format(
        "sequence '{}' has {} vertices: it cannot take {}", name_, vertex_count_,
        topology ? fmt::format("a topology of {}", topology->vertex_count) : std::string("no topology")));
  }
  topology_ = std::move(topology);
}

void MeshSequence::check_frame(std::size_t frame_idx) const {
  if (frame_count_ == 0) throw InvalidArgument(fmt::format("sequence '{}' has no frames", name_));
  if (frame_idx >= frame_count_) {
    throw InvalidArgument(
        fmt::format("sequence '{}' has frames 0 to {}, asked for {}", name_, frame_count_ - 1, frame_idx));
  }
}

PositionsView MeshSequence::frame(std::size_t frame_idx) const {
  check_frame(frame_idx);
  return {positions_.data() + frame_idx * vertex_count_ * 3, static_cast<Eigen::Index>(vertex_count_), 3};
}

PositionsRef MeshSequence::frame(std::size_t frame_idx) {
  check_frame(frame_idx);
  return {positions_.data() + frame_idx * vertex_count_ * 3, static_cast<Eigen::Index>(vertex_count_), 3};
}

PositionsView MeshSequence::normals(std::size_t frame_idx) const {
  check_frame(frame_idx);
  if (!has_normals()) throw InvalidArgument(fmt::format("sequence '{}' has no normals", name_));
  return {normals_.data() + frame_idx * vertex_count_ * 3, static_cast<Eigen::Index>(vertex_count_), 3};
}

PositionsRef MeshSequence::mutable_normals(std::size_t frame_idx) {
  check_frame(frame_idx);
  normals_.resize(positions_.size());
  return {normals_.data() + frame_idx * vertex_count_ * 3, static_cast<Eigen::Index>(vertex_count_), 3};
}

std::span<const Color> MeshSequence::colors(std::size_t frame_idx) const {
  check_frame(frame_idx);
  if (!has_colors()) throw InvalidArgument(fmt::format("sequence '{}' has no colours", name_));
  const std::size_t first = has_colors_per_frame() ? frame_idx * vertex_count_ : 0;
  return std::span(colors_).subspan(first, vertex_count_);
}

void MeshSequence::set_colors(std::vector<Color> colors) {
  if (!colors.empty() && colors.size() != vertex_count_ && colors.size() != frame_count_ * vertex_count_) {
    throw InvalidArgument(fmt::format("sequence '{}': {} colours for {} vertices and {} frames", name_,
                                      colors.size(), vertex_count_, frame_count_));
  }
  colors_ = std::move(colors);
}

void MeshSequence::set_origins(std::vector<FrameOrigin> origins) {
  if (!origins.empty() && origins.size() != frame_count_) {
    throw InvalidArgument(
        fmt::format("sequence '{}': {} origins for {} frames", name_, origins.size(), frame_count_));
  }
  origins_ = std::move(origins);
}

Mesh MeshSequence::mesh(std::size_t frame_idx) const {
  Mesh mesh{.topology = topology_, .positions = frame(frame_idx), .normals = {}, .colors = {}};
  if (has_normals()) mesh.normals = normals(frame_idx);
  if (has_colors()) {
    const auto frame_colors = colors(frame_idx);
    mesh.colors.assign(frame_colors.begin(), frame_colors.end());
  }
  return mesh;
}

Eigen::Vector3d centroid(const PositionsView& positions) {
  return positions.cast<double>().colwise().mean().transpose();
}

std::vector<Eigen::Vector2d> ground_trajectory(const MeshSequence& sequence) {
  std::vector<Eigen::Vector2d> trajectory(sequence.frame_count());
  for (std::size_t f = 0; f < trajectory.size(); ++f) {
    const Eigen::Vector3d c = centroid(sequence.frame(f));
    trajectory[f] = {c.x(), c.z()};
  }
  return trajectory;
}

double ground_distance(const std::vector<Eigen::Vector2d>& trajectory, std::size_t first, std::size_t last) {
  if (first > last || last >= trajectory.size()) {
    throw InvalidArgument(fmt::format("no way from frame {} to frame {} in a trajectory of {} frames", first,
                                      last, trajectory.size()));
  }
  double distance = 0.0;
  for (std::size_t f = first; f < last; ++f) distance += (trajectory[f + 1] - trajectory[f]).norm();
  return distance;
}

void transform_positions(const GroundTransform& out_from_in, const PositionsView& in, PositionsRef out) {
  if (in.rows() != out.rows()) {
    throw InvalidArgument(
        fmt::format("{} positions cannot be transformed into room for {}", in.rows(), out.rows()));
  }
  const Eigen::Matrix3d R_transposed = out_from_in.rotation().transpose();
  const Eigen::RowVector3d t = out_from_in.translation3().transpose();
  for (Eigen::Index v = 0; v < in.rows(); ++v) {
    out.row(v) = (in.row(v).cast<double>() * R_transposed + t).cast<float>();
  }
}

}  // namespace reprise
