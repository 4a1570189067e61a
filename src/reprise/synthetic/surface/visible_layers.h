// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The layers of a dressed body as one soup of triangles that can be searched.

#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "reprise/mesh/closest_point.h"
#include "reprise/synthetic/body/dressed_body.h"

namespace reprise::capture {

// A place on a layer at rest.
struct LayerPoint {
  int layer = -1;  // -1: on a cap
  std::int32_t triangle = -1;
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  double distance = 0.0;
};

// Fans that close the borders of garments and shoes: hem, neckline, sleeves.
TriangleMesh border_caps(const BodyLayer& layer);

// The edges of the borders that get a cap.
std::vector<std::array<Eigen::Vector3d, 2>> border_lines(const BodyLayer& layer);

// Brows and lashes lie on the skin: they are seen, but have no shape of their own. Eyes fill their sockets.
bool has_shape(const BodyLayer& layer);

class VisibleLayers {
 public:
  // Triangles that are not hidden. `layers` must outlive this.
  explicit VisibleLayers(const std::vector<BodyLayer>& layers);

  const std::vector<BodyLayer>& layers() const { return layers_; }

  // The layer nearest to a point of a closed surface around all layers; of two that lie together the outer
  // one. The cap where it is nearer by far than any layer. Nothing if all are farther than `max_distance`, or
  // `max_hair_distance` for hair.
  std::optional<LayerPoint> nearest(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                    double max_distance, double max_hair_distance) const;

  // What a camera far out along `normal` would see at the point: colour, composited through the alpha of
  // hair, brows and lashes. Nothing if no layer lies along the ray near the point.
  std::optional<Eigen::Vector3d> color_seen(const Eigen::Vector3d& point,
                                            const Eigen::Vector3d& normal) const;

  // Colour of a layer's texture, 0 to 255, and alpha, 0 to 1.
  Eigen::Vector4d sample(int layer, std::int32_t triangle, const Eigen::Vector3d& weights) const;

 private:
  struct Source {
    int layer = -1;
    std::int32_t triangle = -1;
  };

  double alpha_at(const Source& source, const Eigen::Vector3d& weights, double sampled) const;

  const std::vector<BodyLayer>& layers_;
  std::vector<std::vector<float>> density_;         // of each layer's texture, its alpha averaged; hair only
  std::vector<ClosestPointTree> trees_;             // one a layer with a shape, and the caps
  std::vector<int> layer_of_tree_;                  // -1: the caps
  std::vector<std::vector<std::int32_t>> sources_;  // triangles of the layer, one list a tree
  std::vector<Source> all_sources_;
  std::optional<ClosestPointTree> all_;  // what can be seen
};

}  // namespace reprise::capture
