// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "arap_peer.h"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_deformation.h>
#include <fmt/format.h>

#include "thread_time.h"

namespace reprise::benchmark {

using Kernel = CGAL::Simple_cartesian<double>;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;
// CGAL's own defaults: spokes and rims, cotangent weights, Eigen's solver.
using Deformation = CGAL::Surface_mesh_deformation<SurfaceMesh>;

struct ArapPeer::Impl {
  SurfaceMesh mesh;
  std::unique_ptr<Deformation> deformation;
};

ArapPeer::ArapPeer(const Topology& topology, const Positions& frame, std::span<const std::int32_t> held)
    : impl_(std::make_unique<Impl>()) {
  SurfaceMesh& mesh = impl_->mesh;
  for (Eigen::Index v = 0; v < frame.rows(); ++v)
    mesh.add_vertex(Kernel::Point_3(frame(v, 0), frame(v, 1), frame(v, 2)));
  const auto vertex = [](std::int32_t v) {
    return SurfaceMesh::Vertex_index(static_cast<SurfaceMesh::size_type>(v));
  };
  for (const Triangle& triangle : topology.triangles) {
    if (mesh.add_face(vertex(triangle[0]), vertex(triangle[1]), vertex(triangle[2])) ==
        SurfaceMesh::null_face()) {
      refusal_ = fmt::format("CGAL does not take the triangle {}, {}, {}: the mesh is no oriented manifold",
                             triangle[0], triangle[1], triangle[2]);
      return;
    }
  }
  const double start = thread_ms();
  impl_->deformation = std::make_unique<Deformation>(mesh);
  impl_->deformation->insert_roi_vertices(vertices(mesh).first, vertices(mesh).second);
  for (const std::int32_t v : held) impl_->deformation->insert_control_vertex(vertex(v));
  if (!impl_->deformation->preprocess()) refusal_ = "CGAL cannot factorise its system";
  preparation_ms_ = thread_ms() - start;
}

ArapPeer::~ArapPeer() = default;

void ArapPeer::drag(std::span<const PositionConstraint> constraints) {
  for (const PositionConstraint& constraint : constraints) {
    const Eigen::Vector3d& target = constraint.target;
    impl_->deformation->set_target_position(
        SurfaceMesh::Vertex_index(static_cast<SurfaceMesh::size_type>(constraint.vertex)),
        Kernel::Point_3(target.x(), target.y(), target.z()));
  }
  constexpr unsigned int iterations = 10;
  constexpr double tolerance = 0.0;  // no early stop
  impl_->deformation->deform(iterations, tolerance);
}

Eigen::Vector3d ArapPeer::position(std::int32_t vertex) const {
  const Kernel::Point_3& point =
      impl_->mesh.point(SurfaceMesh::Vertex_index(static_cast<SurfaceMesh::size_type>(vertex)));
  return {point.x(), point.y(), point.z()};
}

}  // namespace reprise::benchmark
