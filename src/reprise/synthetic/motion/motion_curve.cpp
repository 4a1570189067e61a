// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/motion/motion_curve.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reprise/core/random.h"

namespace reprise::motion {

namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

// Slopes of the monotone cubic through the keys.
std::vector<double> monotone_slopes(const std::vector<Key>& keys) {
  const std::size_t n = keys.size();
  std::vector<double> slopes(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double h0 = keys[i].time - keys[i - 1].time;
    const double h1 = keys[i + 1].time - keys[i].time;
    const double d0 = (keys[i].value - keys[i - 1].value) / h0;
    const double d1 = (keys[i + 1].value - keys[i].value) / h1;
    if (d0 * d1 <= 0.0) continue;  // an extreme: no slope, so no overshooting
    const double w0 = 2.0 * h1 + h0;
    const double w1 = h1 + 2.0 * h0;
    slopes[i] = (w0 + w1) / (w0 / d0 + w1 / d1);
  }
  return slopes;
}

double cubic(const Key& a, double slope_a, const Key& b, double slope_b, double time) {
  const double h = b.time - a.time;
  const double u = (time - a.time) / h;
  const double u2 = u * u, u3 = u2 * u;
  return (2 * u3 - 3 * u2 + 1) * a.value + (u3 - 2 * u2 + u) * h * slope_a + (3 * u2 - 2 * u3) * b.value +
         (u3 - u2) * h * slope_b;
}

}  // namespace

double smooth_step(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * u * (10.0 + u * (-15.0 + 6.0 * u));
}

double ramp(double begin, double end, double value) {
  return smooth_step((value - begin) / (end - begin));
}

double bump(double u) {
  if (u <= 0.0 || u >= 1.0) return 0.0;
  const double v = 4.0 * u * (1.0 - u);
  return v * v * v;
}

SampledCurve::SampledCurve(double first_time, std::vector<double> samples)
    : first_time_(first_time), samples_(std::move(samples)) {}

double SampledCurve::operator()(double time) const {
  const auto last = static_cast<std::ptrdiff_t>(samples_.size()) - 1;
  const double at = std::clamp((time - first_time_) * rate, 0.0, static_cast<double>(last));
  const auto i = std::min(static_cast<std::ptrdiff_t>(at), std::max<std::ptrdiff_t>(last - 1, 0));
  const double u = at - static_cast<double>(i);
  const auto sample = [&](std::ptrdiff_t k) {
    return samples_[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, last))];
  };
  const double a = sample(i - 1), b = sample(i), c = sample(i + 1), d = sample(i + 2);
  return b + 0.5 * u * (c - a + u * (2 * a - 5 * b + 4 * c - d + u * (3 * (b - c) + d - a)));
}

std::vector<double> smoothed(std::span<const double> samples, double sigma) {
  const int reach = static_cast<int>(std::ceil(4.0 * sigma * SampledCurve::rate));
  if (reach < 1) return {samples.begin(), samples.end()};
  std::vector<double> kernel(static_cast<std::size_t>(2 * reach + 1));
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    const double x = k / (sigma * SampledCurve::rate);
    sum += kernel[static_cast<std::size_t>(k + reach)] = std::exp(-0.5 * x * x);
  }
  const int last = static_cast<int>(samples.size()) - 1;
  std::vector<double> result(samples.size());
  for (int i = 0; i <= last; ++i) {
    double value = 0.0;
    for (int k = -reach; k <= reach; ++k)
      value += kernel[static_cast<std::size_t>(k + reach)] *
               samples[static_cast<std::size_t>(std::clamp(i + k, 0, last))];
    result[static_cast<std::size_t>(i)] = value / sum;
  }
  return result;
}

Curve::Curve(std::vector<Key> keys, double smoothing) {
  const double margin = 4.0 * smoothing;
  const double first = keys.front().time - margin;
  const auto count =
      static_cast<std::size_t>(std::ceil((keys.back().time + margin - first) * SampledCurve::rate) + 1.0);
  const std::vector<double> slopes = monotone_slopes(keys);
  std::vector<double> samples(count);
  std::size_t i = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double time = first + static_cast<double>(k) / SampledCurve::rate;
    while (i + 2 < keys.size() && keys[i + 1].time <= time) ++i;
    if (time <= keys.front().time || keys.size() == 1) {
      samples[k] = keys.front().value;
    } else if (time >= keys.back().time) {
      samples[k] = keys.back().value;
    } else {
      samples[k] = cubic(keys[i], slopes[i], keys[i + 1], slopes[i + 1], time);
    }
  }
  curve_ = SampledCurve(first, smoothed(samples, smoothing));
}

PhaseCurve::PhaseCurve(std::span<const double> values, int harmonics) {
  const auto n = static_cast<double>(values.size());
  for (const double value : values) mean_ += value / n;
  for (int h = 1; h <= harmonics; ++h) {
    double cosine = 0.0, sine = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double angle = two_pi * h * static_cast<double>(k) / n;
      cosine += 2.0 / n * values[k] * std::cos(angle);
      sine += 2.0 / n * values[k] * std::sin(angle);
    }
    cosine_.push_back(cosine);
    sine_.push_back(sine);
  }
}

double PhaseCurve::operator()(double phase) const {
  double value = mean_;
  for (std::size_t h = 0; h < cosine_.size(); ++h) {
    const double angle = two_pi * static_cast<double>(h + 1) * phase;
    value += cosine_[h] * std::cos(angle) + sine_[h] * std::sin(angle);
  }
  return value;
}

SmoothNoise::SmoothNoise(std::uint64_t seed, double period, double highest) : period_(period) {
  const RandomField random(seed);
  const auto harmonics = static_cast<std::uint64_t>(std::max(1.0, highest * period));
  double power = 0.0;
  for (std::uint64_t h = 1; h <= harmonics; ++h) {
    amplitude_.push_back((0.6 + 0.8 * random.uniform(0, h)) / std::sqrt(h));
    phase_.push_back(two_pi * random.uniform(1, h));
    power += 0.5 * amplitude_.back() * amplitude_.back();
  }
  for (double& amplitude : amplitude_) amplitude /= std::sqrt(power);
}

double SmoothNoise::operator()(double time) const {
  double value = 0.0;
  for (std::size_t h = 0; h < amplitude_.size(); ++h)
    value += amplitude_[h] * std::sin(two_pi * static_cast<double>(h + 1) * time / period_ + phase_[h]);
  return value;
}

}  // namespace reprise::motion
