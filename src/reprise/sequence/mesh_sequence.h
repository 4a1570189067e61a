// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A mesh sequence: F frames of one topology at a constant rate. Captured, synthetic and generated motion are
// all this.

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "reprise/math/ground_transform.h"
#include "reprise/mesh/mesh.h"

namespace reprise {

// Where a generated frame comes from: a captured frame, or a blend of two (HSSMG Eq. 6).
struct FrameOrigin {
  std::string clip;
  std::int32_t frame_idx = 0;
  // Inside a blend: the partner and its weight alpha in (0, 1); otherwise empty, 0 and 0.
  std::string partner_clip;
  std::int32_t partner_frame_idx = 0;
  double partner_weight = 0.0;

  bool is_blend() const { return !partner_clip.empty(); }
  bool operator==(const FrameOrigin&) const = default;
};

// Frames are contiguous: F x N x 3 floats, metres, Y up.
class MeshSequence {
 public:
  MeshSequence() = default;
  // `topology` not null, `frames_per_second` positive and finite. All positions start at zero. Throws
  // `InvalidArgument`.
  MeshSequence(std::string name, TopologyPtr topology, std::size_t frame_count, double frames_per_second);

  const std::string& name() const { return name_; }
  void set_name(std::string name) { name_ = std::move(name); }
  const TopologyPtr& topology() const { return topology_; }
  // Points at an equal topology that others share. Throws `InvalidArgument` if the vertex counts differ.
  void share_topology(TopologyPtr topology);
  std::size_t frame_count() const { return frame_count_; }
  std::size_t vertex_count() const { return vertex_count_; }
  double frames_per_second() const { return frames_per_second_; }
  // Length of the motion in seconds: frames x frame time (HSSMG Eq. 12).
  double duration() const { return static_cast<double>(frame_count_) / frames_per_second_; }

  // Positions of one frame, N x 3. Throws `InvalidArgument` if the index is out of range.
  PositionsView frame(std::size_t frame_idx) const;
  PositionsRef frame(std::size_t frame_idx);
  const std::vector<float>& data() const { return positions_; }

  // Normals as the source gave them: none, or F x N x 3 like positions.
  bool has_normals() const { return !normals_.empty(); }
  PositionsView normals(std::size_t frame_idx) const;
  // Makes room for normals of all frames (zero) if there is none yet.
  PositionsRef mutable_normals(std::size_t frame_idx);

  // Colours: none, one set for all frames, or one set a frame.
  bool has_colors() const { return !colors_.empty(); }
  bool has_colors_per_frame() const { return colors_.size() > vertex_count_; }
  // N colours of a frame. Throws `InvalidArgument` if there are none or the index is out of range.
  std::span<const Color> colors(std::size_t frame_idx) const;
  // `colors`: empty, N, or F x N entries. Throws `InvalidArgument`.
  void set_colors(std::vector<Color> colors);

  // Provenance of generated motion: none, or one origin a frame.
  const std::vector<FrameOrigin>& origins() const { return origins_; }
  // Throws `InvalidArgument` unless there is none or one a frame.
  void set_origins(std::vector<FrameOrigin> origins);

  // Copy of one frame with everything known of it.
  Mesh mesh(std::size_t frame_idx) const;

 private:
  void check_frame(std::size_t frame_idx) const;

  std::string name_;
  TopologyPtr topology_;
  std::size_t frame_count_ = 0;
  std::size_t vertex_count_ = 0;
  double frames_per_second_ = 25.0;
  std::vector<float> positions_;
  std::vector<float> normals_;
  std::vector<Color> colors_;
  std::vector<FrameOrigin> origins_;
};

// Centroid of the vertices.
Eigen::Vector3d centroid(const PositionsView& positions);

// centre() of HSSMG Eq. 10 for every frame: the centroid projected on the ground, (x, z) in metres. F
// entries.
std::vector<Eigen::Vector2d> ground_trajectory(const MeshSequence& sequence);

// Length of the ground trajectory between two frames: the sum of Eq. 10. Throws `InvalidArgument` unless
// first <= last < F.
double ground_distance(const std::vector<Eigen::Vector2d>& trajectory, std::size_t first, std::size_t last);

// `out` = the transform applied to every row of `in`, which may be `out`. Both N x 3; throws
// `InvalidArgument` if N differs.
void transform_positions(const GroundTransform& out_from_in, const PositionsView& in, PositionsRef out);

}  // namespace reprise
