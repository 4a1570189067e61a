// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/laplacian_editor.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <Eigen/Dense>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/deform/edited_shapes_test_support.h"
#include "reprise/io/sequence_reader.h"
#include "reprise/math/nearest_rotation.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using namespace edit_test;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(LaplacianEditor, ZeroDragIsTheIdentity) {
  for (const Case& one : all_cases()) {
    const Positions frame = posed(one.shape.positions);
    LaplacianEditor editor(one.shape.topology, view(one.shape.positions));
    editor.set_frame(view(frame));
    EXPECT_EQ(editor.positions(), frame.cast<double>());
    for (const int step : {1, 7, 1000}) {
      editor.deform(every(step, frame, [](const Vector3d& p) { return p; }));
      EXPECT_LT(largest_distance(editor.positions(), frame.cast<double>()), 1e-6) << one.name << " " << step;
    }
  }
}

TEST(LaplacianEditor, RigidDragsMoveRigidly) {
  const Vector3d t(0.3, -2.0, 1.0);
  for (const Case& one : all_cases()) {
    const Positions frame = posed(one.shape.positions);
    LaplacianEditor editor(one.shape.topology, view(one.shape.positions));
    editor.set_frame(view(frame));
    for (const double degrees : {5.0, 90.0, 170.0, 180.0}) {
      const Matrix3d Q = AngleAxisd(degrees * std::numbers::pi / 180.0, Vector3d(1.0, 2.0, -0.5).normalized())
                             .toRotationMatrix();
      for (const int step : {2, 11}) {
        const DeformReport report =
            editor.deform(every(step, frame, [&](const Vector3d& p) -> Vector3d { return Q * p + t; }));
        EXPECT_LT(largest_distance(editor.positions(), moved(frame, Q, t)), 1e-6)
            << one.name << ", " << degrees << " degrees, every vertex of " << step;
        EXPECT_LE(report.iterations, 2) << one.name;
      }
    }
  }
}

TEST(LaplacianEditor, TwoConstraintsKeptApartMoveAllRigidly) {
  const test::Shape shape = bar();
  LaplacianEditor editor(shape.topology, view(shape.positions));
  editor.set_frame(view(shape.positions));
  const auto at = [&](std::int32_t v) -> Vector3d {
    return shape.positions.row(v).cast<double>().transpose();
  };
  const Vector3d far = at(0) + (at(1) - at(0)).norm() * Vector3d(0.0, 0.6, 0.8);
  editor.deform(
      std::vector<PositionConstraint>{{.vertex = 0, .target = at(0)}, {.vertex = 1, .target = far}});
  const Coordinates& x = editor.positions();
  EXPECT_LT((x.row(1).transpose() - far).norm(), 1e-6);
  for (Eigen::Index v = 0; v < x.rows(); ++v) {
    for (Eigen::Index w = 0; w < v; w += 17) {
      ASSERT_NEAR((x.row(v) - x.row(w)).norm(),
                  (shape.positions.row(v) - shape.positions.row(w)).cast<double>().norm(), 1e-6);
    }
  }
}

TEST(LaplacianEditor, OneConstraintTranslates) {
  for (const Case& one : all_cases()) {
    const Positions frame = posed(one.shape.positions);
    LaplacianEditor editor(one.shape.topology, view(one.shape.positions));
    editor.set_frame(view(frame));
    for (const std::int32_t v : {0, static_cast<std::int32_t>(frame.rows()) - 1}) {
      const Vector3d move(0.1, 5.0, -0.4);
      const Vector3d target = frame.row(v).cast<double>().transpose() + move;
      editor.deform(std::vector<PositionConstraint>{{.vertex = v, .target = target, .weight = 0.01}});
      EXPECT_LT(largest_distance(editor.positions(), moved(frame, Matrix3d::Identity(), move)), 1e-6)
          << one.name << ", vertex " << v;
    }
  }
}

TEST(LaplacianEditor, IsFiniteHoweverFarAndWhateverIsAsked) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (const Case& one : all_cases()) {
    LaplacianEditor editor(one.shape.topology, view(one.shape.positions));
    const Positions frame = posed(one.shape.positions);
    editor.set_frame(view(frame));
    for (const double far : {0.0, 0.3, 10.0, 1e4, 1e9}) {
      const auto scattered = every(13, frame, [&](const Vector3d&) -> Vector3d {
        return far * Vector3d(normal(random), normal(random), normal(random));
      });
      editor.deform(scattered);
      EXPECT_TRUE(editor.positions().allFinite()) << one.name << " " << far;
    }
  }
}

TEST(LaplacianEditor, ResultsDoNotDependOnHistoryOrOrder) {
  const test::Shape shape = bar();
  const auto bend = [](const Vector3d& p) -> Vector3d { return {p.x(), p.y() + 0.3 * p.x() * p.x(), p.z()}; };
  const std::vector<PositionConstraint> asked = every(19, shape.positions, bend);
  LaplacianEditor fresh(shape.topology, view(shape.positions));
  fresh.set_frame(view(shape.positions));
  fresh.deform(asked);

  LaplacianEditor used(shape.topology, view(shape.positions));
  used.set_frame(view(posed(shape.positions)));
  used.deform(every(5, shape.positions, bend));
  used.set_frame(view(shape.positions));
  used.deform(every(7, shape.positions, [](const Vector3d& p) -> Vector3d { return -3.0 * p; }));
  std::vector<PositionConstraint> reversed(asked.rbegin(), asked.rend());
  used.deform(reversed);
  EXPECT_EQ(used.positions(), fresh.positions());
  used.deform(asked);
  EXPECT_EQ(used.positions(), fresh.positions());
}

// The first iteration turns the surface as a whole: Eq. 4 with the best rotation Q, solved here by dense
// matrices with cotangents from the angles.
TEST(LaplacianEditor, FirstIterationSolvesEquation4) {
  test::Shape shape = bar(2);
  const std::vector<PositionConstraint> constraints =
      every(5, shape.positions, [](const Vector3d& p) -> Vector3d {
        return AngleAxisd(0.7, Vector3d::UnitZ()) * Vector3d(p.x(), p.y() + 0.2 * p.x() * p.x(), p.z());
      });
  constexpr double weight = 0.02;
  LaplacianEditor editor(shape.topology, view(shape.positions),
                         {.constraint_weight = weight, .most_iterations = 1});
  editor.set_frame(view(shape.positions));
  EXPECT_EQ(editor.deform(constraints).iterations, 1);

  const MatrixXd X = shape.positions.cast<double>();
  const Eigen::Index n = X.rows();
  MatrixXd L = MatrixXd::Zero(n, n);
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(n);
  double edges = 0.0;
  for (const Triangle& triangle : shape.topology->triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t i = triangle[k];
      const std::int32_t j = triangle[(k + 1) % 3];
      const std::int32_t opposite = triangle[(k + 2) % 3];
      const Vector3d a = (X.row(i) - X.row(opposite)).transpose();
      const Vector3d b = (X.row(j) - X.row(opposite)).transpose();
      const double half_cotangent = 0.5 * a.dot(b) / a.cross(b).norm();
      L(i, i) += half_cotangent;
      L(j, j) += half_cotangent;
      L(i, j) -= half_cotangent;
      L(j, i) -= half_cotangent;
      edges += (a - b).norm() / (3.0 * static_cast<double>(shape.topology->triangles.size()));
      areas[opposite] += a.cross(b).norm() / 6.0;
    }
  }
  L = areas.cwiseSqrt().cwiseInverse().asDiagonal() * L;
  MatrixXd W2 = MatrixXd::Zero(n, n);
  MatrixXd c = MatrixXd::Zero(n, 3);
  for (const PositionConstraint& one : constraints) {
    W2(one.vertex, one.vertex) = std::pow(weight * one.weight / edges, 2);
    c.row(one.vertex) = one.target.transpose();
  }
  const MatrixXd A_inverse = (L.transpose() * L + W2).inverse();
  const MatrixXd S = W2 - W2 * A_inverse * W2;
  const Matrix3d Q = nearest_rotation(c.transpose() * S * X);
  const MatrixXd x = A_inverse * (L.transpose() * L * X * Q.transpose() + W2 * c);
  EXPECT_LT(largest_distance(editor.positions(), x), 1e-6);
  // The same with the wrong rotation is something else.
  EXPECT_GT(largest_distance(editor.positions(), A_inverse * (L.transpose() * L * X + W2 * c)), 1e-3);
}

// One end of the bar held, the other turned by 90 degrees to where an arc of the same length ends.
TEST(LaplacianEditor, BentBarKeepsItsShape) {
  const test::Shape shape = bar(4);
  const double angle = 0.5 * std::numbers::pi;
  std::vector<PositionConstraint> constraints;
  for (std::int32_t v = 0; v < shape.positions.rows(); ++v) {
    const Vector3d p = shape.positions.row(v).cast<double>().transpose();
    if (p.x() < -0.8) constraints.push_back({.vertex = v, .target = p});
    if (p.x() > 0.8) {
      const double radius = 1.6 / angle;
      const Vector3d centre(-0.8, radius, 0.0);
      const Vector3d along(p.x() - 0.8, p.y(), p.z());
      constraints.push_back(
          {.vertex = v,
           .target = centre + AngleAxisd(angle, Vector3d::UnitZ()) * (along - Vector3d(0.0, radius, 0.0))});
    }
  }
  const auto deform = [&](int most_iterations) {
    LaplacianEditor editor(shape.topology, view(shape.positions), {.most_iterations = most_iterations});
    editor.set_frame(view(shape.positions));
    editor.deform(constraints);
    return editor.positions();
  };
  const Coordinates turned = deform(50);
  const Coordinates unturned = deform(1);
  const double whole = volume(*shape.topology, shape.positions.cast<double>());
  const auto lost = [&](const Coordinates& x) { return std::abs(volume(*shape.topology, x) / whole - 1.0); };
  const auto off = [&](const Coordinates& x) {
    return std::max(stretch(*shape.topology, shape.positions, x, 0.99) - 1.0,
                    1.0 - stretch(*shape.topology, shape.positions, x, 0.01));
  };
  EXPECT_LT(lost(turned), 0.15);
  EXPECT_LT(off(turned), 0.15);
  EXPECT_LT(off(turned), 0.5 * off(unturned));
  // It settles, and does not go on to crumple.
  EXPECT_LT(largest_distance(deform(500), turned), 1e-9);
}

TEST(LaplacianEditor, StopsWhenNothingMovesAnyMore) {
  const test::Shape shape = bar();
  const auto run = [&](int step, const LaplacianEditorOptions& options, Coordinates& x) {
    LaplacianEditor editor(shape.topology, view(shape.positions), options);
    editor.set_frame(view(shape.positions));
    const auto constraints = every(step, shape.positions, [](const Vector3d& p) -> Vector3d {
      return {p.x(), p.y() + 0.1 * p.x() * p.x(), p.z()};
    });
    const int iterations = editor.deform(constraints).iterations;
    x = editor.positions();
    return iterations;
  };
  // Held by every other vertex, the surface settles.
  Coordinates coarse, fine, limit;
  const int few = run(2, {.most_iterations = 500, .tolerance = 1e-4}, coarse);
  const int more = run(2, {.most_iterations = 500, .tolerance = 1e-6}, fine);
  run(2, {.most_iterations = 500, .tolerance = 1e-9}, limit);
  EXPECT_LT(few, more);
  EXPECT_LT(more, 100);
  EXPECT_LT(largest_distance(coarse, limit), 2e-3);
  EXPECT_LT(largest_distance(fine, limit), 2e-5);
  // Held by few, it stops when it was told to.
  EXPECT_EQ(run(97, {.most_iterations = 3, .tolerance = 0.0}, coarse), 3);
}

TEST(LaplacianEditor, ScalesWithTheMesh) {
  const test::Shape shape = test::body();
  const auto result = [&](double scale) -> Coordinates {
    const Positions scaled = (shape.positions.cast<double>() * scale).cast<float>();
    LaplacianEditor editor(shape.topology, view(scaled), {.tolerance = 1e-4 * scale});
    editor.set_frame(view(scaled));
    editor.deform(every(31, scaled, [&](const Vector3d& p) -> Vector3d {
      return {p.x(), p.y() + 0.2 * p.x() * p.x() / scale, p.z()};
    }));
    return editor.positions() / scale;
  };
  // Powers of two, so that rounding is the same.
  const Coordinates one = result(1.0);
  EXPECT_LT(largest_distance(result(1024.0), one), 1e-6);
  EXPECT_LT(largest_distance(result(1.0 / 1024.0), one), 1e-6);
}

TEST(LaplacianEditor, LoosePiecesGoAlongRigidly) {
  const test::Shape shape = pieces();
  const Eigen::Index ball = test::sphere(3).positions.rows();
  LaplacianEditor editor(shape.topology, view(shape.positions));
  editor.set_frame(view(shape.positions));
  // The upper half of the ball is lifted and turned, the lower held.
  std::vector<PositionConstraint> constraints;
  for (std::int32_t v = 0; v < ball; ++v) {
    const Vector3d p = shape.positions.row(v).cast<double>().transpose();
    if (p.y() > 1.7) {
      constraints.push_back(
          {.vertex = v, .target = AngleAxisd(0.5, Vector3d::UnitX()) * p + Vector3d(0.0, 0.3, 0.0)});
    } else if (p.y() < 0.3) {
      constraints.push_back({.vertex = v, .target = p});
    }
  }
  editor.deform(constraints);
  const Coordinates& x = editor.positions();
  const Coordinates before = shape.positions.cast<double>();
  for (Eigen::Index v = ball; v + 1 < x.rows(); ++v) {
    for (Eigen::Index w = ball; w < v; w += 5)
      ASSERT_NEAR((x.row(v) - x.row(w)).norm(), (before.row(v) - before.row(w)).norm(), 1e-3);
  }
  // The single vertex hovers over the top and follows it.
  EXPECT_GT((x.row(x.rows() - 1) - before.row(x.rows() - 1)).norm(), 0.1);
}

TEST(LaplacianEditor, DragsARealCapture) {
  REPRISE_REQUIRE_DATA();
  const std::filesystem::path ama = test::data_folder() / "ama";
  const Mesh reference = open_sequence({.path = ama / "crane"})->read(0);
  const Positions frame = open_sequence({.path = ama / "jumping"})->read(60).positions;
  LaplacianEditor editor(reference.topology, view(reference.positions));
  editor.set_frame(view(frame));
  std::vector<PositionConstraint> constraints;
  Eigen::Index outermost = 0;
  frame.col(0).maxCoeff(&outermost);
  for (std::int32_t v = 0; v < frame.rows(); v += 7) {
    if (frame(v, 1) < frame.col(1).minCoeff() + 0.2F)
      constraints.push_back({.vertex = v, .target = frame.row(v).cast<double>().transpose()});
  }
  constraints.push_back({.vertex = static_cast<std::int32_t>(outermost),
                         .target = frame.row(outermost).cast<double>().transpose()});
  editor.deform(constraints);
  EXPECT_LT(largest_distance(editor.positions(), frame.cast<double>()), 1e-6);
  for (const double far : {0.1, 0.3}) {
    constraints.back().target =
        frame.row(outermost).cast<double>().transpose() + far * Vector3d(-0.6, 0.0, 0.8);
    EXPECT_LT(editor.deform(constraints).largest_residual, 0.01);
    ASSERT_TRUE(editor.positions().allFinite());
    EXPECT_LT(stretch(*reference.topology, frame, editor.positions(), 0.99), 1.2) << far;
    EXPECT_GT(stretch(*reference.topology, frame, editor.positions(), 0.01), 0.8) << far;
  }
}

TEST(LaplacianEditor, BadInput) {
  const test::Shape shape = test::sphere(2);
  LaplacianEditor editor(shape.topology, view(shape.positions));
  const std::vector<PositionConstraint> hold = {{.vertex = 0, .target = Vector3d::Zero()}};

  // before a frame was set
  EXPECT_THROW(editor.deform(hold), InvalidArgument);
  // a frame of another mesh
  EXPECT_THROW(editor.set_frame(view(test::sphere(1).positions)), InvalidArgument);
  // a frame that is not finite
  Positions broken = shape.positions;
  broken(3, 1) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(editor.set_frame(view(broken)), InvalidArgument);
  editor.set_frame(view(shape.positions));
  // no constraint
  EXPECT_THROW(editor.deform({}), InvalidArgument);
  // a vertex that is not there
  EXPECT_THROW(editor.deform(std::vector<PositionConstraint>{{.vertex = 10000}}), InvalidArgument);
  // a vertex constrained twice
  EXPECT_THROW(editor.deform(std::vector<PositionConstraint>{hold[0], hold[0]}), InvalidArgument);
  // after errors all is as before
  editor.deform(hold);

  // references
  EXPECT_THROW(LaplacianEditor(nullptr, view(shape.positions)), InvalidArgument);
  EXPECT_THROW(LaplacianEditor(shape.topology, view(test::sphere(1).positions)), InvalidArgument);
  EXPECT_THROW(LaplacianEditor(shape.topology, view(broken)), InvalidArgument);
  // options
  const auto with = [&](const LaplacianEditorOptions& options) {
    return [&, options] { LaplacianEditor(shape.topology, view(shape.positions), options); };
  };
  EXPECT_THAT(with({.constraint_weight = 0.0}), ThrowsMessage<InvalidArgument>(HasSubstr("weight")));
  EXPECT_THAT(with({.most_iterations = 0}), ThrowsMessage<InvalidArgument>(HasSubstr("iterations")));
  EXPECT_THAT(with({.tolerance = -1.0}), ThrowsMessage<InvalidArgument>(HasSubstr("tolerance")));
}

}  // namespace
}  // namespace reprise
