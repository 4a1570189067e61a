// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mocap/surface_driver.h"

#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/deform/laplacian_editor.h"

namespace reprise {
namespace {

PositionsView view(const Positions& positions) {
  return {positions.data(), positions.rows(), 3};
}

// Null: skinning alone.
std::unique_ptr<SurfaceEditor> make_editor(const DriveRig& rig, DriveModel model) {
  switch (model) {
    case DriveModel::part:
    case DriveModel::whole:
      if (!rig.learnt)
        throw InvalidArgument(fmt::format("nothing was learnt for the model '{}'", to_string(model)));
      return std::make_unique<PartEditor>(rig.learnt);
    case DriveModel::laplacian:
      return std::make_unique<LaplacianEditor>(rig.topology, view(rig.markup->reference));
    default:
      return nullptr;
  }
}

}  // namespace

UprightMotion nearest_upright(const SkeletonPose& source, const SkeletonPose& target) {
  if (source.position.size() != target.position.size() || source.position.empty()) {
    throw InvalidArgument("two poses of one skeleton are needed to bring one to the other");
  }
  const double count = static_cast<double>(source.position.size());
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();
  for (std::size_t j = 0; j < source.position.size(); ++j) {
    from += source.position[j] / count;
    to += target.position[j] / count;
  }
  double along = 0.0, across = 0.0;
  for (std::size_t j = 0; j < source.position.size(); ++j) {
    const Eigen::Vector3d a = target.position[j] - to, b = source.position[j] - from;
    along += a.x() * b.x() + a.z() * b.z();
    across += a.x() * b.z() - a.z() * b.x();
  }
  UprightMotion motion;
  if (std::hypot(along, across) > 0.0) motion.ground.yaw = std::atan2(across, along);
  const Eigen::Vector3d turned = motion.ground * from;
  motion.ground.translation = {to.x() - turned.x(), to.z() - turned.z()};
  motion.rise = to.y() - from.y();
  return motion;
}

SkeletonPose moved(const UprightMotion& motion, const SkeletonPose& pose) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(motion.ground.yaw, Eigen::Vector3d::UnitY()));
  SkeletonPose result = pose;
  for (Eigen::Vector3d& position : result.position) position = motion * position;
  for (Eigen::Quaterniond& rotation : result.rotation) rotation = (turn * rotation).normalized();
  return result;
}

PartEditorOptions drive_part_options() {
  PartEditorOptions options;
  options.prior = 100.0;
  options.free_turn = 1.2;
  return options;
}

SurfaceDriver::SurfaceDriver(DriveRig rig, DriveModel model)
    : rig_(std::move(rig)), model_(model), editor_(make_editor(rig_, model)) {}

SurfaceDriver::~SurfaceDriver() = default;

void SurfaceDriver::drive(const PositionsView& frame, const SkeletonPose& source, const SkeletonPose& target,
                          PositionsRef out) {
  const Skeleton& skeleton = rig_.markup->skeleton;
  if (model_ == DriveModel::rest_lbs) {
    skin(*rig_.weights, skeleton, view(rig_.markup->reference), rest_pose(skeleton), target, Skinning::linear,
         out);
    return;
  }
  const UprightMotion motion = nearest_upright(source, target);
  const SkeletonPose placed_pose = moved(motion, source);
  Positions placed(frame.rows(), 3);
  for (Eigen::Index v = 0; v < frame.rows(); ++v) {
    placed.row(v) = (motion * Eigen::Vector3d(frame.row(v).cast<double>())).transpose().cast<float>();
  }
  if (model_ == DriveModel::none) {
    out = placed;
    return;
  }
  Positions skinned(frame.rows(), 3);
  skin(*rig_.weights, skeleton, view(placed), placed_pose, target,
       model_ == DriveModel::dqs ? Skinning::dual_quaternion : Skinning::linear,
       PositionsRef(skinned.data(), skinned.rows(), 3));
  if (!editor_) {
    out = skinned;
    return;
  }
  std::vector<PositionConstraint> constraints;
  constraints.reserve(rig_.vertices.size());
  for (const DriveVertex& drive : rig_.vertices) {
    constraints.push_back({.vertex = drive.vertex,
                           .target = skinned.row(drive.vertex).transpose().cast<double>(),
                           .weight = drive.weight});
  }
  editor_->set_frame(view(placed), &placed_pose);
  editor_->deform(constraints);
  out = editor_->positions().cast<float>();
}

}  // namespace reprise
