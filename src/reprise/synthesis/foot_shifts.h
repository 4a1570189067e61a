// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Where a foot is to go: shifts over the frames of a motion that cancel its slide while it stands.

#pragma once

#include <vector>

#include <Eigen/Core>

namespace reprise {

// Motion of a foot on top of its own: a turn about the vertical through its centre, then a translation.
struct FootShift {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // metres
  double yaw = 0.0;                                       // radians about +Y
};

// The way of a foot before it is shifted, and what its shifts must not do to it.
struct FootCourse {
  std::vector<Eigen::Vector3d> centers;  // F entries, metres
  std::vector<Eigen::Vector3d> hips;     // F entries: where its leg begins
  double longest_leg = 0.0;              // metres from hip to centre
  double largest_acceleration = 0.0;     // metres/frame^2
};

// What the vertices of a foot that are in contact ask of its shifts, between one frame and the next.
class FootDemand {
 public:
  // A vertex that slides over the ground by `slide`, (x, z) in metres, more than it should; `now`, `next`:
  // where it lies in both frames, seen from the foot's centre, (x, z).
  void hold(double weight, const Eigen::Vector2d& slide, const Eigen::Vector2d& now,
            const Eigen::Vector2d& next);
  // A vertex that should be higher in the first frame by `height` metres.
  void lift(double weight, double height);

  bool stands() const { return weight_ > 0.0 || lift_weight_ > 0.0; }

 private:
  friend std::vector<FootShift> solve_foot_shifts(const std::vector<FootDemand>& demands, double foot_radius,
                                                  const FootCourse& foot);

  // Half the gradient and Hessian of the sum of weighted squared slides left, in (x, z, yaw) of both frames.
  Eigen::Matrix<double, 6, 6> H_ = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> g_ = Eigen::Matrix<double, 6, 1>::Zero();
  double weight_ = 0.0;
  double lift_weight_ = 0.0;
  double lift_ = 0.0;  // sum of weight times height
};

// Shifts of F frames, the first and the last zero, that minimise a sum of squares over frames of
//   slides and lifts left (a slide weighs so much that it vanishes),
//   second differences of the shifts: from one stand to the next a foot takes the smoothest course,
//   shifts: back home within some three frames where nothing asks for them,
//   and, in a few rounds of linearisation, what the leg is longer and the acceleration larger than `foot`
//   allows and than they were before,
// a turn counted as the way of a point `foot_radius` from the centre. `demands`: F entries, the last not
// used.
std::vector<FootShift> solve_foot_shifts(const std::vector<FootDemand>& demands, double foot_radius,
                                         const FootCourse& foot);

}  // namespace reprise
