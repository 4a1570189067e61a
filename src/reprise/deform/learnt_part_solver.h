// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// One part within its learnt space (LPBM Eq. 7, HSSMG Eq. 32). Internal to `PartEditor`.
//
// For one frame s and constraints C with targets c and weights W,
//   f(x, r, Q) = |L x - (delta_s + E r) Q^T|^2 + |W (x - c)|^2 + (r - r')^T P (r - r'),
// Q the rotation from the reference's frame, in which spaces are learnt, to the world. With x = x' Q^T and
// A = L^T L + W^2, the best x' is A^-1 (L^T (delta_s + E r) + W^2 c Q): x is eliminated and
//   f(r, Q) = r^T (S + P) r + 2 r^T h - 2 <B_0 + sum_k r_k B_k, Q> + constant
// is left, with the Schur complement S = E^T (1 - L A^-1 L^T) E, h = E^T (1 - L A^-1 L^T) delta_s, and the
// 3 x 3 matrices B_k = (W^2 c)^T A^-1 L^T E_k (B_0: delta_s instead), which need only the constrained rows of
// what is kept. So a drag costs a problem of l + 3 unknowns and one back-substitution.

#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Cholesky>

#include "reprise/database/learnt_model.h"
#include "reprise/deform/part_editor.h"
#include "reprise/deform/surface_laplacian.h"
#include "reprise/deform/vertex_turning.h"
#include "reprise/linalg/sparse_cholesky.h"

namespace reprise {

// A constraint in a part's own vertices. Squared weights, 1/m^2.
struct PartConstraint {
  std::int32_t local = 0;
  double squared_weight = 0.0;
  bool operator==(const PartConstraint&) const = default;
};

class LearntPartSolver {
 public:
  LearntPartSolver(const PartHierarchy::Part& part, const Positions& whole_reference,
                   const LearntPart& learnt, const PartEditorOptions& options);

  // What of a frame does not depend on the constraints.
  struct Frame {
    Eigen::Matrix3d world_from_reference = Eigen::Matrix3d::Identity();
    Coordinates aligned;           // n x 3: the part in the reference's frame
    Coordinates delta;             // rows x 3: delta_s
    Coordinates Lt_delta;          // n x 3: L^T delta_s, in the reference's frame
    double squared_delta = 0.0;    // |delta_s|^2
    Eigen::VectorXd Et_delta;      // l
    Eigen::VectorXd coefficients;  // l, of the frame in the learnt space
  };
  Frame frame(const Coordinates& positions) const;

  // What is kept with a set of constraints: all but the targets.
  struct Factorization {
    std::vector<PartConstraint> constraints;
    SparseCholesky A;
    Eigen::MatrixXd Z;  // 3n x l: A^-1 L^T E, as `basis_` is laid out
    Eigen::MatrixXd S;  // l x l, with the prior P
    Eigen::LLT<Eigen::MatrixXd> S_factor;
  };
  Factorization factorize(std::vector<PartConstraint> constraints) const;

  // What is kept with constraints and frame.
  struct Prepared {
    Coordinates X;      // n x 3: A^-1 L^T delta_s
    Eigen::VectorXd h;  // l
  };
  Prepared prepare(const Factorization& factorization, const Frame& frame) const;

  struct Solution {
    Coordinates positions;                                               // n x 3, world
    Eigen::VectorXd changes;                                             // r
    Eigen::Matrix3d world_from_reference = Eigen::Matrix3d::Identity();  // Q
    int iterations = 0;
  };
  // `targets`: one a constraint, in the same order. `turn`: world rotation against the frame that is taken
  // where the constraints leave it open. `preferred`: r' of the prior, or empty for 0.
  Solution solve(const Factorization& factorization, const Frame& frame, const Prepared& prepared,
                 std::span<const Eigen::Vector3d> targets, const Eigen::Matrix3d& turn,
                 const Eigen::VectorXd& preferred) const;

  Eigen::Index component_count() const { return basis_.cols(); }

 private:
  struct Reduced;
  struct Box;
  // The best r and Q of a reduced problem, from the given r; its iterations.
  int minimise(const Factorization& factorization, const Reduced& reduced, const Box& limits,
               Eigen::Matrix3d& Q, Eigen::VectorXd& r) const;
  // Laplacian coordinates that turn with the surface where it turned farther than `free_turn`, less delta_s +
  // E r; false if none did. `positions`: n x 3, in the reference's frame.
  bool turn_along(const Frame& frame, const Coordinates& positions, const Eigen::VectorXd& r,
                  std::vector<Eigen::Quaterniond>& rotations, Coordinates& correction) const;
  Box box(const Frame& frame) const;
  static std::vector<Eigen::Index> solve_within(const Eigen::MatrixXd& S, const Eigen::VectorXd& b,
                                                const Box& box, Eigen::VectorXd& r);
  static std::optional<Eigen::Vector3d> newton_step(const Factorization& factorization,
                                                    const Reduced& reduced, const Eigen::Matrix3d& Q,
                                                    const Eigen::Matrix3d& pull,
                                                    const std::vector<Eigen::Index>& free);

  const PartEditorOptions* options_;
  Coordinates reference_;  // n x 3
  SurfaceLaplacian laplacian_;
  Eigen::SparseMatrix<double> LtL_;
  Eigen::VectorXd mean_;
  Eigen::MatrixXd basis_;   // 3n x l: E
  Eigen::MatrixXd EtE_;     // identity up to the rounding of stored floats
  Eigen::MatrixXd LtE_;     // 3n x l
  Eigen::MatrixXd shapes_;  // 3n x l: displacements whose Laplacian coordinates are E
  VertexTurning turning_;
  Eigen::VectorXd least_, greatest_;
  Eigen::VectorXd prior_;  // l: diagonal of P
};

}  // namespace reprise
