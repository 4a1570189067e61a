// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/retarget/foot_contacts.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace reprise::retargeting {

using Eigen::Vector3d;

namespace {

constexpr double low_share = 0.05;  // of the frames: what is lower is noise

double quantile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double floor_of(const std::vector<Vector3d>& points) {
  std::vector<double> heights;
  for (const Vector3d& point : points) heights.push_back(point.y());
  return quantile(std::move(heights), low_share);
}

// Weighted mean over neighbours, with a standard deviation in frames; the ends count more often.
template <typename Value>
std::vector<Value> smoothed(const std::vector<Value>& values, double deviation) {
  const int reach = static_cast<int>(std::ceil(3.0 * deviation));
  if (reach < 1) return values;
  const int last = static_cast<int>(values.size()) - 1;
  std::vector<Value> result(values);
  for (int f = 0; f <= last; ++f) {
    Value sum = values[static_cast<std::size_t>(f)];
    double weights = 1.0;
    for (int k = 1; k <= reach; ++k) {
      const double weight = std::exp(-0.5 * k * k / (deviation * deviation));
      sum += weight * values[static_cast<std::size_t>(std::max(0, f - k))];
      sum += weight * values[static_cast<std::size_t>(std::min(last, f + k))];
      weights += 2.0 * weight;
    }
    result[static_cast<std::size_t>(f)] = sum / weights;
  }
  return result;
}

struct Point {
  std::vector<Vector3d> places;
  double floor = 0.0;
  double frames_per_second = 0.0;

  double height(std::size_t f) const { return places[f].y() - floor; }
  double speed(std::size_t f) const {
    const std::size_t before = f == 0 ? 0 : f - 1;
    const std::size_t after = std::min(f + 1, places.size() - 1);
    if (after == before) return 0.0;
    return (places[after] - places[before]).norm() * frames_per_second / static_cast<double>(after - before);
  }
};

// Runs of equal flags shorter than `shortest` that have neighbours on both sides take the neighbours' value.
void drop_short_runs(std::vector<bool>& flags, bool value, std::size_t shortest) {
  for (std::size_t begin = 0; begin < flags.size();) {
    std::size_t end = begin;
    while (end < flags.size() && flags[end] == flags[begin]) ++end;
    if (flags[begin] == value && end - begin < shortest && begin > 0 && end < flags.size()) {
      std::fill(flags.begin() + static_cast<std::ptrdiff_t>(begin),
                flags.begin() + static_cast<std::ptrdiff_t>(end), !value);
    }
    begin = end;
  }
}

}  // namespace

double standing_ankle_height(const FootTrack& track) {
  return floor_of(track.ankle);
}

Eigen::Vector2d ground_slope(const std::array<FootTrack, 2>& tracks, double frames_per_second) {
  constexpr double still = 0.25;     // m/s
  constexpr double low = 0.25;       // metres over the lowest
  constexpr double steepest = 0.06;  // what calibration gets wrong
  constexpr double spread = 0.15;    // metres: a slope is believed where the feet travel clearly farther
  // Heights of toes that stand: y = offset of the side + slope x + slope z, by least squares.
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  Eigen::Vector4d b = Eigen::Vector4d::Zero();
  double samples = 0.0;
  const Vector3d origin = tracks[0].toe.front();
  for (const int side : {0, 1}) {
    const FootTrack& track = tracks[static_cast<std::size_t>(side)];
    const Point toe{track.toe, floor_of(track.toe), frames_per_second};
    for (std::size_t f = 1; f + 1 < track.toe.size(); ++f) {
      if (toe.speed(f) > still || toe.height(f) > low) continue;
      const Vector3d place = track.toe[f] - origin;
      const Eigen::Vector4d row(side == 0 ? 1.0 : 0.0, side == 1 ? 1.0 : 0.0, place.x(), place.z());
      A += row * row.transpose();
      b += place.y() * row;
      samples += 1.0;
    }
  }
  if (samples < 2.0) return Eigen::Vector2d::Zero();
  constexpr double tiny = 1e-9;  // one foot may never stand
  A.diagonal() += Eigen::Vector4d(tiny, tiny, spread * spread * samples, spread * spread * samples);
  const Eigen::Vector4d x = A.ldlt().solve(b);
  const Eigen::Vector2d slope(x[2], x[3]);
  return slope.norm() < steepest ? slope : Eigen::Vector2d::Zero();
}

std::vector<bool> detect_contacts(const FootTrack& track, double frames_per_second) {
  constexpr double smoothing = 0.012;                        // seconds
  constexpr double enter_speed = 0.6, leave_speed = 1.0;     // m/s
  constexpr double ankle_enter = 0.04, ankle_leave = 0.055;  // metres over the lowest
  constexpr double toe_enter = 0.03, toe_leave = 0.05;
  constexpr double shortest_contact = 0.07, shortest_gap = 0.07;  // seconds
  const auto point = [&](const std::vector<Vector3d>& places) {
    return Point{smoothed(places, smoothing * frames_per_second), floor_of(places), frames_per_second};
  };
  const Point ankle = point(track.ankle), toe = point(track.toe);
  std::vector<bool> contacts(track.ankle.size());
  bool is_down = false;
  for (std::size_t f = 0; f < contacts.size(); ++f) {
    const double speed = is_down ? leave_speed : enter_speed;
    is_down = (toe.height(f) < (is_down ? toe_leave : toe_enter) && toe.speed(f) < speed) ||
              (ankle.height(f) < (is_down ? ankle_leave : ankle_enter) && ankle.speed(f) < speed);
    contacts[f] = is_down;
  }
  drop_short_runs(contacts, false, static_cast<std::size_t>(std::lround(shortest_gap * frames_per_second)));
  drop_short_runs(contacts, true,
                  static_cast<std::size_t>(std::lround(shortest_contact * frames_per_second)));
  return contacts;
}

}  // namespace reprise::retargeting
