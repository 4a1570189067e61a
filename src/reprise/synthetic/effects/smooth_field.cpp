// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/effects/smooth_field.h"

#include <cmath>

#include "reprise/core/parallel.h"

namespace reprise {

namespace {

// White noise under weights exp(-d^2 / s^2) has the correlation exp(-d^2 / (2 s^2)). Beyond two s they are
// below 2 %.
constexpr double window = 2.0;

double weight(double distance, double scale) {
  return std::exp(-(distance * distance) / (scale * scale));
}

}  // namespace

SmoothField::SmoothField(const EdgeGraph& surface, std::size_t frame_count, double frames_per_second,
                         const RandomField& random, const SmoothFieldOptions& options)
    : components_(options.components) {
  const int half = static_cast<int>(std::floor(window * options.time * frames_per_second));
  double squares = 0.0;
  for (int k = -half; k <= half; ++k) {
    time_weights_.push_back(static_cast<float>(weight(k / frames_per_second, options.time)));
    squares += static_cast<double>(time_weights_.back()) * time_weights_.back();
  }
  for (float& w : time_weights_) w /= static_cast<float>(std::sqrt(squares));

  const std::size_t vertex_count = surface.vertex_count();
  white_.resize(frame_count + 2 * static_cast<std::size_t>(half));
  parallel_for(0, white_.size(), [&](std::size_t f) {
    Eigen::MatrixXf& numbers = white_[f];
    numbers.resize(static_cast<Eigen::Index>(vertex_count), components_);
    for (Eigen::Index i = 0; i < numbers.size(); i += 2) {
      const auto pair = random.normal_pair(f, static_cast<std::uint64_t>(i));
      numbers.data()[i] = static_cast<float>(pair[0]);
      if (i + 1 < numbers.size()) numbers.data()[i + 1] = static_cast<float>(pair[1]);
    }
  });

  smoothing_.resize(vertex_count);
  parallel_for(0, vertex_count, [&](std::size_t v) {
    double sum = 0.0;
    for (const auto& [near, distance] :
         surface.neighbourhood(static_cast<std::int32_t>(v), static_cast<float>(window * options.length))) {
      smoothing_[v].push_back({near, static_cast<float>(weight(distance, options.length))});
      sum += static_cast<double>(smoothing_[v].back().weight) * smoothing_[v].back().weight;
    }
    for (Weight& w : smoothing_[v]) w.weight /= static_cast<float>(std::sqrt(sum));
  });
}

Eigen::MatrixXf SmoothField::frame(std::size_t frame_idx) const {
  Eigen::MatrixXf in_time = Eigen::MatrixXf::Zero(white_.front().rows(), components_);
  for (std::size_t k = 0; k < time_weights_.size(); ++k) in_time += time_weights_[k] * white_[frame_idx + k];
  Eigen::MatrixXf field = Eigen::MatrixXf::Zero(in_time.rows(), components_);
  for (std::size_t v = 0; v < smoothing_.size(); ++v) {
    for (const auto& [near, w] : smoothing_[v])
      field.row(static_cast<Eigen::Index>(v)) += w * in_time.row(near);
  }
  return field;
}

}  // namespace reprise
