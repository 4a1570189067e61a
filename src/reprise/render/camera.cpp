// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/render/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"

namespace reprise {
namespace {

constexpr double degrees = std::numbers::pi / 180.0;
constexpr double smoothing_seconds = 0.4;  // about half a stride: steps do not shake the camera
constexpr double fill_height = 0.74;  // part of the picture's height and width that the character may fill
constexpr double fill_width = 0.86;
constexpr double light_yaw = -52.0 * degrees;  // from the camera: over its left shoulder
constexpr double light_pitch = 48.0 * degrees;
constexpr double penumbra_margin = 0.2;  // metres around the character's own outline in the shadow map

View look_from(double yaw, double pitch) {
  const Eigen::Vector3d towards(std::sin(yaw) * std::cos(pitch), std::sin(pitch),
                                std::cos(yaw) * std::cos(pitch));
  View view;
  view.eye.setZero();
  view.forward = -towards;
  view.right = Eigen::Vector3d(std::cos(yaw), 0.0, -std::sin(yaw));
  view.up = view.right.cross(view.forward);
  return view;
}

void check_range(const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high)) {
    throw InvalidArgument(fmt::format("{}: expected {} to {}, found {}", name, low, high, value));
  }
}

// The tightest pinhole view along fixed axes: |right . p - x| <= k_x depth, |up . p - y| <= k_y depth for all
// points p, where depth = distance + forward . p. Each side of the picture is one linear bound, so four
// maxima suffice.
struct Fit {
  Eigen::Array4d sides = Eigen::Array4d::Constant(-std::numeric_limits<double>::infinity());
  double nearest = std::numeric_limits<double>::infinity();  // smallest forward . p

  void add(double x, double y, double z, double k_x, double k_y) {
    sides = sides.max(Eigen::Array4d(x - k_x * z, -x - k_x * z, y - k_y * z, -y - k_y * z));
    nearest = std::min(nearest, z);
  }
  void add(const Fit& other) {
    sides = sides.max(other.sides);
    nearest = std::min(nearest, other.nearest);
  }
};

struct Extent {
  Eigen::Array3d low = Eigen::Array3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Array3d high = Eigen::Array3d::Constant(-std::numeric_limits<double>::infinity());

  void add(const Eigen::Array3d& point) {
    low = low.min(point);
    high = high.max(point);
  }
};

}  // namespace

std::vector<Eigen::Vector2d> smooth_trajectory(const std::vector<Eigen::Vector2d>& points, double sigma) {
  const auto count = static_cast<std::ptrdiff_t>(points.size());
  const auto at = [&](std::ptrdiff_t i) -> Eigen::Vector2d {
    const auto clamped = [&](std::ptrdiff_t j) {
      return points[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(j, 0, count - 1))];
    };
    if (i < 0) return 2.0 * clamped(0) - clamped(-i);
    if (i >= count) return 2.0 * clamped(count - 1) - clamped(2 * (count - 1) - i);
    return clamped(i);
  };
  const auto radius = static_cast<std::ptrdiff_t>(std::ceil(3.0 * sigma));
  std::vector<double> weights;
  for (std::ptrdiff_t k = -radius; k <= radius; ++k) {
    weights.push_back(sigma > 0.0 ? std::exp(-0.5 * static_cast<double>(k * k) / (sigma * sigma)) : 1.0);
  }
  std::vector<Eigen::Vector2d> smoothed(points.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double total = 0.0;
    for (std::ptrdiff_t k = -radius; k <= radius; ++k) {
      const double weight = weights[static_cast<std::size_t>(k + radius)];
      sum += weight * at(i + k);
      total += weight;
    }
    smoothed[static_cast<std::size_t>(i)] = sum / total;
  }
  return smoothed;
}

CameraPath::CameraPath(const MeshSequence& sequence, const RenderOptions& options) : mode_(options.camera) {
  check_range("camera_pitch_degrees", options.camera_pitch_degrees, -89.0, 89.0);
  check_range("camera_yaw_degrees", options.camera_yaw_degrees, -1e6, 1e6);
  check_range("field_of_view_degrees", options.field_of_view_degrees, 1.0, 120.0);
  check_range("zoom", options.zoom, 1.0, 1000.0);
  check_range("look_at[0]", options.look_at[0], -100.0, 100.0);
  check_range("look_at[1]", options.look_at[1], -100.0, 100.0);
  const std::size_t frame_count = sequence.frame_count();
  if (frame_count == 0)
    throw InvalidArgument(fmt::format("sequence '{}' has no frame to draw", sequence.name()));

  pitch_ = options.camera_pitch_degrees * degrees;
  yaw_ = mode_ == CameraMode::front  ? 0.0
         : mode_ == CameraMode::side ? 90.0 * degrees
                                     : options.camera_yaw_degrees * degrees;
  tan_half_height_ = std::tan(0.5 * options.field_of_view_degrees * degrees);
  tan_half_width_ = tan_half_height_ * options.width / options.height;

  // Vertices that are not numbers are left out here, so that one bad frame does not make the whole video
  // empty.
  std::vector<double> lowest(frame_count, std::numeric_limits<double>::infinity());
  std::vector<Eigen::Vector2d> centers(frame_count, Eigen::Vector2d::Zero());
  std::vector<std::size_t> finite_counts(frame_count, 0);
  parallel_for(0, frame_count, [&](std::size_t f) {
    const PositionsView positions = sequence.frame(f);
    for (Eigen::Index v = 0; v < positions.rows(); ++v) {
      const Eigen::Vector3d p = positions.row(v).cast<double>();
      if (!p.allFinite()) continue;
      lowest[f] = std::min(lowest[f], p.y());
      centers[f] += Eigen::Vector2d(p.x(), p.z());
      ++finite_counts[f];
    }
    if (finite_counts[f] > 0) centers[f] /= static_cast<double>(finite_counts[f]);
  });
  const auto usable =
      std::find_if(finite_counts.begin(), finite_counts.end(), [](std::size_t n) { return n > 0; });
  if (usable == finite_counts.end()) {
    throw InvalidArgument(
        fmt::format("sequence '{}' has no vertex with finite coordinates", sequence.name()));
  }
  // A frame without any finite vertex takes the place of the one before it.
  std::size_t last = static_cast<std::size_t>(usable - finite_counts.begin());
  for (std::size_t f = 0; f < last; ++f) centers[f] = centers[last];
  for (std::size_t f = last; f < frame_count; ++f) {
    if (finite_counts[f] > 0) last = f;
    centers[f] = centers[last];
  }
  trajectory_ = smooth_trajectory(centers, smoothing_seconds * sequence.frames_per_second());
  Eigen::Array2d low = trajectory_[0];
  Eigen::Array2d high = trajectory_[0];
  for (const Eigen::Vector2d& point : trajectory_) {
    low = low.min(point.array());
    high = high.max(point.array());
  }
  middle_ = 0.5 * (low + high);

  // The lower quartile of the frames' lowest points: a few bad frames do not sink the floor, and flight does
  // not lift it.
  std::erase_if(lowest, [](double y) { return !std::isfinite(y); });
  const auto quartile = lowest.begin() + static_cast<std::ptrdiff_t>(lowest.size() / 4);
  std::nth_element(lowest.begin(), quartile, lowest.end());
  ground_height_ = *quartile;

  light_ = look_from(yaw_ + light_yaw, light_pitch);
  const double k_x = fill_width * tan_half_width_;
  const double k_y = fill_height * tan_half_height_;
  std::vector<Fit> fits(frame_count);
  std::vector<Extent> extents(frame_count);
  parallel_for(0, frame_count, [&](std::size_t f) {
    const View view = axes(f);
    const Eigen::Vector3d camera_anchor =
        mode_ == CameraMode::fixed ? Eigen::Vector3d(middle_.x(), ground_height_, middle_.y()) : anchor(f);
    const Eigen::Vector3d light_anchor = anchor(f);
    const PositionsView positions = sequence.frame(f);
    for (Eigen::Index v = 0; v < positions.rows(); ++v) {
      const Eigen::Vector3d p = positions.row(v).cast<double>();
      if (!p.allFinite()) continue;
      const Eigen::Vector3d q = p - camera_anchor;
      fits[f].add(view.right.dot(q), view.up.dot(q), view.forward.dot(q), k_x, k_y);
      const Eigen::Vector3d r = p - light_anchor;
      extents[f].add({light_.right.dot(r), light_.up.dot(r), light_.forward.dot(r)});
    }
  });
  Fit fit;
  Extent extent;
  for (std::size_t f = 0; f < frame_count; ++f) {
    fit.add(fits[f]);
    extent.low = extent.low.min(extents[f].low);
    extent.high = extent.high.max(extents[f].high);
  }

  const auto& side = fit.sides;
  double distance_x = (side[0] + side[1]) / (2.0 * k_x);
  if (mode_ == CameraMode::orbit) {
    // A sideways offset would swing the character about while the camera turns.
    distance_x = std::max(side[0], side[1]) / k_x;
  } else {
    offset_.x() = 0.5 * (side[0] - side[1]);
  }
  offset_.y() = 0.5 * (side[2] - side[3]);
  // A single point has no size: stand back anyway.
  const double distance_y = (side[2] + side[3]) / (2.0 * k_y);
  distance_ = std::max({distance_x, distance_y, 0.01 - fit.nearest});
  zoom_in(options, k_y * distance_y / distance_);

  const Eigen::Array3d size = extent.high - extent.low;
  light_window_.center = (0.5 * (extent.low + extent.high)).head<2>();
  light_window_.half_size = 0.5 * std::max(size.x(), size.y()) + penumbra_margin;
  light_window_.near = extent.low.z() - penumbra_margin;
  light_window_.far = extent.high.z() + penumbra_margin;
}

// `framed_half_height`: that of the character, as a tangent.
void CameraPath::zoom_in(const RenderOptions& options, double framed_half_height) {
  if (options.zoom > 1.0) {
    tan_middle_ =
        framed_half_height * Eigen::Vector2d(2.0 * options.look_at[0], 2.0 * options.look_at[1] - 1.0);
  }
  tan_half_width_ /= options.zoom;
  tan_half_height_ /= options.zoom;
}

View CameraPath::axes(std::size_t frame_idx) const {
  double yaw = yaw_;
  if (mode_ == CameraMode::orbit) {
    yaw += 2.0 * std::numbers::pi * static_cast<double>(frame_idx) / static_cast<double>(trajectory_.size());
  }
  return look_from(yaw, pitch_);
}

Eigen::Vector3d CameraPath::anchor(std::size_t frame_idx) const {
  const Eigen::Vector2d& point = trajectory_.at(frame_idx);
  return {point.x(), ground_height_, point.y()};
}

View CameraPath::view(std::size_t frame_idx) const {
  View view = axes(frame_idx);
  const Eigen::Vector3d target = mode_ == CameraMode::fixed
                                     ? Eigen::Vector3d(middle_.x(), ground_height_, middle_.y())
                                     : anchor(frame_idx);
  view.eye = target + offset_.x() * view.right + offset_.y() * view.up - distance_ * view.forward;
  return view;
}

}  // namespace reprise
