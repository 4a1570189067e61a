// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/editing/editing_session.h"

#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/editing/editing_test_support.h"

namespace reprise {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using testing::HasSubstr;

const PerformanceDatabase& performance() {
  static const PerformanceDatabase database =
      test::database_of({test::walk("walk", 12), test::walk("other", 8, 0.0)});
  return database;
}

std::vector<std::int32_t> range(std::int32_t first, std::int32_t last) {
  std::vector<std::int32_t> vertices;
  for (std::int32_t v = first; v <= last; ++v) vertices.push_back(v);
  return vertices;
}

class EditingSessionTest : public testing::Test {
 protected:
  EditingSessionTest() {
    session_.set_anchors({{.name = "feet", .vertices = range(0, 9)}});
    session_.set_handles({{.name = "hand", .vertices = range(40, 44)},
                          {.name = "head", .vertices = range(80, 89), .weight = 2.0}});
  }

  Coordinates captured(FrameId frame) const {
    return performance().clip(frame.clip_idx).frame(frame.frame_idx).cast<double>();
  }

  std::shared_ptr<const test::NearbyFactory> factory_ =
      std::make_shared<const test::NearbyFactory>(performance());
  EditingSession session_{factory_, EditModel::part, {0, 3}};
};

// All that a caller can see of a session.
struct Seen {
  explicit Seen(const EditingSession& session)
      : model(session.model()),
        frame(session.frame()),
        anchors(session.anchors()),
        handles(session.handles()),
        positions(session.positions()),
        normals(session.normals()),
        commits(session.commits().size()) {
    for (const Handle& handle : handles) displacements.push_back(session.displacement(handle.name));
  }
  bool operator==(const Seen& other) const {
    return model == other.model && frame == other.frame && anchors == other.anchors &&
           handles == other.handles && displacements == other.displacements && positions == other.positions &&
           normals == other.normals && commits == other.commits;
  }

  EditModel model;
  FrameId frame;
  std::vector<Handle> anchors, handles;
  std::vector<Vector3d> displacements;
  Coordinates positions;
  Positions normals;
  std::size_t commits;
};

TEST_F(EditingSessionTest, AtRestItIsTheCapturedFrameToTheBitAndNothingIsSolved) {
  EXPECT_EQ(session_.positions(), captured({0, 3}));
  const PositionsView frame = performance().clip(0).frame(3);
  EXPECT_EQ(session_.normals(), vertex_normals(*performance().topology(), frame));
  session_.set_frame({1, 5});
  EXPECT_EQ(session_.positions(), captured({1, 5}));
  EXPECT_EQ(factory_->solves, 0);
}

TEST_F(EditingSessionTest, ADragTakesItsVerticesThereAndHoldsTheAnchors) {
  const Vector3d move(0.1, 0.2, -0.3);
  const DeformReport report = session_.drag("hand", move);
  EXPECT_EQ(report.solved_parts, 1);
  EXPECT_LT(report.largest_residual, 1e-12);
  for (const std::int32_t v : range(40, 44)) {
    EXPECT_LT((session_.positions().row(v) - captured({0, 3}).row(v) - move.transpose()).norm(), 1e-12);
  }
  for (const std::int32_t v : range(0, 9)) {
    EXPECT_EQ(session_.positions().row(v), captured({0, 3}).row(v));
  }
  for (const std::int32_t v : range(80, 89)) {
    EXPECT_EQ(session_.positions().row(v), captured({0, 3}).row(v)) << "a handle at rest stays";
  }
}

TEST_F(EditingSessionTest, AHandleTurnsAboutItsCentroid) {
  const Quaterniond quarter(Eigen::AngleAxisd(0.5 * M_PI, Vector3d::UnitY()));
  session_.drag("hand", Vector3d::Zero(), quarter);
  const Coordinates before = captured({0, 3}).middleRows(40, 5);
  const Coordinates after = session_.positions().middleRows(40, 5);
  const Eigen::RowVector3d centroid = before.colwise().mean();
  EXPECT_LT((after.colwise().mean() - centroid).norm(), 1e-12);
  for (int i = 0; i < 5; ++i) {
    const Vector3d turned = quarter * (before.row(i) - centroid).transpose();
    EXPECT_LT(((after.row(i) - centroid).transpose() - turned).norm(), 1e-12);
  }
}

TEST_F(EditingSessionTest, UndoAndRedoGiveEveryStepBackToTheBit) {
  const std::vector<std::function<void()>> steps = {
      [&] {
        session_.drag("hand", {0.1, 0.0, 0.0});
      },
      [&] {
        session_.drag("head", {0.0, 0.2, 0.0}, Quaterniond(Eigen::AngleAxisd(0.3, Vector3d::UnitX())));
      },
      [&] { session_.set_model(EditModel::laplacian); },
      [&] {
        session_.set_anchors({{.name = "other", .vertices = {20, 21}, .weight = 3.0}});
      },
      [&] {
        session_.set_frame({1, 2});
      },
      [&] {
        session_.drag("hand", {0.0, -0.1, 0.1});
      },
      [&] {
        session_.set_handles(
            {{.name = "hand", .vertices = range(40, 44)}, {.name = "hip", .vertices = {50}}});
      },
      [&] {
        session_.drag("hip", {0.3, 0.0, 0.0});
      },
      [&] { session_.reset(); },
  };
  std::vector<Seen> seen{Seen(session_)};
  for (const auto& step : steps) {
    step();
    seen.emplace_back(session_);
    EXPECT_FALSE(seen.back() == seen[seen.size() - 2]) << "step " << seen.size() - 1 << " changed nothing";
  }
  EXPECT_FALSE(session_.redo());
  for (std::size_t i = seen.size() - 1; i-- > 0;) {
    ASSERT_TRUE(session_.undo());
    EXPECT_TRUE(Seen(session_) == seen[i]) << "undo to step " << i;
  }
  for (std::size_t i = 1; i < seen.size(); ++i) {
    ASSERT_TRUE(session_.redo());
    EXPECT_TRUE(Seen(session_) == seen[i]) << "redo of step " << i;
  }
  EXPECT_FALSE(session_.redo());
}

TEST_F(EditingSessionTest, ThereIsAFirstStateAndNothingBeforeIt) {
  EXPECT_TRUE(session_.undo());
  EXPECT_TRUE(session_.undo());
  EXPECT_FALSE(session_.undo());
  EXPECT_TRUE(session_.handles().empty());
}

TEST_F(EditingSessionTest, AChangeAfterUndoForgetsWhatWasUndone) {
  session_.drag("hand", {0.1, 0.0, 0.0});
  session_.undo();
  session_.drag("hand", {0.0, 0.1, 0.0});
  EXPECT_FALSE(session_.redo());
  session_.undo();
  EXPECT_EQ(session_.displacement("hand"), Vector3d::Zero());
}

TEST_F(EditingSessionTest, ADragOfManyMovesIsOneStep) {
  const Seen rest(session_);
  for (int i = 1; i <= 10; ++i) {
    session_.drag("hand", {0.01 * i, 0.0, 0.0}, Quaterniond::Identity(), i == 10);
  }
  const Seen dragged(session_);
  session_.drag("hand", {0.0, 0.3, 0.0});  // the next one is a step of its own
  session_.undo();
  EXPECT_TRUE(Seen(session_) == dragged);
  session_.undo();
  EXPECT_TRUE(Seen(session_) == rest);
  session_.redo();
  EXPECT_TRUE(Seen(session_) == dragged);
}

TEST_F(EditingSessionTest, AnotherHandleOrUndoEndsADrag) {
  session_.drag("hand", {0.1, 0.0, 0.0}, Quaterniond::Identity(), false);
  const Seen first(session_);
  session_.drag("head", {0.0, 0.1, 0.0}, Quaterniond::Identity(), false);
  session_.undo();
  EXPECT_TRUE(Seen(session_) == first);
  session_.drag("hand", {0.2, 0.0, 0.0}, Quaterniond::Identity(), false);
  session_.undo();
  EXPECT_TRUE(Seen(session_) == first);
}

TEST_F(EditingSessionTest, ADragThatComesBackToWhereItBeganIsNoStep) {
  session_.drag("head", {0.0, 0.1, 0.0});
  session_.drag("hand", {0.1, 0.0, 0.0}, Quaterniond::Identity(), false);
  session_.drag("hand", Vector3d::Zero(), Quaterniond::Identity(), true);
  session_.undo();
  EXPECT_EQ(session_.displacement("head"), Vector3d::Zero());
}

TEST_F(EditingSessionTest, AChangeToWhatIsAlreadySoIsNoStep) {
  session_.drag("hand", {0.1, 0.0, 0.0});
  const Seen seen(session_);
  session_.undo();
  session_.redo();
  session_.drag("hand", {0.1, 0.0, 0.0});
  session_.set_model(EditModel::part);
  session_.set_frame({0, 3});
  session_.set_anchors(session_.anchors());
  session_.set_handles(session_.handles());
  EXPECT_TRUE(Seen(session_) == seen);
  session_.undo();
  EXPECT_EQ(session_.displacement("hand"), Vector3d::Zero());
}

TEST_F(EditingSessionTest, TheSurfaceDependsOnNothingThatWasBefore) {
  session_.drag("head", {0.5, 0.0, 0.0});
  session_.set_frame({1, 1});
  session_.drag("head", {0.0, 0.4, 0.0});
  session_.set_frame({0, 3});
  session_.drag("hand", {0.0, 0.0, 0.2});

  EditingSession straight(factory_, EditModel::part, {0, 3});
  straight.set_handles(session_.handles());
  straight.set_anchors(session_.anchors());
  straight.drag("hand", {0.0, 0.0, 0.2});
  EXPECT_EQ(session_.positions(), straight.positions());
  EXPECT_EQ(session_.normals(), straight.normals());
}

TEST_F(EditingSessionTest, HandlesKeepTheirPlaceWhileOthersComeAndGo) {
  session_.drag("hand", {0.1, 0.0, 0.0});
  session_.set_handles({{.name = "hand", .vertices = range(40, 44)}, {.name = "hip", .vertices = {50}}});
  EXPECT_EQ(session_.displacement("hand"), Vector3d(0.1, 0.0, 0.0));
  EXPECT_EQ(session_.displacement("hip"), Vector3d::Zero());
  session_.set_handles({{.name = "hand", .vertices = range(40, 45)}});
  EXPECT_EQ(session_.displacement("hand"), Vector3d::Zero()) << "it is another handle of the same name";
}

TEST_F(EditingSessionTest, AVertexOfAnchorAndHandleGoesWithTheHandle) {
  session_.set_anchors(
      {{.name = "a", .vertices = range(0, 50)}, {.name = "b", .vertices = {5}, .weight = 4.0}});
  session_.drag("hand", {0.1, 0.0, 0.0});
  EXPECT_NEAR(session_.positions()(42, 0), captured({0, 3})(42, 0) + 0.1, 1e-12);
  const EditedFrame& committed = session_.commit();
  EXPECT_EQ(committed.constraints.size(), 46U + 5U + 10U);
  EXPECT_EQ(committed.constraints[5].vertex, 5);
  EXPECT_EQ(committed.constraints[5].weight, 4.0) << "of two anchors the greater weight";
}

TEST_F(EditingSessionTest, CommitsAreKeptFrameByFrame) {
  session_.drag("hand", {0.1, 0.0, 0.0});
  session_.commit();
  session_.set_frame({0, 7});
  session_.drag("head", {0.0, 0.1, 0.0});
  session_.commit();
  session_.set_frame({0, 3});
  session_.drag("hand", {0.2, 0.0, 0.0});
  session_.commit();
  ASSERT_EQ(session_.commits().size(), 2U);
  EXPECT_EQ(session_.commits()[0].frame, (FrameId{0, 3}));
  EXPECT_EQ(session_.commits()[1].frame, (FrameId{0, 7}));
  EXPECT_EQ(session_.commits()[0].positions, session_.positions().cast<float>());
  session_.undo();
  EXPECT_NE(session_.commits()[0].positions, session_.positions().cast<float>());
}

TEST_F(EditingSessionTest, AnErrorLeavesAllAsItWas) {
  session_.drag("hand", {0.1, 0.0, 0.0});
  session_.drag("head", {0.0, 0.1, 0.0}, Quaterniond::Identity(), false);
  const Seen before(session_);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const auto refuses = [&](const char* what, const std::function<void()>& change) {
    SCOPED_TRACE(what);
    try {
      change();
      ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(what));
    }
    EXPECT_TRUE(Seen(session_) == before);
  };
  refuses("did you mean 'hand'?", [&] { session_.drag("hnd", Vector3d::Zero()); });
  refuses("finite", [&] { session_.drag("hand", {nan, 0.0, 0.0}); });
  refuses("finite", [&] { session_.drag("hand", {infinity, 0.0, 0.0}); });
  refuses("finite", [&] { session_.drag("hand", Vector3d::Zero(), Quaterniond(0.0, 0.0, 0.0, 0.0)); });
  refuses("too far", [&] { session_.drag("hand", {0.0, 2000.0, 0.0}); });
  refuses("too far", [&] { session_.drag("head", {0.0, 2000.0, 0.0}, Quaterniond::Identity(), false); });
  refuses("no such model here", [&] { session_.set_model(EditModel::dqs); });
  refuses("frame", [&] { session_.set_frame({0, 12}); });
  refuses("clip", [&] { session_.set_frame({2, 0}); });
  refuses("has no name", [&] { session_.set_handles({{.name = "", .vertices = {1}}}); });
  refuses("at least one vertex", [&] { session_.set_handles({{.name = "a", .vertices = {}}}); });
  refuses("ascending", [&] { session_.set_handles({{.name = "a", .vertices = {2, 1}}}); });
  refuses("ascending", [&] { session_.set_anchors({{.name = "a", .vertices = {2, 2}}}); });
  refuses("expected vertices from 0 to", [&] { session_.set_anchors({{.name = "a", .vertices = {-1}}}); });
  refuses("expected vertices from 0 to", [&] { session_.set_handles({{.name = "a", .vertices = {99999}}}); });
  refuses("weight", [&] { session_.set_handles({{.name = "a", .vertices = {1}, .weight = 0.0}}); });
  refuses("weight", [&] { session_.set_anchors({{.name = "a", .vertices = {1}, .weight = nan}}); });
  refuses("named 'hand'", [&] { session_.set_anchors({{.name = "hand", .vertices = {1}}}); });
  refuses("vertex 3 is in the handles 'a' and 'b'", [&] {
    session_.set_handles({{.name = "a", .vertices = {1, 3}}, {.name = "b", .vertices = {3, 4}}});
  });
  // The drag is still open, and editors still work.
  session_.drag("head", {0.0, 0.2, 0.0});
  session_.undo();
  EXPECT_EQ(session_.displacement("head"), Vector3d::Zero());
  EXPECT_EQ(session_.displacement("hand"), Vector3d(0.1, 0.0, 0.0));
}

TEST(EditingSession, RefusesWhatItCannotBeginWith) {
  EXPECT_THROW(EditingSession(nullptr, EditModel::part, {0, 0}), InvalidArgument);
  const auto factory = std::make_shared<const test::NearbyFactory>(performance());
  EXPECT_THROW(EditingSession(factory, EditModel::part, {0, 12}), InvalidArgument);
  EXPECT_THROW(EditingSession(factory, EditModel::dqs, {0, 0}), InvalidArgument);
  const PerformanceDatabase nothing;
  const auto empty = std::make_shared<const test::NearbyFactory>(nothing);
  EXPECT_THROW(EditingSession(empty, EditModel::part, {0, 0}), InvalidArgument);
}

TEST(EditModel, NamesAndModelsAreOneToOne) {
  for (const char* name : {"part", "whole", "laplacian", "lbs", "dqs"}) {
    EXPECT_EQ(to_string(parse_edit_model(name)), name);
  }
  EXPECT_THROW(parse_edit_model("Part"), InvalidArgument);
}

}  // namespace
}  // namespace reprise
