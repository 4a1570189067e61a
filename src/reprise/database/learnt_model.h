// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What was learnt of how the parts of a performer deform (LPBM IV.A, HSSMG Eq. 33 and 34), as it is stored.

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "reprise/database/markup.h"

namespace reprise {

// The space of surface deformation of one part: delta(r) = mean + basis r. Laplacian coordinates are those of
// `SurfaceLaplacian` on the part, after the example was brought onto the model's reference by the rigid
// motion that fits best: per vertex of the part x, y, z, one vertex after the other.
struct LearntPart {
  BodyPart part;          // its parent is an index into the model's parts
  Eigen::VectorXf mean;   // 3n
  Eigen::MatrixXf basis;  // 3n x l, orthonormal columns
  // Over the examples, l entries each: standard deviation, least and greatest value of the coefficients.
  Eigen::VectorXd deviations, least, greatest;
  // Mean squared length of what the basis leaves out of an example, and of the centred examples.
  double discarded_variance = 0.0;
  double total_variance = 0.0;
  std::vector<std::string> examples;  // frames as "CLIP:FRAME", in the order chosen

  Eigen::Index component_count() const { return basis.cols(); }
  // Share of the variance that the basis keeps, 0 to 1; 1 if there is none.
  double kept_variance() const;
};

struct LearntModel {
  Positions reference;            // N x 3, metres: the surface on which operators and alignments are defined
  std::vector<LearntPart> parts;  // the root first, parents before children
};

// The same performer as parts and as one part (LPBM Figure 2); each may be missing (no parts).
struct LearntModels {
  LearntModel part, whole;

  bool empty() const { return part.parts.empty() && whole.parts.empty(); }
};

// Throws `InvalidArgument` naming the part: sizes that do not fit together or the vertex count, values that
// are not finite, a basis that is not orthonormal, no part, no example, what `validate` finds wrong with the
// parts.
void validate(const LearntModel& model, std::int32_t vertex_count);

// The same for both, which may be missing; the whole body must be one part.
void validate(const LearntModels& models, std::int32_t vertex_count);

}  // namespace reprise
