// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/dynamics/layer_player.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "reprise/core/parallel.h"
#include "reprise/synthetic/dynamics/cloth.h"
#include "reprise/synthetic/dynamics/hair.h"

namespace reprise::dynamics {

namespace {

bool moves_freely(const BodyLayer& layer) {
  return std::any_of(layer.freedom.begin(), layer.freedom.end(),
                     [](double freedom) { return freedom > pinned_freedom; });
}

bool stops_cloth(const BodyLayer& layer) {
  switch (layer.kind) {
    case BodyLayer::Kind::skin:
    case BodyLayer::Kind::shoes:
      return true;
    case BodyLayer::Kind::garment:
      return !moves_freely(layer);
    case BodyLayer::Kind::face:
    case BodyLayer::Kind::hair:
      return false;
  }
  return false;
}

}  // namespace

LayerPlayer::LayerPlayer(const std::vector<BodyLayer>& layers, const DynamicsOptions& options,
                         double frames_per_second) {
  settings_.seconds = 1.0 / frames_per_second;
  settings_.substeps =
      std::max(1, static_cast<int>(std::lround(options.substeps * 25.0 / frames_per_second)));
  settings_.surroundings.wind = {options.wind, 0.0, 0.0};

  std::vector<Triangle> body_triangles;
  std::vector<Points> rest;
  std::int32_t vertices = 0;
  for (std::size_t l = 0; l < layers.size(); ++l) {
    rest.push_back(layers[l].points);
    if (!stops_cloth(layers[l])) continue;
    body_layers_.push_back(l);
    for (Triangle triangle : layers[l].triangles) {
      for (std::int32_t& corner : triangle) corner += vertices;
      body_triangles.push_back(triangle);
    }
    vertices += static_cast<std::int32_t>(layers[l].points.rows());
  }
  const Points body = body_of(rest);
  for (std::size_t l = 0; l < layers.size(); ++l) {
    if (!moves_freely(layers[l])) continue;
    if (layers[l].kind == BodyLayer::Kind::garment) {
      ClothMaterial material;
      material.thickness = options.cloth_thickness;
      simulated_.push_back({l, std::make_unique<ClothLayer>(layers[l], material, body_triangles, body)});
    } else if (layers[l].kind == BodyLayer::Kind::hair) {
      simulated_.push_back({l, std::make_unique<HairLayer>(layers[l], HairMaterial{}, body_triangles, body)});
    }
  }
}

Points LayerPlayer::body_of(const std::vector<Points>& layers) const {
  Eigen::Index rows = 0;
  for (const std::size_t l : body_layers_) rows += layers[l].rows();
  Points body(rows, 3);
  rows = 0;
  for (const std::size_t l : body_layers_) {
    body.middleRows(rows, layers[l].rows()) = layers[l];
    rows += layers[l].rows();
  }
  return body;
}

void LayerPlayer::start(const std::vector<Points>& skinned) {
  const Points body = body_of(skinned);
  for (const Simulated& layer : simulated_) layer.soft->start(skinned[layer.layer_idx], body);
  end_ = after_ = skinned;
}

void LayerPlayer::advance(const std::vector<Points>& skinned_after) {
  const Points body = body_of(skinned_after);
  parallel_for(0, simulated_.size(), [&](std::size_t i) {
    simulated_[i].soft->advance(skinned_after[simulated_[i].layer_idx], body, settings_);
  });
  end_.swap(after_);
  after_ = skinned_after;
}

std::vector<Points> LayerPlayer::points() {
  std::vector<Points> result = end_;
  for (const Simulated& layer : simulated_) result[layer.layer_idx] = layer.soft->points();
  return result;
}

}  // namespace reprise::dynamics
