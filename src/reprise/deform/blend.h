// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Non-linear blending of two frames (HSSMG 4.4, Eq. 6).

#pragma once

#include "reprise/deform/gradient_field.h"

namespace reprise {

// G(M_s, M_t, alpha): per triangle, the rotation goes along the shortest arc from source to target and the
// stretch linearly; the Poisson system links the triangles; each connected component's centroid goes
// linearly. alpha = 0 gives back the source and alpha = 1 the target, to solver precision.
//
// `source`, `target`: N x 3 positions in one ground frame (align before). Rotations of a triangle between the
// two beyond 180 degrees are taken the short way round; at 180 degrees itself rounding decides per triangle.
// `blended` may be one of the inputs. Throws `InvalidArgument` if shapes differ or alpha is outside [0, 1].
void blend_frames(const PoissonReconstruction& poisson, const PositionsView& source,
                  const PositionsView& target, double alpha, PositionsRef blended);

// Interpolates two gradient fields, alpha in [0, 1].
GradientField interpolate(const GradientField& source, const GradientField& target, double alpha);

}  // namespace reprise
