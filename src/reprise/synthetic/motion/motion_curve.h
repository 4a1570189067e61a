// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Smooth functions of time and of the gait phase, from which motions are made.

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace reprise::motion {

// 0 below 0, 1 above 1, between them a quintic with no velocity and no acceleration at either end.
double smooth_step(double u);
// smooth_step from `begin` to `end`.
double ramp(double begin, double end, double value);
// 64 u^3 (1 - u)^3: 0 at 0 and 1 with two vanishing derivatives, 1 in the middle. 0 outside.
double bump(double u);

struct Key {
  double time;
  double value;
};

// A function on a grid of `rate` samples a second from `first_time` on, read between samples by cubic
// interpolation, constant before and after.
class SampledCurve {
 public:
  static constexpr double rate = 200.0;

  SampledCurve() = default;
  SampledCurve(double first_time, std::vector<double> samples);

  double operator()(double time) const;
  bool empty() const { return samples_.empty(); }

 private:
  double first_time_ = 0.0;
  std::vector<double> samples_;
};

// Convolution with a Gaussian of `sigma` seconds; the ends are continued by their values.
std::vector<double> smoothed(std::span<const double> samples, double sigma);

// Through the keys without overshooting (monotone cubic, Fritsch and Carlson), then smoothed: keys are where
// a motion goes, extremes are rounded off.
class Curve {
 public:
  Curve() = default;
  // Times ascend. `smoothing`: sigma, seconds.
  explicit Curve(std::vector<Key> keys, double smoothing = 0.04);

  double operator()(double time) const { return curve_(time); }
  bool empty() const { return curve_.empty(); }

 private:
  SampledCurve curve_;
};

// Periodic in 1: the Fourier series of values at phase 0, 1/N, 2/N, ... up to `harmonics`. Gait data are
// given like this; six harmonics hold them (Winter 2009, 2.2).
class PhaseCurve {
 public:
  PhaseCurve(std::span<const double> values, int harmonics);

  double operator()(double phase) const;

 private:
  double mean_ = 0.0;
  std::vector<double> cosine_, sine_;
};

// Smooth noise of mean 0 and variance about 1 that repeats after `period` seconds, from harmonics up to
// `highest` hertz (but always at least one): the small movements of a living body.
class SmoothNoise {
 public:
  SmoothNoise(std::uint64_t seed, double period, double highest = 0.6);

  double operator()(double time) const;

 private:
  double period_;
  std::vector<double> amplitude_, phase_;
};

// Quintic with given value, velocity and acceleration (per unit of u) at u = 0 and at u = 1.
template <typename Value>
Value quintic(const Value& p0, const Value& v0, const Value& a0, const Value& p1, const Value& v1,
              const Value& a1, double u) {
  const double u2 = u * u, u3 = u2 * u, u4 = u3 * u, u5 = u4 * u;
  return (1 - 10 * u3 + 15 * u4 - 6 * u5) * p0 + (u - 6 * u3 + 8 * u4 - 3 * u5) * v0 +
         (0.5 * u2 - 1.5 * u3 + 1.5 * u4 - 0.5 * u5) * a0 + (10 * u3 - 15 * u4 + 6 * u5) * p1 +
         (-4 * u3 + 7 * u4 - 3 * u5) * v1 + (0.5 * u3 - u4 + 0.5 * u5) * a1;
}

inline double lerp(double a, double b, double u) {
  return a + u * (b - a);
}

}  // namespace reprise::motion
