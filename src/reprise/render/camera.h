// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Where the camera and the light stand at every frame of a sequence.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "reprise/render/renderer.h"

namespace reprise {

// An orthonormal frame with its origin; looks along `forward`.
struct View {
  Eigen::Vector3d eye;
  Eigen::Vector3d right;
  Eigen::Vector3d up;
  Eigen::Vector3d forward;
};

// Window of the key light, in metres along the light's own right, up and forward axes about the anchor of a
// frame.
struct LightWindow {
  Eigen::Vector2d center;
  double half_size = 1.0;
  double near = 0.0;
  double far = 1.0;
};

// Framing holds for every vertex of every frame, so nothing is ever cut off, and distance and height of the
// camera stay constant over the sequence: only the anchor moves, on the ground, along the smoothed trajectory
// of the character.
class CameraPath {
 public:
  // Throws `InvalidArgument` if the sequence has no frame or no finite vertex, or an option is out of range.
  CameraPath(const MeshSequence& sequence, const RenderOptions& options);

  View view(std::size_t frame_idx) const;
  // Point on the ground below the character.
  Eigen::Vector3d anchor(std::size_t frame_idx) const;
  double ground_height() const { return ground_height_; }
  double distance() const { return distance_; }
  // The picture shows the directions right / forward and up / forward within these half sizes of the middle,
  // which is zero unless the options zoom in.
  double tan_half_height() const { return tan_half_height_; }
  double tan_half_width() const { return tan_half_width_; }
  const Eigen::Vector2d& tan_middle() const { return tan_middle_; }

  // Axes of the key light; the origin is the world's.
  const View& light() const { return light_; }
  const LightWindow& light_window() const { return light_window_; }

 private:
  View axes(std::size_t frame_idx) const;
  void zoom_in(const RenderOptions& options, double framed_half_height);

  CameraMode mode_;
  double yaw_ = 0.0;
  double pitch_ = 0.0;
  double ground_height_ = 0.0;
  double tan_half_height_ = 0.0;
  double tan_half_width_ = 0.0;
  Eigen::Vector2d tan_middle_ = Eigen::Vector2d::Zero();
  double distance_ = 0.0;
  Eigen::Vector2d offset_ = Eigen::Vector2d::Zero();  // of the eye from the anchor, along right and up
  std::vector<Eigen::Vector2d> trajectory_;           // smoothed, (x, z)
  Eigen::Vector2d middle_ = Eigen::Vector2d::Zero();  // of the trajectory: the anchor of a fixed camera
  View light_;
  LightWindow light_window_;
};

// Gaussian of `sigma` frames over a polyline. Straight uniform motion comes out unchanged, at both ends too:
// the line is continued there by its point reflection.
std::vector<Eigen::Vector2d> smooth_trajectory(const std::vector<Eigen::Vector2d>& points, double sigma);

}  // namespace reprise
