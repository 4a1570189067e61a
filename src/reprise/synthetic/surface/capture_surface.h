// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What a capture would see of a dressed body: one closed triangle surface over body, clothes and hair.

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "reprise/mesh/mesh.h"
#include "reprise/synthetic/body/dressed_body.h"

namespace reprise {

struct CaptureSurfaceOptions {
  int vertices = 2500;      // about; 1,000 to 50,000
  int texture_size = 2048;  // pixels, a power of two from 256 to 8192
};

// Throws `InvalidArgument` for an option out of range.
void validate(const CaptureSurfaceOptions& options);

class CaptureSurface {
 public:
  // Merges the layers at rest into one closed, manifold surface (level set, then remeshing to near-uniform
  // triangles, finer on face and hands), binds every vertex to the layer under it, and bakes the layers'
  // colours into an atlas. Legs under a skirt are closed off at the hem. Deterministic. Throws
  // `InvalidArgument` for options out of range.
  CaptureSurface(const DressedBody& body, const CaptureSurfaceOptions& options);

  // With atlas and texture.
  const TopologyPtr& topology() const { return topology_; }
  // N x 3, at rest.
  const Positions& rest() const { return rest_; }
  // The texture's colour at every vertex.
  const std::vector<Color>& colors() const { return colors_; }
  // The layer of every vertex: index into `DressedBody::layers()`, or `membrane` where it closes off a hem.
  static constexpr int membrane = -1;
  const std::vector<int>& layer_of_vertex() const { return layers_; }
  // The joint whose bone the vertex follows, or -1 on free cloth, hair and membranes.
  const std::vector<int>& joint_of_vertex() const { return joints_; }

  // The surface when the vertices of every layer are at `layer_points` (one entry a layer of the body).
  // Throws `InvalidArgument` if they do not fit the layers.
  Positions pose(const std::vector<Points>& layer_points) const;

 private:
  // Where a vertex sits on its layer: corners and weights of the triangle under it, and its offset from there
  // in the triangle's frame (along the first edge, across, outwards).
  struct Binding {
    int layer = membrane;
    std::array<int, 3> corners{};
    Eigen::Vector3d weights = Eigen::Vector3d::Zero();
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  };

  void place_membranes(Points& points) const;

  TopologyPtr topology_;
  Positions rest_;
  std::vector<Color> colors_;
  std::vector<int> layers_;
  std::vector<int> joints_;
  std::vector<Binding> bindings_;
  std::vector<Eigen::Index> layer_sizes_;
  // Membrane vertices hang between the others: position = weights (M x N) * positions, of vertex
  // membrane_vertices_[row].
  std::vector<std::int32_t> membrane_vertices_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> membrane_weights_;
};

}  // namespace reprise
