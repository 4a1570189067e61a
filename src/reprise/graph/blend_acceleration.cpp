// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/graph/blend_acceleration.h"

#include <cmath>

namespace reprise {
namespace {

using Row = Eigen::Map<const Eigen::ArrayXf>;

Eigen::Index column_of(int frame, const Eigen::ArrayXXf& frames) {
  return std::clamp<Eigen::Index>(frame, 0, frames.cols() - 1);
}

Eigen::Vector3f middle(const SampledClip& clip, int frame) {
  const Eigen::Index count = clip.sample_count();
  const auto column = clip.positions.col(frame);
  return {column.head(count).mean(), column.segment(count, count).mean(), column.tail(count).mean()};
}

}  // namespace

SampledClip::SampledClip(const MeshSequence& clip, std::span<const std::int32_t> vertices) {
  const auto count = static_cast<Eigen::Index>(vertices.size());
  const auto frame_count = static_cast<Eigen::Index>(clip.frame_count());
  positions.resize(3 * count, frame_count);
  for (Eigen::Index f = 0; f < frame_count; ++f) {
    const PositionsView frame = clip.frame(static_cast<std::size_t>(f));
    for (Eigen::Index s = 0; s < count; ++s) {
      for (Eigen::Index c = 0; c < 3; ++c) {
        positions(c * count + s, f) = frame(vertices[static_cast<std::size_t>(s)], c);
      }
    }
  }
  accelerations.resize(3 * count, frame_count);
  for (Eigen::Index f = 0; f < frame_count; ++f) {
    const auto at = positions.col(f).cast<double>();
    const auto before = positions.col(std::max<Eigen::Index>(f - 1, 0)).cast<double>();
    const auto after = positions.col(std::min(f + 1, frame_count - 1)).cast<double>();
    accelerations.col(f) = (before - 2.0 * at + after).cast<float>();
  }
}

BlendWindow::BlendWindow(const SampledClip& source, const SampledClip& target, int max_half_window)
    : source_(source),
      target_(target),
      reach_(max_half_window + 1),
      differences_(source.positions.rows(), 2 * reach_ + 1),
      is_ready_(static_cast<std::size_t>(2 * reach_ + 1)) {}

void BlendWindow::place(int m, int n, const GroundTransform& source_from_target, Eigen::Index sample_count) {
  m_ = m;
  n_ = n;
  count_ = sample_count;
  cos_yaw_ = static_cast<float>(std::cos(source_from_target.yaw));
  sin_yaw_ = static_cast<float>(std::sin(source_from_target.yaw));
  source_origin_ = middle(source_, m);
  target_origin_ = middle(target_, n);
  offset_ = (source_from_target * target_origin_.cast<double>().eval() - source_origin_.cast<double>())
                .cast<float>();
  is_ready_.assign(is_ready_.size(), false);
}

const float* BlendWindow::difference(int k) {
  const Eigen::Index column = k + reach_;
  float* out = differences_.col(column).data();
  if (is_ready_[static_cast<std::size_t>(column)]) return out;
  is_ready_[static_cast<std::size_t>(column)] = true;
  // Frames beyond a clip's end get weight zero: any frame may stand in for them.
  const Eigen::Index stride = source_.sample_count();
  const float* a = source_.positions.col(column_of(m_ + k, source_.positions)).data();
  const float* b = target_.positions.col(column_of(n_ + k, target_.positions)).data();
  const auto source = [&](Eigen::Index c) { return Row(a + c * stride, count_) - source_origin_[c]; };
  const auto target = [&](Eigen::Index c) { return Row(b + c * stride, count_) - target_origin_[c]; };
  const auto result = [&](Eigen::Index c) { return Eigen::Map<Eigen::ArrayXf>(out + c * stride, count_); };
  result(0) = cos_yaw_ * target(0) + sin_yaw_ * target(2) + offset_.x() - source(0);
  result(1) = target(1) + offset_.y() - source(1);
  result(2) = cos_yaw_ * target(2) - sin_yaw_ * target(0) + offset_.z() - source(2);
  return out;
}

float BlendWindow::square_peak(const WindowWeights& weights, float limit) {
  const int L = (static_cast<int>(weights.alpha.size()) - 3) / 2;
  const Eigen::Index stride = source_.sample_count();
  float peak = 0.0F;
  for (int k = -L; k <= L && peak <= limit; ++k) {
    // The frame before the first or after the last may not be there.
    if ((k == -L && m_ + k < 1) || (k == L && n_ + k + 1 >= target_.frame_count())) continue;
    // Of x = a + alpha d, with d = b - a, the second difference at k.
    const float* alpha = weights.alpha.data() + (k + L + 1);
    const float* before = difference(k - 1);
    const float* at = difference(k);
    const float* after = difference(k + 1);
    const float* own = source_.accelerations.col(m_ + k).data();
    const auto component = [&](Eigen::Index c) {
      const Eigen::Index first = c * stride;
      return Row(own + first, count_) + alpha[-1] * Row(before + first, count_) -
             (2.0F * alpha[0]) * Row(at + first, count_) + alpha[1] * Row(after + first, count_);
    };
    peak = std::max(peak, (component(0).square() + component(1).square() + component(2).square()).maxCoeff());
  }
  return peak;
}

}  // namespace reprise
