// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/figure/figure_body.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "reprise/core/parallel.h"
#include "reprise/synthetic/figure/figure_surface.h"

namespace reprise::figure {

namespace {

using Eigen::Vector3d;

// ---- Shape: round cones and ellipsoids, blended smoothly. Distances in metres.

double round_cone(const Vector3d& p, const Vector3d& a, double radius_a, const Vector3d& b, double radius_b) {
  const Vector3d axis = b - a;
  const double u = std::clamp((p - a).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
  return (p - a - u * axis).norm() - (radius_a + u * (radius_b - radius_a));
}

double ellipsoid(const Vector3d& p, const Vector3d& center, const Vector3d& radii) {
  const Vector3d scaled = (p - center).cwiseQuotient(radii);
  const double length = scaled.norm();
  const double slope = scaled.cwiseQuotient(radii).norm();
  return slope < 1e-9 ? -radii.minCoeff() : length * (length - 1.0) / slope;
}

// Union with a fillet of about `k` metres.
double blended(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - 0.25 * h * h * k;
}

double intersected(double a, double b, double k) {
  return -blended(-a, -b, k);
}

// A body part wider than deep.
double flattened(Vector3d p, double ratio, const Vector3d& a, double radius_a, const Vector3d& b,
                 double radius_b) {
  p.z() *= ratio;
  return round_cone(p, {a.x(), a.y(), a.z() * ratio}, radius_a, {b.x(), b.y(), b.z() * ratio}, radius_b) /
         (0.5 + 0.5 * ratio);
}

constexpr double hem_height = 0.70;
constexpr double belt_height = 1.05;

struct Distances {
  double torso, tunic, sleeve, arm, leg, shoe, face, hair;

  double clothes() const { return std::min(torso, tunic); }
  double all() const {
    double d = blended(torso, tunic, 0.05);
    d = blended(d, blended(leg, shoe, 0.015), 0.012);
    d = blended(d, blended(sleeve, arm, 0.006), 0.035);
    return blended(d, blended(face, hair, 0.008), 0.02);
  }
};

Distances distances(const Vector3d& point) {
  const Vector3d p(std::abs(point.x()), point.y(), point.z());
  Distances d{};

  d.torso = flattened(p, 1.4, {0, 1.10, -0.005}, 0.128, {0, 1.32, -0.005}, 0.148);
  d.torso = blended(d.torso, round_cone(p, {0, 1.415, -0.01}, 0.062, {0.14, 1.382, -0.008}, 0.06), 0.07);

  // The tunic flares from the belt to the hem and is cut off level.
  const double flare = smooth_ramp(1.12, hem_height - 0.06, p.y());
  const double radius = 0.142 + 0.078 * flare;
  const double side = std::hypot(p.x(), p.z() * 1.22) - radius;
  d.tunic = intersected(side / 1.12, std::max(hem_height - p.y(), p.y() - 1.12), 0.025);

  const Vector3d shoulder = rest_position(upper_arm);
  const Vector3d along = rest_arm_direction(0);
  const Vector3d elbow = rest_position(forearm);
  const Vector3d wrist = rest_position(hand);
  d.sleeve = round_cone(p, shoulder, 0.058, shoulder + 0.15 * along, 0.06);
  d.sleeve = intersected(d.sleeve, (p - shoulder).dot(along) - 0.175, 0.012);
  d.arm = round_cone(p, shoulder, 0.046, elbow, 0.039);
  d.arm = blended(d.arm, round_cone(p, elbow, 0.04, wrist, 0.03), 0.02);
  const Vector3d palm = wrist + 0.055 * along;
  const Vector3d across = along.cross(Vector3d::UnitZ());  // thickness of the hand
  const Vector3d in_hand(1.35 * (p - palm).dot(across), (p - palm).dot(along), (p - palm).z());
  d.arm = blended(d.arm, round_cone(in_hand, {0, -0.012, 0}, 0.037, {0, 0.055, 0.002}, 0.031) / 1.15, 0.025);
  d.arm = blended(d.arm,
                  round_cone(p, palm + Vector3d(0, 0.005, 0.02), 0.017,
                             palm + 0.035 * along + Vector3d(0, 0, 0.052), 0.014),
                  0.012);

  const Vector3d knee = rest_position(shin);
  const Vector3d ankle = rest_position(foot);
  d.leg = round_cone(p, {0.097, 0.80, 0.0}, 0.082, knee, 0.06);
  d.leg = blended(d.leg, round_cone(p, knee, 0.06, ankle + Vector3d(0, 0.045, 0), 0.051), 0.03);
  d.leg = blended(d.leg, round_cone(p, {0.1, 0.36, -0.012}, 0.056, {0.1, 0.30, -0.012}, 0.05), 0.03);

  const double x = ankle.x();
  d.shoe = round_cone(p, {x, 0.048, -0.045}, 0.05, {x, 0.042, 0.09}, 0.048);
  d.shoe = blended(d.shoe, round_cone(p, {x, 0.042, 0.09}, 0.046, {x, 0.036, 0.14}, 0.04), 0.02);
  d.shoe = blended(d.shoe, round_cone(p, {x, 0.05, -0.03}, 0.047, {x, 0.085, -0.022}, 0.046), 0.02);
  d.shoe = intersected(d.shoe, -p.y(), 0.012);

  d.face = round_cone(p, {0, 1.44, -0.012}, 0.049, {0, 1.54, -0.004}, 0.046);
  d.face = blended(d.face, ellipsoid(p, {0, 1.62, 0.008}, {0.096, 0.12, 0.104}), 0.018);
  d.face = blended(d.face, ellipsoid(p, {0, 1.592, 0.11}, {0.014, 0.02, 0.016}), 0.012);
  d.face = blended(d.face, ellipsoid(p, {0.095, 1.61, -0.002}, {0.014, 0.026, 0.018}), 0.008);

  d.hair = ellipsoid(p, {0, 1.634, -0.012}, {0.109, 0.116, 0.118});
  // The hair ends at a slanted line: low at the neck, high above the forehead.
  d.hair = intersected(d.hair, (p - Vector3d(0, 1.61, 0.0)).dot(Vector3d(0, -0.62, 0.78)) - 0.012, 0.012);
  return d;
}

// Face features sit on vertices moved there: (x, y, z) on the surface.
Vector3d on_surface(Vector3d point) {
  for (int i = 0; i < 40; ++i) point.z() -= 0.7 * distances(point).all();
  return point;
}

struct FaceFeatures {
  std::array<Vector3d, 4> eyes{on_surface({0.037, 1.627, 0.13}), on_surface({-0.037, 1.627, 0.13}),
                               on_surface({0.037, 1.615, 0.13}), on_surface({-0.037, 1.615, 0.13})};
  std::array<Vector3d, 4> mouth{on_surface({0.011, 1.557, 0.13}), on_surface({-0.011, 1.557, 0.13}),
                                on_surface({0.031, 1.563, 0.13}), on_surface({-0.031, 1.563, 0.13})};
};

// ---- Colours: each layer shows where it is outermost, with a soft edge.

Vector3d layer_color(const Vector3d& p) {
  const Vector3d skin(238, 190, 158), hair(88, 54, 38), shirt(46, 128, 132), cream(242, 230, 208),
      belt(120, 74, 44), trousers(62, 66, 84), shoe(92, 62, 48), sole(232, 224, 210), hem_band(30, 92, 100);
  const Distances d = distances(p);

  const auto striped = [&](double along, double period) {
    const double wave = std::abs(std::remainder(along, period)) - 0.25 * period;
    return Vector3d(shirt + smooth_ramp(-0.006, 0.006, wave) * (cream - shirt));
  };
  Vector3d top = striped(p.y() - 1.14, 0.09);
  if (p.y() < belt_height) top = shirt;
  top += smooth_ramp(hem_height + 0.055, hem_height + 0.035, p.y()) * (hem_band - top);
  top += smooth_ramp(0.026, 0.018, std::abs(p.y() - belt_height)) * (belt - top);
  const Vector3d q(std::abs(p.x()), p.y(), p.z());
  const Vector3d arm_top = striped((q - rest_position(upper_arm)).dot(rest_arm_direction(0)) - 0.085, 0.09);
  const Vector3d foot_color = sole + smooth_ramp(0.016, 0.024, p.y()) * (shoe - sole);

  Vector3d face = skin;
  // Cheeks.
  face += 0.45 * smooth_ramp(0.035, 0.005, (q - Vector3d(0.056, 1.588, 0.088)).norm()) *
          (Vector3d(232, 140, 120) - face);
  const std::array<std::pair<double, Vector3d>, 7> layers{{{d.clothes(), top},
                                                           {d.sleeve, arm_top},
                                                           {d.arm, skin},
                                                           {d.leg, trousers},
                                                           {d.shoe, foot_color},
                                                           {d.face, face},
                                                           {d.hair, hair}}};
  double outermost = layers[0].first;
  for (const auto& layer : layers) outermost = std::min(outermost, layer.first);
  Vector3d sum = Vector3d::Zero();
  double weight_sum = 0.0;
  for (const auto& [distance, color] : layers) {
    const double weight = std::exp(-(distance - outermost) / 0.0015);
    sum += weight * color;
    weight_sum += weight;
  }
  return sum / weight_sum;
}

// Averaged over the part of the surface that a vertex stands for, so that edges of colours are smooth rather
// than jagged.
Vector3d color_at(const Vector3d& p, const FaceFeatures& features, double voxel_size) {
  for (const Vector3d& eye : features.eyes) {
    if ((p - eye).norm() < 0.009) return {50, 36, 34};
  }
  for (const Vector3d& lip : features.mouth) {
    if ((p - lip).norm() < 0.007) return {206, 118, 104};
  }
  Vector3d sum = 2.0 * layer_color(p);
  double samples = 2.0;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        sum += layer_color(p + 0.45 * voxel_size * Vector3d(x, y, z).normalized());
        samples += 1.0;
      }
    }
  }
  return sum / samples;
}

// ---- Weights.

using DenseWeights = std::array<double, joint_count>;

DenseWeights weights_at(const Vector3d& p) {
  const Distances d = distances(p);
  DenseWeights w{};

  const double above_waist = smooth_ramp(1.00, 1.15, p.y());
  const double above_chest = smooth_ramp(1.13, 1.29, p.y());
  const double above_neck =
      smooth_ramp(1.43, 1.485, p.y()) * smooth_ramp(0.10, 0.07, std::hypot(p.x(), p.z()));
  const double above_jaw = smooth_ramp(1.49, 1.55, p.y());
  const bool in_head = p.y() > 1.5;
  const double on_neck = in_head ? 1.0 : above_neck;
  w[pelvis] = 1.0 - above_waist;
  w[spine] = above_waist * (1.0 - above_chest);
  w[chest] = above_waist * above_chest * (1.0 - on_neck);
  w[neck] = above_waist * above_chest * on_neck * (1.0 - above_jaw);
  w[head] = above_waist * above_chest * on_neck * above_jaw;

  const auto shift = [&](double share, std::initializer_list<std::pair<int, double>> to) {
    for (double& weight : w) weight *= 1.0 - share;
    for (const auto& [joint, part] : to) w[joint] += share * part;
  };

  // Cloth below the hips follows both thighs, so that a striding leg carries it along.
  const double left = smooth_ramp(-0.13, 0.13, p.x());
  const double skirt = smooth_ramp(0.99, hem_height, p.y());
  if (p.y() < 1.0) shift(0.8 * skirt, {{thigh, left}, {thigh + side_joints, 1.0 - left}});

  const int side = p.x() >= 0.0 ? 0 : 1;
  const Vector3d q(std::abs(p.x()), p.y(), p.z());
  const double leg_distance = std::min(d.leg, d.shoe);
  const double arm_distance = std::min(d.sleeve, d.arm);

  const double on_leg = smooth_ramp(-0.01, 0.015, d.clothes() - leg_distance);
  const double below_knee = smooth_ramp(0.065, -0.065, q.y() - rest_position(shin).y());
  const double below_ankle = smooth_ramp(0.035, -0.02, q.y() - rest_position(foot).y());
  const double past_ball = smooth_ramp(-0.02, 0.02, q.z() - rest_position(toe).z());
  shift(on_leg, {{sided(thigh, side), 1.0 - below_knee},
                 {sided(shin, side), below_knee * (1.0 - below_ankle)},
                 {sided(foot, side), below_knee * below_ankle * (1.0 - past_ball)},
                 {sided(toe, side), below_knee * below_ankle * past_ball}});

  const double along = (q - rest_position(upper_arm)).dot(rest_arm_direction(0));
  const double on_arm = smooth_ramp(-0.03, 0.03, std::min(d.clothes(), leg_distance) - arm_distance) *
                        smooth_ramp(-0.06, 0.075, along) * (p.y() < 1.5 ? 1.0 : 0.0);
  const double to_elbow = (rest_position(forearm) - rest_position(upper_arm)).norm();
  const double to_wrist = (rest_position(hand) - rest_position(upper_arm)).norm();
  const double past_elbow = smooth_ramp(-0.05, 0.05, along - to_elbow);
  const double past_wrist = smooth_ramp(-0.03, 0.03, along - to_wrist);
  shift(on_arm, {{sided(upper_arm, side), 1.0 - past_elbow},
                 {sided(forearm, side), past_elbow * (1.0 - past_wrist)},
                 {sided(hand, side), past_elbow * past_wrist}});
  return w;
}

std::vector<std::vector<std::int32_t>> neighbors_of(const Topology& topology) {
  std::vector<std::set<std::int32_t>> sets(topology.vertex_count);
  for (const Triangle& t : topology.triangles) {
    for (int k = 0; k < 3; ++k) {
      sets[t[k]].insert(t[(k + 1) % 3]);
      sets[t[(k + 1) % 3]].insert(t[k]);
    }
  }
  std::vector<std::vector<std::int32_t>> result;
  for (const auto& set : sets) result.emplace_back(set.begin(), set.end());
  return result;
}

VertexBinding strongest(const DenseWeights& weights) {
  std::array<int, joint_count> order{};
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return weights[a] > weights[b]; });
  VertexBinding binding;
  double sum = 0.0;
  for (int k = 0; k < weights_per_vertex; ++k) sum += weights[order[k]];
  for (int k = 0; k < weights_per_vertex; ++k) {
    binding.joints[k] = order[k];
    binding.weights[k] = weights[order[k]] / sum;
  }
  return binding;
}

}  // namespace

Body make_body(double voxel_size) {
  const FaceFeatures features;
  std::vector<Vector3d> pins(features.eyes.begin(), features.eyes.end());
  pins.insert(pins.end(), features.mouth.begin(), features.mouth.end());
  Surface surface =
      surface_from_distance([](const Vector3d& p) { return distances(p).all(); },
                            {Vector3d(-0.75, -0.06, -0.3), Vector3d(0.75, 1.82, 0.35)}, voxel_size, pins);

  Body body;
  Topology topology;
  topology.vertex_count = static_cast<std::int32_t>(surface.points.size());
  topology.triangles = std::move(surface.triangles);
  body.points = std::move(surface.points);

  const std::size_t count = body.points.size();
  std::vector<DenseWeights> weights(count);
  body.colors.resize(count);
  body.hem.resize(count);
  body.hem_angle.resize(count);
  parallel_for(
      0, count,
      [&](std::size_t i) {
        const Vector3d& p = body.points[i];
        const Vector3d color = color_at(p, features, voxel_size);
        for (int k = 0; k < 3; ++k) body.colors[i][k] = static_cast<std::uint8_t>(std::lround(color[k]));
        weights[i] = weights_at(p);
        const Distances d = distances(p);
        const double on_cloth =
            smooth_ramp(0.004, -0.004, d.tunic - std::min({d.leg, d.arm, d.sleeve, d.shoe}));
        const double depth = smooth_ramp(belt_height - 0.03, hem_height, p.y());
        body.hem[i] = on_cloth * depth * depth;
        body.hem_angle[i] = std::atan2(p.x(), p.z());
      },
      64);

  // Parts meet in a crease of weights; a few averages make it round. Both values of a step are kept apart, so
  // that the order of vertices has no say.
  const std::vector<std::vector<std::int32_t>> neighbors = neighbors_of(topology);
  const int steps = static_cast<int>(std::lround(4.0 * std::pow(0.02 / voxel_size, 2.0)));
  for (int step = 0; step < std::clamp(steps, 1, 40); ++step) {
    std::vector<DenseWeights> averaged = weights;
    for (std::size_t i = 0; i < count; ++i) {
      // The sole keeps its sharp split at the ball of the foot: a planted foot must not creep.
      if (body.points[i].y() < 0.06) continue;
      for (int j = 0; j < joint_count; ++j) {
        double sum = 0.0;
        for (const std::int32_t other : neighbors[i]) sum += weights[other][j];
        averaged[i][j] = 0.5 * weights[i][j] + 0.5 * sum / static_cast<double>(neighbors[i].size());
      }
    }
    weights = std::move(averaged);
  }
  for (const DenseWeights& w : weights) body.bindings.push_back(strongest(w));
  body.topology = std::make_shared<const Topology>(std::move(topology));
  return body;
}

}  // namespace reprise::figure
