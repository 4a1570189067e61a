// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/part_alignment.h"

#include "reprise/math/nearest_rotation.h"

namespace reprise {

Coordinates Alignment::apply(const Coordinates& positions) const {
  return ((positions.rowwise() - centroid.transpose()) * rotation.transpose()).rowwise() +
         reference_centroid.transpose();
}

Alignment align(const Coordinates& positions, const Coordinates& reference) {
  Alignment result;
  result.centroid = positions.colwise().mean().transpose();
  result.reference_centroid = reference.colwise().mean().transpose();
  result.rotation =
      nearest_rotation((reference.rowwise() - result.reference_centroid.transpose()).transpose() *
                       (positions.rowwise() - result.centroid.transpose()));
  return result;
}

Coordinates rows_of(const PositionsView& positions, const std::vector<std::int32_t>& vertices) {
  Coordinates rows(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    rows.row(static_cast<Eigen::Index>(i)) = positions.row(vertices[i]).cast<double>();
  return rows;
}

SurfaceLaplacian part_laplacian(const PartHierarchy::Part& part, const Coordinates& reference) {
  const Positions rounded = reference.cast<float>();
  return SurfaceLaplacian(part.topology, PositionsView(rounded.data(), rounded.rows(), 3), part.loose);
}

}  // namespace reprise
