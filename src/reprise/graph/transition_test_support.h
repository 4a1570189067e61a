// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Clips that tests look for transitions in, and what the criterion says of a window.

#pragma once

#include <random>
#include <string>
#include <vector>

#include "reprise/graph/transition.h"
#include "reprise/io/sequence_reader.h"
#include "reprise/similarity/vertex_metric.h"
#include "support/shapes.h"
#include "support/test_data.h"

namespace reprise::test {

// A walk whose every frame is a little different, so that no two frames agree exactly.
inline MeshSequence uneven_walk(const std::string& name, std::size_t frame_count, double period, double phase,
                                unsigned seed) {
  MeshSequence clip = walk(name, frame_count, 0.04, period, phase);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> offset(-0.01F, 0.01F);
  for (std::size_t f = 0; f < frame_count; ++f) {
    const Eigen::Vector3f stretch(1.0F + offset(random), 1.0F + offset(random), 1.0F + offset(random));
    auto frame = clip.frame(f);
    const Eigen::RowVector3f c = frame.colwise().mean();
    frame = (((frame.rowwise() - c) * stretch.asDiagonal()).rowwise() + c).eval();
  }
  return clip;
}

inline PerformanceDatabase walks() {
  return database_of({uneven_walk("a", 70, 20.0, 0.0, 1), uneven_walk("b", 50, 23.0, 7.0, 2),
                      uneven_walk("c", 35, 18.0, 3.0, 3)});
}

inline PerformanceDatabase ama() {
  PerformanceDatabase database;
  for (const char* name : {"crane", "jumping"}) {
    const auto reader = open_sequence({.path = data_folder() / "ama" / name});
    MeshSequence clip(name, reader->topology(), reader->frame_count(), 25.0);
    for (std::size_t f = 0; f < reader->frame_count(); ++f) clip.frame(f) = reader->read(f).positions;
    database.add(std::move(clip));
  }
  return database;
}

// A clip whose frames all look alike.
inline MeshSequence frozen(const std::string& name, std::size_t frame_count) {
  const Shape shape = body();
  MeshSequence clip(name, shape.topology, frame_count, 25.0);
  for (std::size_t f = 0; f < frame_count; ++f) clip.frame(f) = shape.positions;
  return clip;
}

// What the criterion minimises, from its definition and the vertices.
struct Window {
  double distortion = 0.0;
  double peak = 0.0;
  double cost = 0.0;
};

inline Window window_by_definition(const PerformanceDatabase& database, const DissimilarityMatrix& matrix,
                                   const Transition& t, int L, const TransitionOptions& options) {
  const MeshSequence& source = database.clip(t.source_clip);
  const MeshSequence& target = database.clip(t.target_clip);
  const GroundTransform move = align_on_ground(source.frame(static_cast<std::size_t>(t.m)),
                                               target.frame(static_cast<std::size_t>(t.n)))
                                   .a_from_b;
  Window window;
  double weights = 0.0;
  std::vector<Eigen::MatrixX3d> frames;
  for (int k = -L - 1; k <= L + 1; ++k) {
    const double alpha = k < -L ? 0.0 : k > L ? 1.0 : blend_weight(options.profile, k, L);
    if (k >= -L && k <= L) {
      const double weight = std::min(alpha, 1.0 - alpha);
      weights += weight;
      window.distortion +=
          weight * static_cast<double>(
                       matrix.value(matrix.first_frame(t.source_clip) + static_cast<std::size_t>(t.m + k),
                                    matrix.first_frame(t.target_clip) + static_cast<std::size_t>(t.n + k)));
    }
    if ((k < -L && t.m + k < 0) || (k > L && t.n + k >= static_cast<int>(target.frame_count()))) continue;
    Eigen::MatrixX3d blended = Eigen::MatrixX3d::Zero(static_cast<Eigen::Index>(source.vertex_count()), 3);
    if (alpha < 1.0)
      blended += (1.0 - alpha) * source.frame(static_cast<std::size_t>(t.m + k)).cast<double>();
    if (alpha > 0.0) {
      Eigen::MatrixX3d moved = target.frame(static_cast<std::size_t>(t.n + k)).cast<double>();
      for (Eigen::Index v = 0; v < moved.rows(); ++v) {
        moved.row(v) = (move * moved.row(v).transpose().eval()).transpose();
      }
      blended += alpha * moved;
    }
    frames.push_back(std::move(blended));
  }
  for (std::size_t f = 1; f + 1 < frames.size(); ++f) {
    window.peak =
        std::max(window.peak, (frames[f - 1] - 2.0 * frames[f] + frames[f + 1]).rowwise().norm().maxCoeff());
  }
  window.cost = options.criterion == WindowCriterion::paper_sum
                    ? window.distortion
                    : window.distortion / weights + options.acceleration_weight * window.peak;
  return window;
}

// Half windows that fit around (m, n).
inline int room(const PerformanceDatabase& database, const Transition& t) {
  return std::min({t.m, static_cast<int>(database.clip(t.source_clip).frame_count()) - 1 - t.m, t.n,
                   static_cast<int>(database.clip(t.target_clip).frame_count()) - 1 - t.n});
}

}  // namespace reprise::test
