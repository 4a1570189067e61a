// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/figure/figure_skin.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace reprise::figure {

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double spring_frequency = 2.1;  // Hz
constexpr double spring_damping = 0.45;   // of critical
constexpr double longest_step = 0.01;     // seconds
constexpr double warm_up = 1.5;           // seconds before the first frame
constexpr double neighbor_pull = 0.5;     // of the spring: cloth holds together
constexpr double largest_swing = 0.07;    // metres
constexpr double largest_inward = 0.012;  // metres: the legs are inside

double angle_of_weight(int i) {
  return 2.0 * std::numbers::pi * i / Hem::weight_count;
}

// About `value` when small, never more than `limit`.
double limited(double value, double limit) {
  return limit * std::tanh(value / limit);
}

}  // namespace

Skin::Skin(const Body& body, const Pose& pose) : body_(body) {
  for (int j = 0; j < joint_count; ++j) {
    const Quaterniond& q = pose.rotation[j];
    const Vector3d t = pose.position[j] - q * rest_position(j);
    rotation_[j] = q;
    dual_[j].coeffs() = 0.5 * (Quaterniond(0.0, t.x(), t.y(), t.z()) * q).coeffs();
  }
}

Vector3d Skin::operator()(std::size_t vertex) const {
  const VertexBinding& binding = body_.bindings[vertex];
  const Quaterniond& first = rotation_[binding.joints[0]];
  Eigen::Vector4d real = Eigen::Vector4d::Zero();
  Eigen::Vector4d dual = Eigen::Vector4d::Zero();
  for (int k = 0; k < weights_per_vertex; ++k) {
    const int j = binding.joints[k];
    // A rotation has two quaternions: take the one on the side of the strongest joint.
    const double weight = rotation_[j].dot(first) < 0.0 ? -binding.weights[k] : binding.weights[k];
    real += weight * rotation_[j].coeffs();
    dual += weight * dual_[j].coeffs();
  }
  const double norm = real.norm();
  const Quaterniond q(Eigen::Vector4d(real / norm));
  const Quaterniond d(Eigen::Vector4d(dual / norm));
  return q * body_.points[vertex] + 2.0 * (d * q.conjugate()).vec();
}

std::vector<Hem::Displacements> Hem::simulate(const Body& body, const Motion& motion, std::size_t frame_count,
                                              double frames_per_second) {
  // The skin holds each weight where it holds the vertex of the hem in the weight's direction.
  std::array<std::size_t, weight_count> holders{};
  for (int i = 0; i < weight_count; ++i) {
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t v = 0; v < body.points.size(); ++v) {
      const double turn =
          std::abs(std::remainder(body.hem_angle[v] - angle_of_weight(i), 2.0 * std::numbers::pi));
      const double from_hem = 1.0 - body.hem[v];
      // The rim, not the underside: the farther from the axis the better.
      const double score = turn + 4.0 * from_hem - std::hypot(body.points[v].x(), body.points[v].z());
      if (score < best) {
        best = score;
        holders[i] = v;
      }
    }
  }

  const int substeps = static_cast<int>(std::ceil(1.0 / (frames_per_second * longest_step) - 1e-9));
  const double dt = 1.0 / (frames_per_second * substeps);
  const int first_step = -static_cast<int>(std::ceil(warm_up / dt));
  const double omega = 2.0 * std::numbers::pi * spring_frequency;

  std::array<Vector3d, weight_count> position{}, velocity{}, target{};
  std::vector<Displacements> result(frame_count);
  const int last_step = static_cast<int>(frame_count - 1) * substeps;
  for (int step = first_step; step <= last_step; ++step) {
    const double time = step * dt;
    const Pose pose = motion.pose(time);
    const Skin skin(body, pose);
    const Vector3d air = motion.path_velocity(time);
    for (int i = 0; i < weight_count; ++i) target[i] = skin(holders[i]);
    if (step == first_step) {
      position = target;
      velocity.fill(air);
    }
    std::array<Vector3d, weight_count> offset;
    for (int i = 0; i < weight_count; ++i) offset[i] = position[i] - target[i];
    for (int i = 0; i < weight_count; ++i) {
      const Vector3d beside =
          0.5 * (offset[(i + 1) % weight_count] + offset[(i + weight_count - 1) % weight_count]);
      const Vector3d pull = -omega * omega * (offset[i] + neighbor_pull * (offset[i] - beside));
      velocity[i] += dt * (pull - 2.0 * spring_damping * omega * (velocity[i] - air));
      position[i] += dt * velocity[i];
    }
    if (step < 0 || step % substeps != 0) continue;
    Displacements& shown = result[static_cast<std::size_t>(step / substeps)];
    for (int i = 0; i < weight_count; ++i) {
      const Vector3d outward =
          pose.rotation[pelvis] * Vector3d(std::sin(angle_of_weight(i)), 0.0, std::cos(angle_of_weight(i)));
      Vector3d d = offset[i];
      const double out = d.dot(outward);
      if (out < 0.0) d += (-limited(-out, largest_inward) - out) * outward;
      const double length = d.norm();
      shown[i] = length > 0.0 ? Vector3d(d * (limited(length, largest_swing) / length)) : Vector3d::Zero();
    }
  }
  return result;
}

Vector3d Hem::displacement(const Body& body, const Displacements& displacements, std::size_t vertex) {
  if (body.hem[vertex] <= 0.0) return Vector3d::Zero();
  const double full = 2.0 * std::numbers::pi;
  const double at = (body.hem_angle[vertex] < 0.0 ? body.hem_angle[vertex] + full : body.hem_angle[vertex]) *
                    weight_count / full;
  const int i = static_cast<int>(at);
  const double u = at - i;
  return body.hem[vertex] *
         ((1.0 - u) * displacements[i % weight_count] + u * displacements[(i + 1) % weight_count]);
}

}  // namespace reprise::figure
