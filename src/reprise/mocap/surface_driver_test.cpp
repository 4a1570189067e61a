// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mocap/surface_driver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/mocap/mocap_test_support.h"

namespace reprise {
namespace {

using Eigen::Vector3d;

UprightMotion some_motion() {
  return {.ground = {.yaw = 2.0, .translation = {3.0, -1.0}}, .rise = 0.2};
}

TEST(NearestUpright, FindsTheMotionThatWasMade) {
  const SkeletonPose& pose = test::figure_motions()[1].frames[10];
  const UprightMotion made = some_motion();
  const UprightMotion found = nearest_upright(pose, moved(made, pose));
  EXPECT_NEAR(found.ground.yaw, made.ground.yaw, 1e-12);
  EXPECT_LT((found.ground.translation - made.ground.translation).norm(), 1e-12);
  EXPECT_NEAR(found.rise, made.rise, 1e-12);
}

TEST(NearestUpright, RefusesPosesOfTwoSkeletons) {
  SkeletonPose fewer = test::figure_motions()[1].frames[10];
  fewer.position.pop_back();
  EXPECT_THROW(static_cast<void>(nearest_upright(fewer, test::figure_motions()[1].frames[10])),
               InvalidArgument);
}

class EveryDriveModel : public testing::TestWithParam<DriveModel> {
 protected:
  static double farthest(const Positions& a, const Positions& b) {
    return (a - b).rowwise().norm().maxCoeff();
  }
  static Positions drive(SurfaceDriver& driver, FrameId frame, const SkeletonPose& target) {
    const PositionsView shown = test::figure_performer().clip(frame.clip_idx).frame(frame.frame_idx);
    Positions out(shown.rows(), 3);
    driver.drive(shown, test::figure_motions()[frame.clip_idx].frames[frame.frame_idx], target,
                 PositionsRef(out.data(), out.rows(), 3));
    return out;
  }

  const FrameId walk_{test::figure_performer().clip_idx("walk"), 20};
  const FrameId jog_{test::figure_performer().clip_idx("jog"), 9};
  const SkeletonPose& walking_ = test::figure_motions()[walk_.clip_idx].frames[walk_.frame_idx];
  const SkeletonPose& jogging_ = test::figure_motions()[jog_.clip_idx].frames[jog_.frame_idx];
};

// Those that show the frame they are given.
class EveryModelOfTheFrame : public EveryDriveModel {};

TEST_P(EveryModelOfTheFrame, LeavesAFrameInItsOwnPose) {
  SurfaceDriver driver(test::figure_rig(GetParam()), GetParam());
  const Positions frame = test::figure_performer().clip(walk_.clip_idx).frame(walk_.frame_idx);
  EXPECT_LT(farthest(drive(driver, walk_, walking_), frame), 2e-4);
}

TEST_P(EveryDriveModel, GoesWhereTheTargetGoes) {
  SurfaceDriver driver(test::figure_rig(GetParam()), GetParam());
  const Positions here = drive(driver, walk_, jogging_);
  const Positions there = drive(driver, walk_, moved(some_motion(), jogging_));
  Positions expected(here.rows(), 3);
  for (Eigen::Index v = 0; v < here.rows(); ++v) {
    expected.row(v) = (some_motion() * Vector3d(here.row(v).cast<double>())).transpose().cast<float>();
  }
  // The solvers stop when a step is short: some hundredths of a millimetre are left.
  EXPECT_LT(farthest(there, expected), 5e-4);
}

TEST_P(EveryDriveModel, DoesNotRememberTheFrameBefore) {
  SurfaceDriver fresh(test::figure_rig(GetParam()), GetParam());
  SurfaceDriver used(test::figure_rig(GetParam()), GetParam());
  static_cast<void>(drive(used, jog_, walking_));
  EXPECT_EQ(drive(used, walk_, jogging_), drive(fresh, walk_, jogging_));
}

// Those that take more than the place.
class EveryPosingModel : public EveryDriveModel {};

TEST_P(EveryPosingModel, TakesThePoseAskedFor) {
  SurfaceDriver driver(test::figure_rig(GetParam()), GetParam());
  MeshSequence driven("driven", test::figure_performer().topology(), 1, 25.0);
  driven.frame(0) = drive(driver, walk_, jogging_);
  const SkeletonPose found = extract_skeleton(driven, *test::figure_performer().markup()).frames[0];
  double before = 0.0, after = 0.0;
  const SkeletonPose placed = moved(nearest_upright(walking_, jogging_), walking_);
  for (std::size_t j = 0; j < found.position.size(); ++j) {
    before = std::max(before, (placed.position[j] - jogging_.position[j]).norm());
    after = std::max(after, (found.position[j] - jogging_.position[j]).norm());
  }
  EXPECT_GT(before, 0.1);
  EXPECT_LT(after, 0.03);
}

std::string test_name(const testing::TestParamInfo<DriveModel>& param) {
  std::string name = to_string(param.param);
  std::ranges::replace(name, '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(SurfaceDriver, EveryDriveModel,
                         testing::Values(DriveModel::none, DriveModel::part, DriveModel::whole,
                                         DriveModel::laplacian, DriveModel::lbs, DriveModel::dqs,
                                         DriveModel::rest_lbs),
                         test_name);
INSTANTIATE_TEST_SUITE_P(SurfaceDriver, EveryModelOfTheFrame,
                         testing::Values(DriveModel::none, DriveModel::part, DriveModel::whole,
                                         DriveModel::laplacian, DriveModel::lbs, DriveModel::dqs),
                         test_name);
INSTANTIATE_TEST_SUITE_P(SurfaceDriver, EveryPosingModel,
                         testing::Values(DriveModel::part, DriveModel::whole, DriveModel::laplacian,
                                         DriveModel::lbs, DriveModel::dqs, DriveModel::rest_lbs),
                         test_name);

TEST(SurfaceDriver, NeedsWhatWasLearnt) {
  DriveRig rig = test::figure_rig(DriveModel::part);
  rig.learnt = nullptr;
  EXPECT_THROW(SurfaceDriver(rig, DriveModel::part), InvalidArgument);
  EXPECT_NO_THROW(SurfaceDriver(rig, DriveModel::lbs));
}

TEST(DriveModelNames, ComeBack) {
  for (const DriveModel model : {DriveModel::none, DriveModel::part, DriveModel::whole, DriveModel::laplacian,
                                 DriveModel::lbs, DriveModel::dqs, DriveModel::rest_lbs}) {
    EXPECT_EQ(parse_drive_model(to_string(model)), model);
  }
  try {
    static_cast<void>(parse_drive_model("skin"));
    FAIL();
  } catch (const InvalidArgument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("rest-lbs"));
  }
}

}  // namespace
}  // namespace reprise
