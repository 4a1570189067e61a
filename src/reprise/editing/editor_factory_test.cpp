// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Sessions and edited clips with the editors that users have.

#include "reprise/editing/editor_factory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/deform/learnt_figure_test_support.h"
#include "reprise/editing/editing_session.h"
#include "reprise/editing/space_time.h"
#include "reprise/editing/vertex_selection.h"
#include "reprise/graph/captured_acceleration.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

const PerformanceDatabase& performer() {
  static const PerformanceDatabase database = [] {
    PerformanceDatabase learnt = test::small_figure();
    learnt.set_models({.part = test::figure_parts(), .whole = test::figure_whole()});
    return learnt;
  }();
  return database;
}

class EveryModel : public testing::TestWithParam<EditModel> {
 protected:
  static const std::shared_ptr<const EditorFactory>& factory() {
    static const auto made = std::make_shared<const EditorFactory>(performer());
    return made;
  }
  static Handle joint(const std::string& name, FrameId frame) {
    return {.name = name, .vertices = select_vertices(performer(), frame, {.joint = name})};
  }

  // Hand up, feet and hips held.
  static KeyEdit raised_hand(EditModel model, FrameId frame, const Vector3d& move) {
    EditingSession session(factory(), model, frame);
    session.set_anchors({joint("pelvis", frame), joint("left_foot", frame), joint("right_foot", frame)});
    session.set_handles({joint("left_hand", frame)});
    session.drag("left_hand", move);
    return {frame.frame_idx, session.commit().constraints};
  }

  const FrameId frame_{performer().clip_idx("walk"), 25};
};

TEST_P(EveryModel, FollowsADragInASessionAndComesBackToTheBit) {
  EditingSession session(factory(), GetParam(), frame_);
  session.set_anchors({joint("pelvis", frame_), joint("left_foot", frame_), joint("right_foot", frame_)});
  const Handle hand = joint("left_hand", frame_);
  session.set_handles({hand});
  const Coordinates captured = session.positions();
  const Vector3d move(0.0, 0.06, 0.08);
  const DeformReport report = session.drag("left_hand", move);
  EXPECT_GE(report.solved_parts, 1);
  Vector3d moved = Vector3d::Zero();
  for (const std::int32_t v : hand.vertices) {
    moved += (session.positions().row(v) - captured.row(v)).transpose() /
             static_cast<double>(hand.vertices.size());
  }
  EXPECT_LT((moved - move).norm(), 0.3 * move.norm()) << moved.transpose();
  const Coordinates dragged = session.positions();
  session.drag("left_hand", {0.1, 0.0, 0.0});
  session.undo();
  EXPECT_EQ(session.positions(), dragged);
  session.undo();
  EXPECT_EQ(session.positions(), captured);
}

TEST_P(EveryModel, AHandleThatIsPutBackGivesTheFrameBack) {
  // An anchor beside it is moved by nothing: the solver itself is asked, not the session.
  const std::unique_ptr<SurfaceEditor> editor = factory()->make(GetParam());
  const PositionsView frame = performer().clip(frame_.clip_idx).frame(frame_.frame_idx);
  editor->set_frame(frame, factory()->pose(GetParam(), frame_));
  std::vector<PositionConstraint> constraints;
  for (const std::int32_t v : joint("left_hand", frame_).vertices) {
    constraints.push_back({v, frame.row(v).transpose().cast<double>()});
  }
  editor->deform(constraints);
  EXPECT_LT((editor->positions() - frame.cast<double>()).rowwise().norm().maxCoeff(), 1e-6);
}

TEST_P(EveryModel, AFarDragStaysFinite) {
  EditingSession session(factory(), GetParam(), frame_);
  session.set_handles({joint("left_hand", frame_)});
  session.drag("left_hand", {300.0, -1000.0, 20.0});
  EXPECT_TRUE(session.positions().allFinite());
  EXPECT_TRUE(session.normals().allFinite());
}

double pop_ratio(const MeshSequence& edited) {
  double peak = 0.0;
  for (std::size_t f = 1; f + 1 < edited.frame_count(); ++f) {
    peak = std::max(peak, peak_acceleration(edited, f));
  }
  return peak / captured_acceleration(performer());
}

// The same of what the edit adds, since a walk's feet accelerate more than any hand that is drawn aside.
double added_pop_ratio(MeshSequence edited, const MeshSequence& captured) {
  for (std::size_t f = 0; f < edited.frame_count(); ++f) edited.frame(f) -= captured.frame(f);
  return pop_ratio(edited);
}

TEST_P(EveryModel, AnEditOfOneFrameOverHalfASecondDoesNotPop) {
  const MeshSequence& clip = performer().clip(frame_.clip_idx);
  const KeyEdit key = raised_hand(GetParam(), frame_, {0.0, 0.08, 0.06});
  const auto edit = [&](double window, bool interpolate) {
    return edit_clip(*factory(), frame_.clip_idx, {key},
                     {.model = GetParam(), .window = window, .interpolate_coefficients = interpolate});
  };
  const MeshSequence edited = edit(0.5, true);
  const MeshSequence brief = edit(0.25, true);  // half a second in all
  const MeshSequence plain = edit(0.5, false);
  for (const auto& [name, clip_edited] :
       {std::pair("window_0.5", &edited), std::pair("window_0.25", &brief), std::pair("plain", &plain)}) {
    RecordProperty(name, std::to_string(added_pop_ratio(*clip_edited, clip)));
    EXPECT_LT(added_pop_ratio(*clip_edited, clip), 0.5) << name;
  }
  EXPECT_GT(added_pop_ratio(edit(0.01, true), clip), 1.3) << "one frame alone pops";
  EXPECT_LT(pop_ratio(edited), 1.3);
  EXPECT_LT(pop_ratio(brief), 1.3);
  EXPECT_LT(pop_ratio(plain), 1.3);
  EXPECT_EQ(Positions(edited.frame(12)), Positions(clip.frame(12)));
  EXPECT_NE(Positions(edited.frame(14)), Positions(clip.frame(14)));

  const std::unique_ptr<SurfaceEditor> editor = factory()->make(GetParam());
  editor->set_frame(clip.frame(25), factory()->pose(GetParam(), frame_));
  editor->deform(key.constraints);
  EXPECT_EQ(Positions(edited.frame(25)), editor->positions().cast<float>()) << "the key is its still edit";
  // Coefficients are learnt ones, and keys have no need to be drawn to themselves.
  const bool is_learnt = GetParam() == EditModel::part || GetParam() == EditModel::whole;
  EXPECT_EQ(Positions(edited.frame(20)) != Positions(plain.frame(20)), is_learnt);
  EXPECT_EQ(Positions(edited.frame(25)), Positions(plain.frame(25)));
}

TEST_P(EveryModel, KeysOfSeveralLimbsAreMetOnAnyNumberOfThreads) {
  const FrameId later{frame_.clip_idx, 33};
  EditingSession session(factory(), GetParam(), later);
  session.set_handles({joint("right_hand", later)});
  session.drag("right_hand", {0.0, 0.05, 0.05});
  const std::vector<KeyEdit> keys = {raised_hand(GetParam(), frame_, {0.0, 0.08, 0.06}),
                                     {later.frame_idx, session.commit().constraints}};
  const SpaceTimeOptions options{.model = GetParam(), .window = 0.3};
  const MeshSequence many = edit_clip(*factory(), frame_.clip_idx, keys, options);
  for (const KeyEdit& key : keys) {
    double sum = 0.0;
    for (const PositionConstraint& constraint : key.constraints) {
      sum += (many.frame(key.frame_idx).row(constraint.vertex).transpose().cast<double>() - constraint.target)
                 .squaredNorm();
    }
    EXPECT_LT(std::sqrt(sum / static_cast<double>(key.constraints.size())), 0.02) << key.frame_idx;
  }
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(edit_clip(*factory(), frame_.clip_idx, keys, options).data(), many.data());
}

INSTANTIATE_TEST_SUITE_P(Models, EveryModel,
                         testing::Values(EditModel::part, EditModel::whole, EditModel::laplacian,
                                         EditModel::lbs, EditModel::dqs),
                         [](const auto& model) { return to_string(model.param); });

TEST(EditorFactory, SaysWhatADatabaseLacks) {
  const PerformanceDatabase bare = test::database_of({test::walk("walk", 4)});
  const EditorFactory factory(bare);
  const auto refuses = [&](EditModel model, const char* what) {
    SCOPED_TRACE(to_string(model));
    try {
      factory.make(model);
      ADD_FAILURE() << "nothing was thrown";
    } catch (const InvalidArgument& error) {
      EXPECT_THAT(error.what(), HasSubstr(what));
    }
  };
  refuses(EditModel::part, "`reprise model learn`");
  refuses(EditModel::whole, "`reprise model learn`");
  refuses(EditModel::lbs, "`reprise markup`");
  refuses(EditModel::dqs, "`reprise markup`");
  EXPECT_NE(factory.make(EditModel::laplacian), nullptr);
  EXPECT_EQ(factory.pose(EditModel::laplacian, {0, 0}), nullptr);
  EXPECT_THROW(factory.pose(EditModel::part, {0, 4}), InvalidArgument);
  EXPECT_EQ(factory.root_vertices().size(), static_cast<std::size_t>(bare.topology()->vertex_count));
  EXPECT_EQ(EditorFactory(performer()).root_vertices(), performer().markup()->parts.front().vertices);
}

}  // namespace
}  // namespace reprise
