// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/example_selection.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/core/parallel.h"
#include "reprise/skeleton/rigid_fit.h"

namespace reprise {
namespace {

using Shape = Eigen::Matrix<float, 1, Eigen::Dynamic>;  // x, y, z of the part's vertices, aligned
using Shapes = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;  // one a row

// A part's rigidly aligned shapes.
class ShapeSpace {
 public:
  ShapeSpace(const Positions& reference, std::span<const std::int32_t> vertices);

  // Throws `InvalidArgument` naming the frame if a vertex is not finite.
  Shape aligned(const PerformanceDatabase& database, FrameId frame) const;
  Shapes aligned(const PerformanceDatabase& database, const std::vector<FrameId>& frames) const;

 private:
  std::span<const std::int32_t> vertices_;
  std::vector<Eigen::Vector3d> reference_;
  std::vector<double> weights_;
};

ShapeSpace::ShapeSpace(const Positions& reference, std::span<const std::int32_t> vertices)
    : vertices_(vertices), weights_(vertices.size(), 1.0) {
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const std::int32_t v = vertices[i];
    if (v < 0 || v >= reference.rows()) {
      throw InvalidArgument(fmt::format("the part has vertex {}: expected 0 to {}", v, reference.rows() - 1));
    }
    if (i > 0 && v <= vertices[i - 1]) {
      throw InvalidArgument(
          fmt::format("the part's vertices must ascend, found {} after {}", v, vertices[i - 1]));
    }
    reference_.emplace_back(reference.row(v).transpose().cast<double>());
    if (!reference_.back().allFinite()) {
      throw InvalidArgument(fmt::format("the reference is not finite at vertex {}", v));
    }
  }
  if (!skeleton::fixes_rotation(reference_, weights_)) {
    throw InvalidArgument(fmt::format(
        "the part's {} vertices lie on a line or in a point, which does not tell how a frame is turned",
        vertices.size()));
  }
}

Shape ShapeSpace::aligned(const PerformanceDatabase& database, FrameId frame) const {
  const PositionsView positions = database.clip(frame.clip_idx).frame(frame.frame_idx);
  std::vector<Eigen::Vector3d> points(vertices_.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = positions.row(vertices_[i]).transpose().cast<double>();
    if (!points[i].allFinite()) {
      throw InvalidArgument(fmt::format("frame {} is not finite at vertex {}: exclude it from the examples",
                                        database.to_string(frame), vertices_[i]));
    }
  }
  const skeleton::RigidFit fit = skeleton::fit_rigid(points, reference_, weights_);
  Shape shape(3 * static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    // About the centroid: rounding to floats then does not depend on where the reference stands.
    const Eigen::Vector3d point = fit.rotation * (points[i] - fit.rest_centroid);
    shape.segment<3>(3 * static_cast<Eigen::Index>(i)) = point.transpose().cast<float>();
  }
  return shape;
}

Shapes ShapeSpace::aligned(const PerformanceDatabase& database, const std::vector<FrameId>& frames) const {
  Shapes shapes(static_cast<Eigen::Index>(frames.size()), 3 * static_cast<Eigen::Index>(vertices_.size()));
  parallel_for(0, frames.size(), [&](std::size_t f) {
    throw_if_interrupted();
    shapes.row(static_cast<Eigen::Index>(f)) = aligned(database, frames[f]);
  });
  return shapes;
}

// Distances of the shapes to the nearest example so far, squared and summed over the part's vertices.
class Cover {
 public:
  explicit Cover(const Shapes& shapes)
      : shapes_(shapes),
        squares_(static_cast<std::size_t>(shapes.rows()), std::numeric_limits<double>::infinity()),
        nearest_(squares_.size(), 0) {}

  void add(const Shape& example) {
    throw_if_interrupted();
    std::vector<double> gaps(examples_.size());  // from the examples so far
    parallel_for(
        0, gaps.size(), [&](std::size_t e) { gaps[e] = square(examples_[e], example); }, grain);
    parallel_for(
        0, squares_.size(),
        [&](std::size_t f) {
          // Twice as far from a shape's example as the shape itself cannot be nearer to it (triangle
          // inequality).
          if (!gaps.empty() && gaps[nearest_[f]] > 4.0001 * squares_[f]) return;
          const double to_example = square(shapes_.row(static_cast<Eigen::Index>(f)), example);
          if (to_example >= squares_[f]) return;
          squares_[f] = to_example;
          nearest_[f] = examples_.size();
        },
        grain);
    examples_.push_back(example);
    farthest_ = static_cast<std::size_t>(std::ranges::max_element(squares_) - squares_.begin());
  }

  std::size_t farthest() const { return farthest_; }
  double radius() const { return std::sqrt(3.0 * squares_[farthest_] / static_cast<double>(shapes_.cols())); }

 private:
  static constexpr std::size_t grain = 16;

  static double square(const Eigen::Ref<const Shape>& a, const Shape& b) {
    return (a - b).cast<double>().squaredNorm();
  }

  const Shapes& shapes_;
  std::vector<Shape> examples_;
  std::vector<double> squares_;
  std::vector<std::size_t> nearest_;  // example of each shape
  std::size_t farthest_ = 0;
};

std::vector<FrameId> candidates(const PerformanceDatabase& database, const ExampleOptions& options) {
  if (options.stride == 0) throw InvalidArgument("the stride of examples is 0: expected 1 or more");
  std::vector<std::vector<bool>> excluded;
  for (const MeshSequence& clip : database.clips()) excluded.emplace_back(clip.frame_count(), false);
  for (const FrameId& frame : options.excluded) {
    database.clip(frame.clip_idx).frame(frame.frame_idx);  // checks the indices
    excluded[frame.clip_idx][frame.frame_idx] = true;
  }
  std::vector<FrameId> left;
  for (std::size_t c = 0; c < excluded.size(); ++c) {
    for (std::size_t f = 0; f < excluded[c].size(); f += options.stride) {
      if (!excluded[c][f]) left.push_back({.clip_idx = c, .frame_idx = f});
    }
  }
  if (left.empty()) {
    throw InvalidArgument(fmt::format("no frame is left to choose examples from: {} of {} are excluded",
                                      options.excluded.size(), database.frame_count()));
  }
  return left;
}

ShapeSpace shape_space(const PerformanceDatabase& database, const Positions& reference,
                       std::span<const std::int32_t> vertices) {
  if (database.topology() && reference.rows() != database.topology()->vertex_count) {
    throw InvalidArgument(fmt::format("the reference has {} vertices, the database {}", reference.rows(),
                                      database.topology()->vertex_count));
  }
  return {reference, vertices};
}

std::size_t nearest_to_mean(const Shapes& shapes) {
  const Eigen::RowVectorXd mean = shapes.cast<double>().colwise().mean();
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index f = 0; f < shapes.rows(); ++f) {
    const double square = (shapes.row(f).cast<double>() - mean).squaredNorm();
    if (square < least) {
      least = square;
      nearest = static_cast<std::size_t>(f);
    }
  }
  return nearest;
}

}  // namespace

ExampleSelection select_examples(const PerformanceDatabase& database, const Positions& reference,
                                 std::span<const std::int32_t> vertices, const ExampleOptions& options) {
  if (options.count == 0) throw InvalidArgument("the number of examples is 0: expected 1 or more");
  if (!(options.smallest_radius >= 0.0)) {
    throw InvalidArgument(
        fmt::format("the smallest radius is {} m: expected 0 or more", options.smallest_radius));
  }
  const std::vector<FrameId> frames = candidates(database, options);
  const Shapes shapes = shape_space(database, reference, vertices).aligned(database, frames);
  ExampleSelection selection{.candidate_count = frames.size()};
  Cover cover(shapes);
  std::size_t next = nearest_to_mean(shapes);
  do {
    cover.add(shapes.row(static_cast<Eigen::Index>(next)));
    selection.frames.push_back(frames[next]);
    selection.radii.push_back(cover.radius());
    next = cover.farthest();
  } while (selection.frames.size() < options.count && selection.radii.back() > options.smallest_radius);
  return selection;
}

std::vector<double> covering_radii(const PerformanceDatabase& database, const Positions& reference,
                                   std::span<const std::int32_t> vertices, std::span<const FrameId> examples,
                                   const ExampleOptions& options) {
  const std::vector<FrameId> frames = candidates(database, options);
  const ShapeSpace space = shape_space(database, reference, vertices);
  const Shapes shapes = space.aligned(database, frames);
  Cover cover(shapes);
  std::vector<double> radii;
  for (const FrameId& example : examples) {
    cover.add(space.aligned(database, example));
    radii.push_back(cover.radius());
  }
  return radii;
}

}  // namespace reprise
