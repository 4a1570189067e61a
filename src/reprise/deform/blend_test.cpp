// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/blend.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/io/sequence_reader.h"
#include "support/shapes.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

PositionsView view(const Positions& positions) {
  return {positions.data(), positions.rows(), 3};
}

double largest_distance(const Positions& a, const Positions& b) {
  return std::sqrt(static_cast<double>((a - b).rowwise().squaredNorm().maxCoeff()));
}

Positions blend(const PoissonReconstruction& poisson, const Positions& source, const Positions& target,
                double alpha) {
  Positions result(source.rows(), 3);
  blend_frames(poisson, view(source), view(target), alpha, PositionsRef(result.data(), result.rows(), 3));
  return result;
}

template <typename Map>
Positions mapped(const Positions& positions, const Map& map) {
  Positions result(positions.rows(), 3);
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    const Vector3d p = positions.row(v).cast<double>().transpose();
    result.row(v) = Vector3d(map(p)).cast<float>().transpose();
  }
  return result;
}

Vector3d centroid(const Positions& positions) {
  return positions.cast<double>().colwise().mean().transpose();
}

// About the vertex centroid, because that is the point a blend moves in a straight line.
Positions rotated(const Positions& positions, const AngleAxisd& rotation) {
  const Vector3d centre = centroid(positions);
  return mapped(positions, [&](const Vector3d& p) -> Vector3d { return rotation * (p - centre) + centre; });
}

// Bar along x whose half x > 0 is bent by `angle` about z on an arc.
Positions bent(const Positions& straight, double angle) {
  return mapped(straight, [&](const Vector3d& p) -> Vector3d {
    const double s = std::max(p.x(), 0.0) * angle;
    if (p.x() <= 0.0 || angle == 0.0) return p;
    const double radius = 1.0 / angle;
    return {(radius - p.y()) * std::sin(s), radius - (radius - p.y()) * std::cos(s), p.z()};
  });
}

test::Shape bar() {
  test::Shape shape = test::sphere(3);
  shape.positions = mapped(shape.positions, [](const Vector3d& p) -> Vector3d {
    return {p.x(), 0.15 * (p.y() - 1.0), 0.15 * p.z()};
  });
  return shape;
}

// Two shapes side by side and one vertex that no triangle uses.
test::Shape two_components() {
  const test::Shape ball = test::sphere(2);
  const test::Shape cloth = test::sheet(6);
  Topology topology = *ball.topology;
  for (Triangle triangle : cloth.topology->triangles) {
    for (std::int32_t& v : triangle) v += ball.topology->vertex_count;
    topology.triangles.push_back(triangle);
  }
  topology.vertex_count += cloth.topology->vertex_count + 1;
  Positions positions(topology.vertex_count, 3);
  positions << ball.positions, cloth.positions, Eigen::RowVector3f(5.0F, 6.0F, 7.0F);
  return {std::make_shared<const Topology>(std::move(topology)), positions};
}

// A smooth deformation with bends, twists and stretches of several tens of degrees.
Positions deformed(const Positions& positions) {
  return mapped(positions, [](const Vector3d& p) -> Vector3d {
    const Vector3d bent_point(p.x() + 0.2 * std::sin(2.0 * p.y()), 1.1 * p.y(), p.z() + 0.15 * p.x() * p.x());
    return AngleAxisd(0.9 * p.y(), Vector3d(0.2, 1.0, 0.1).normalized()) * bent_point;
  });
}

std::vector<test::Shape> all_shapes() {
  return {test::sphere(3), test::sheet(12), test::body(), bar(), two_components()};
}

TEST(GradientField, PolarFactorsReproduceTheEdgesOfEveryTriangle) {
  for (const test::Shape& shape : all_shapes()) {
    const PoissonReconstruction poisson(shape.topology, view(shape.positions));
    const GradientField of_reference = poisson.gradients(view(shape.positions));
    for (const TriangleGradient& gradient : of_reference) {
      ASSERT_NEAR(gradient.R.norm(), 1.0, 1e-12);
      ASSERT_LT((gradient.S - Vector3d(1.0, 0.0, 1.0)).norm(), 1e-10) << "the reference is not stretched";
    }
    // A rotated and scaled frame has rotated R and scaled S.
    const AngleAxisd turn(1.1, Vector3d(1.0, 2.0, -1.0).normalized());
    const GradientField field = poisson.gradients(
        view(mapped(shape.positions, [&](const Vector3d& p) -> Vector3d { return 1.5 * (turn * p); })));
    for (std::size_t t = 0; t < field.size(); ++t) {
      ASSERT_LT(field[t].R.angularDistance(turn * of_reference[t].R), 1e-4);
      ASSERT_LT((field[t].S - Vector3d(1.5, 0.0, 1.5)).norm(), 1e-4);
    }
  }
}

TEST(GradientField, NormalIsTheThirdAxisOfTheRotation) {
  const test::Shape shape = test::sphere(3);
  const PoissonReconstruction poisson(shape.topology, view(shape.positions));
  const GradientField field = poisson.gradients(view(shape.positions));
  for (std::size_t t = 0; t < field.size(); ++t) {
    Vector3d middle = Vector3d::Zero();
    for (const std::int32_t v : shape.topology->triangles[t]) middle += shape.positions.row(v).cast<double>();
    const Vector3d outward = (middle / 3.0 - Vector3d(0, 1, 0)).normalized();
    ASSERT_GT((field[t].R * Vector3d::UnitZ()).dot(outward), 0.99);
  }
}

TEST(PoissonReconstruction, LaplacianIsPositiveSemiDefiniteAndHasTheConstantsInItsNullSpace) {
  for (const test::Shape& shape : all_shapes()) {
    const PoissonReconstruction poisson(shape.topology, view(shape.positions));
    const Eigen::SparseMatrix<double> L = poisson.laplacian();
    EXPECT_LT((L * Eigen::VectorXd::Ones(L.cols())).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((L - Eigen::SparseMatrix<double>(L.transpose())).norm(), 1e-12);
    for (const double frequency : {0.3, 2.0, 11.0}) {
      const Eigen::VectorXd wave =
          Eigen::VectorXd::LinSpaced(L.cols(), 0.0, frequency * static_cast<double>(L.cols())).array().sin();
      EXPECT_GT(wave.dot(L * wave), 1e-6);
    }
  }
}

TEST(PoissonReconstruction, FrameComesBackFromItsGradientsAndCentroids) {
  for (const test::Shape& shape : all_shapes()) {
    const PoissonReconstruction poisson(shape.topology, view(shape.positions));
    const Positions frame = deformed(shape.positions);
    const Eigen::MatrixX3d back =
        poisson.reconstruct(poisson.gradients(view(frame)), poisson.component_centroids(view(frame)));
    EXPECT_LT((back - frame.cast<double>()).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(PoissonReconstruction, CentroidsAreAsAskedPerComponent) {
  const test::Shape shape = two_components();
  const PoissonReconstruction poisson(shape.topology, view(shape.positions));
  Eigen::MatrixX3d wanted(3, 3);
  wanted << 1, 2, 3, -4, 5, 6, 7, 8, -9;
  const Eigen::MatrixX3d back = poisson.reconstruct(poisson.gradients(view(shape.positions)), wanted);
  const Positions result = back.cast<float>();
  EXPECT_LT((poisson.component_centroids(view(result)) - wanted).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LT((back.row(back.rows() - 1) - wanted.row(2)).norm(), 1e-12)
      << "an unreferenced vertex is its own centroid";
}

// Sum over triangles of area |F(x) - F|^2, with the gradients of the reference in its own tangent frames.
double energy(const PoissonReconstruction& poisson, const test::Shape& reference, const GradientField& wanted,
              const Eigen::MatrixX3d& x) {
  const GradientField in_reference = poisson.gradients(view(reference.positions));
  double sum = 0.0;
  for (std::size_t t = 0; t < wanted.size(); ++t) {
    const Triangle& triangle = reference.topology->triangles[t];
    const auto edges = [&](const auto& positions) {
      Eigen::Matrix<double, 3, 2> e;
      e << (positions.row(triangle[1]) - positions.row(triangle[0])).template cast<double>().transpose(),
          (positions.row(triangle[2]) - positions.row(triangle[0])).template cast<double>().transpose();
      return e;
    };
    const Eigen::Matrix<double, 3, 2> plane = in_reference[t].R.toRotationMatrix().leftCols<2>();
    const Eigen::Matrix2d flat = plane.transpose() * edges(reference.positions);
    Eigen::Matrix2d S;
    S << wanted[t].S[0], wanted[t].S[1], wanted[t].S[1], wanted[t].S[2];
    const Eigen::Matrix<double, 3, 2> F = wanted[t].R.toRotationMatrix().leftCols<2>() * S;
    sum += 0.5 * flat.determinant() * (edges(x) * flat.inverse() - F).squaredNorm();
  }
  return sum;
}

TEST(PoissonReconstruction, ResultMinimisesTheAreaWeightedEnergy) {
  const test::Shape shape = test::body();
  const PoissonReconstruction poisson(shape.topology, view(shape.positions));
  // Incompatible gradients: no surface has exactly these.
  const GradientField field = interpolate(poisson.gradients(view(shape.positions)),
                                          poisson.gradients(view(deformed(shape.positions))), 0.5);
  const Eigen::MatrixX3d x = poisson.reconstruct(field, poisson.component_centroids(view(shape.positions)));
  const double least = energy(poisson, shape, field, x);
  ASSERT_GT(least, 1e-7) << "the field must be incompatible for this test to say anything";
  // The energy is quadratic: central differences are its exact derivative, and the second difference its
  // curvature.
  constexpr double step = 1e-3;
  for (const Eigen::Index v : {0, 17, 101, 257}) {
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::MatrixX3d plus = x;
      Eigen::MatrixX3d minus = x;
      plus(v, axis) += step;
      minus(v, axis) -= step;
      const double up = energy(poisson, shape, field, plus);
      const double down = energy(poisson, shape, field, minus);
      EXPECT_GT(up, least);
      EXPECT_GT(down, least);
      EXPECT_LT(std::abs(up - down), 1e-5 * (up + down - 2.0 * least)) << "derivative at vertex " << v;
    }
  }
}

TEST(PoissonReconstruction, ResultDoesNotDependOnTheReferenceForCompatibleFields) {
  const test::Shape shape = test::body();
  const Positions frame = deformed(shape.positions);
  const PoissonReconstruction from_rest(shape.topology, view(shape.positions));
  const PoissonReconstruction from_frame(shape.topology, view(frame));
  const Positions target = rotated(frame, AngleAxisd(0.7, Vector3d::UnitY()));
  EXPECT_LT(largest_distance(blend(from_rest, frame, target, 0.4), blend(from_frame, frame, target, 0.4)),
            2e-6);
}

TEST(PoissonReconstruction, InvalidInputIsNamed) {
  const test::Shape shape = test::sphere(1);
  const auto message = [](auto&& call) -> std::string {
    try {
      call();
    } catch (const InvalidArgument& error) {
      return error.what();
    }
    return "accepted";
  };
  const PoissonReconstruction poisson(shape.topology, view(shape.positions));
  const Positions short_frame = shape.positions.topRows(5);
  Positions room = shape.positions;
  const PositionsRef out(room.data(), room.rows(), 3);
  using ::testing::HasSubstr;
  {  // no triangles
    const auto points = std::make_shared<const Topology>(Topology{.vertex_count = 18});
    EXPECT_THAT(message([&] { PoissonReconstruction(points, view(shape.positions)); }),
                HasSubstr("triangles"));
  }
  {  // reference of another size
    EXPECT_THAT(message([&] { PoissonReconstruction(shape.topology, view(short_frame)); }),
                HasSubstr("reference has 5 vertices, the topology 18"));
  }
  {  // reference not finite
    Positions broken = shape.positions;
    broken(7, 1) = std::numeric_limits<float>::infinity();
    EXPECT_THAT(message([&] { PoissonReconstruction(shape.topology, view(broken)); }),
                HasSubstr("vertex 7 "));
  }
  {  // nonsense aspect
    EXPECT_THAT(message([&] { PoissonReconstruction(shape.topology, view(shape.positions), 0.0); }),
                HasSubstr("min_aspect"));
  }
  {  // frames of another size
    EXPECT_THAT(message([&] { blend_frames(poisson, view(short_frame), view(shape.positions), 0.5, out); }),
                HasSubstr("source has 5"));
    EXPECT_THAT(message([&] { blend_frames(poisson, view(shape.positions), view(short_frame), 0.5, out); }),
                HasSubstr("target has 5"));
    EXPECT_THAT(message([&] { poisson.gradients(view(short_frame)); }), HasSubstr("5 vertices"));
  }
  {  // alpha
    for (const double alpha : {-0.01, 1.01, std::numeric_limits<double>::quiet_NaN()}) {
      EXPECT_THAT(message([&] { blend_frames(poisson, view(room), view(room), alpha, out); }),
                  HasSubstr("alpha"));
      EXPECT_THAT(message([&] { interpolate({}, {}, alpha); }), HasSubstr("alpha"));
    }
  }
  {  // fields and centroids of another size
    const GradientField field = poisson.gradients(view(shape.positions));
    EXPECT_THAT(message([&] { poisson.reconstruct({}, Eigen::MatrixX3d::Zero(1, 3)); }),
                HasSubstr("0 triangles"));
    EXPECT_THAT(message([&] { poisson.reconstruct(field, Eigen::MatrixX3d::Zero(2, 3)); }),
                HasSubstr("2 centroids"));
    EXPECT_THAT(message([&] { interpolate(field, {}, 0.5); }), HasSubstr("expected the same"));
  }
}

TEST(Blend, EndsGiveBackSourceAndTarget) {
  for (const test::Shape& shape : all_shapes()) {
    const PoissonReconstruction poisson(shape.topology, view(shape.positions));
    const Positions source = rotated(shape.positions, AngleAxisd(0.4, Vector3d::UnitX()));
    const Positions target = deformed(shape.positions);
    EXPECT_LT(largest_distance(blend(poisson, source, target, 0.0), source), 1e-6);
    EXPECT_LT(largest_distance(blend(poisson, source, target, 1.0), target), 1e-6);
  }
}

TEST(Blend, EqualFramesStayAsTheyAre) {
  for (const test::Shape& shape : all_shapes()) {
    const PoissonReconstruction poisson(shape.topology, view(shape.positions));
    const Positions frame = deformed(shape.positions);
    for (const double alpha : {0.1, 0.5, 0.9}) {
      EXPECT_LT(largest_distance(blend(poisson, frame, frame, alpha), frame), 1e-6);
    }
  }
}

TEST(Blend, OnePassEqualsInterpolatingGradientFields) {
  for (const test::Shape& shape : all_shapes()) {
    const PoissonReconstruction poisson(shape.topology, view(shape.positions));
    const Positions target = deformed(shape.positions);
    const GradientField field =
        interpolate(poisson.gradients(view(shape.positions)), poisson.gradients(view(target)), 0.3);
    const Eigen::MatrixX3d centroids = 0.7 * poisson.component_centroids(view(shape.positions)) +
                                       0.3 * poisson.component_centroids(view(target));
    const Positions expected = poisson.reconstruct(field, centroids).cast<float>();
    EXPECT_LT(largest_distance(blend(poisson, shape.positions, target, 0.3), expected), 1e-6);
  }
}

TEST(Blend, RotatedCopyGoesThroughRotationsByAlphaTimesTheAngle) {
  const test::Shape straight = bar();
  for (const test::Shape& shape :
       {test::sphere(3), test::Shape{straight.topology, bent(straight.positions, 1.2)}}) {
    const PoissonReconstruction poisson(shape.topology, view(shape.positions));
    const Vector3d axis = Vector3d(0.3, 1.0, -0.5).normalized();
    for (const double degrees : {1e-4, 1.0, 30.0, 90.0, 150.0, 179.0}) {
      const double angle = degrees * std::numbers::pi / 180.0;
      const Positions target = rotated(shape.positions, AngleAxisd(angle, axis));
      for (const double alpha : {0.125, 0.5, 0.8}) {
        EXPECT_LT(largest_distance(blend(poisson, shape.positions, target, alpha),
                                   rotated(shape.positions, AngleAxisd(alpha * angle, axis))),
                  2e-6)
            << degrees << " degrees, alpha " << alpha;
      }
    }
  }
}

TEST(Blend, BeyondHalfATurnTheShortWayRoundIsTaken) {
  const test::Shape shape = test::body();
  const PoissonReconstruction poisson(shape.topology, view(shape.positions));
  const double angle = 200.0 * std::numbers::pi / 180.0;
  const Positions target = rotated(shape.positions, AngleAxisd(angle, Vector3d::UnitY()));
  const Positions expected =
      rotated(shape.positions, AngleAxisd(0.25 * (angle - 2.0 * std::numbers::pi), Vector3d::UnitY()));
  EXPECT_LT(largest_distance(blend(poisson, shape.positions, target, 0.25), expected), 2e-6);
}

TEST(Blend, ExactlyHalfATurnIsFiniteAndMeetsBothEnds) {
  // Rounding decides per triangle which way it goes, so that the middle is torn: callers align frames first.
  const test::Shape shape = test::body();
  const PoissonReconstruction poisson(shape.topology, view(shape.positions));
  const Positions target = rotated(shape.positions, AngleAxisd(std::numbers::pi, Vector3d::UnitY()));
  EXPECT_LT(largest_distance(blend(poisson, shape.positions, target, 0.0), shape.positions), 1e-6);
  EXPECT_LT(largest_distance(blend(poisson, shape.positions, target, 1.0), target), 1e-6);
  const Positions middle = blend(poisson, shape.positions, target, 0.5);
  EXPECT_TRUE(middle.allFinite());
  EXPECT_LT(middle.cwiseAbs().maxCoeff(), 3.0F);
}

TEST(Blend, MovingBothFramesRigidlyMovesTheBlend) {
  const test::Shape shape = test::body();
  const PoissonReconstruction poisson(shape.topology, view(shape.positions));
  const Positions target = deformed(shape.positions);
  const AngleAxisd turn(2.1, Vector3d(-0.4, 1.0, 0.3).normalized());
  const auto move = [&](const Positions& frame) {
    return mapped(frame, [&](const Vector3d& p) -> Vector3d { return turn * p + Vector3d(1.0, -0.5, 2.0); });
  };
  for (const double alpha : {0.25, 0.6}) {
    EXPECT_LT(largest_distance(blend(poisson, move(shape.positions), move(target), alpha),
                               move(blend(poisson, shape.positions, target, alpha))),
              4e-6);
  }
}

TEST(Blend, SwappingTheFramesMirrorsAlpha) {
  for (const test::Shape& shape : all_shapes()) {
    const PoissonReconstruction poisson(shape.topology, view(shape.positions));
    const Positions target = deformed(shape.positions);
    for (const double alpha : {0.25, 0.3, 0.5}) {
      EXPECT_LT(largest_distance(blend(poisson, shape.positions, target, alpha),
                                 blend(poisson, target, shape.positions, 1.0 - alpha)),
                1e-6);
    }
  }
}

TEST(Blend, ScalingGoesLinearly) {
  for (const test::Shape& shape : all_shapes()) {
    const PoissonReconstruction poisson(shape.topology, view(shape.positions));
    const Positions target = mapped(shape.positions, [](const Vector3d& p) -> Vector3d { return 2.0 * p; });
    const Positions expected = mapped(shape.positions, [](const Vector3d& p) -> Vector3d { return 1.3 * p; });
    EXPECT_LT(largest_distance(blend(poisson, shape.positions, target, 0.3), expected), 2e-6);
  }
}

TEST(Blend, BendingBarKeepsItsLengthWhereVerticesMovedLinearlyLoseIt) {
  const test::Shape shape = bar();
  const PoissonReconstruction poisson(shape.topology, view(shape.positions));
  const auto length = [&](const Positions& frame) {  // along the ridge that the bend does not stretch
    double sum = 0.0;
    for (const Triangle& triangle : shape.topology->triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t a = triangle[k];
        const std::int32_t b = triangle[(k + 1) % 3];
        const bool on_ridge =
            std::abs(shape.positions(a, 1)) < 1e-6F && std::abs(shape.positions(b, 1)) < 1e-6F;
        if (on_ridge && a < b) sum += static_cast<double>((frame.row(a) - frame.row(b)).norm());
      }
    }
    return sum;
  };
  const Positions up = bent(shape.positions, 1.5);
  const Positions down = bent(shape.positions, -1.5);
  const double true_length = length(shape.positions);
  const Positions linear = 0.5F * (up + down);
  EXPECT_NEAR(length(blend(poisson, up, down, 0.5)), true_length, 0.003 * true_length);
  EXPECT_LT(length(linear), 0.9 * true_length);
}

TEST(Blend, ResultMayOverwriteAnInput) {
  const test::Shape shape = test::body();
  const PoissonReconstruction poisson(shape.topology, view(shape.positions));
  const Positions target = deformed(shape.positions);
  const Positions expected = blend(poisson, shape.positions, target, 0.4);
  Positions in_place = shape.positions;
  blend_frames(poisson, view(in_place), view(target), 0.4, PositionsRef(in_place.data(), in_place.rows(), 3));
  EXPECT_EQ(in_place, expected);
}

TEST(Blend, DegenerateTrianglesGiveFiniteFramesThatMeetBothEnds) {
  const test::Shape shape = test::body();
  const Positions collapsed_triangle = [&] {
    Positions frame = shape.positions;
    const Triangle& triangle = shape.topology->triangles[100];
    frame.row(triangle[1]) = frame.row(triangle[0]);
    frame.row(triangle[2]) = frame.row(triangle[0]);
    return frame;
  }();
  const Positions collinear_triangle = [&] {
    Positions frame = shape.positions;
    const Triangle& triangle = shape.topology->triangles[200];
    frame.row(triangle[1]) = 0.5F * (frame.row(triangle[0]) + frame.row(triangle[2]));
    return frame;
  }();
  const Positions line = mapped(shape.positions, [](const Vector3d& p) -> Vector3d {
    return {p.x(), 0.0, 0.0};
  });
  const Positions point = mapped(shape.positions, [](const Vector3d&) -> Vector3d {
    return {0.5, 0.25, 1.0};
  });
  const Positions tiny = 1e-12F * shape.positions;
  const Positions huge = 1e12F * shape.positions;
  const std::vector<Positions> frames = {
      shape.positions, collapsed_triangle, collinear_triangle, line, point, tiny};
  for (const Positions& reference :
       {shape.positions, collapsed_triangle, collinear_triangle, line, point, huge}) {
    const PoissonReconstruction poisson(shape.topology, view(reference));
    for (const Positions& source : frames) {
      for (const Positions& target : frames) {
        EXPECT_LT(largest_distance(blend(poisson, source, target, 0.0), source), 2e-5);
        EXPECT_LT(largest_distance(blend(poisson, source, target, 1.0), target), 2e-5);
        const Positions middle = blend(poisson, source, target, 0.5);
        ASSERT_TRUE(middle.allFinite());
        EXPECT_LT(middle.cwiseAbs().maxCoeff(), 20.0F);
      }
    }
  }
}

TEST(Blend, ThreadsShareOneReconstruction) {
  const test::Shape shape = test::body();
  const PoissonReconstruction poisson(shape.topology, view(shape.positions));
  const Positions target = deformed(shape.positions);
  std::vector<int> wrong(4, 0);
  std::vector<Positions> expected;
  for (int i = 0; i < 4; ++i) expected.push_back(blend(poisson, shape.positions, target, 0.2 * i));
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < 4; ++i) {
      threads.emplace_back([&, i] {
        for (int repeat = 0; repeat < 20; ++repeat) {
          wrong[i] +=
              blend(poisson, shape.positions, target, 0.2 * static_cast<double>(i)) == expected[i] ? 0 : 1;
        }
      });
    }
  }
  EXPECT_THAT(wrong, ::testing::Each(0));
}

TEST(RealData, EndsOfEveryBlendGiveBackTheCapturedFrames) {
  REPRISE_REQUIRE_DATA();
  std::vector<Positions> frames;
  TopologyPtr topology;
  for (const char* clip : {"crane", "jumping"}) {
    const auto reader = open_sequence({.path = test::data_folder() / "ama" / clip});
    topology = reader->topology();
    for (std::size_t f = 0; f < reader->frame_count(); f += 25) frames.push_back(reader->read(f).positions);
  }
  ASSERT_GE(frames.size(), 10U);
  const PoissonReconstruction poisson(topology, view(frames[0]));
  double worst = 0.0;
  double worst_before_rounding = 0.0;
  for (const Positions& source : frames) {
    const Eigen::MatrixX3d solved =
        poisson.reconstruct(poisson.gradients(view(source)), poisson.component_centroids(view(source)));
    worst_before_rounding =
        std::max(worst_before_rounding, (solved - source.cast<double>()).rowwise().norm().maxCoeff());
    for (const Positions& target : frames) {
      ASSERT_TRUE(blend(poisson, source, target, 0.5).allFinite());
      worst = std::max({worst, largest_distance(blend(poisson, source, target, 0.0), source),
                        largest_distance(blend(poisson, source, target, 1.0), target)});
    }
  }
  fmt::print("largest distance at the ends of {} blends: {:.2e} m as float, {:.2e} m before rounding\n",
             frames.size() * frames.size(), worst, worst_before_rounding);
  EXPECT_LT(worst, 1e-5);
  EXPECT_LT(worst_before_rounding, 1e-5);
}

double volume(const Topology& topology, const Positions& frame) {
  double sum = 0.0;
  for (const Triangle& triangle : topology.triangles) {
    const auto at = [&](std::size_t k) {
      return Vector3d(frame.row(triangle[k]).cast<double>().transpose());
    };
    sum += at(0).dot(at(1).cross(at(2))) / 6.0;
  }
  return sum;
}

TEST(RealData, BlendOfStronglyDifferentPosesKeepsEdgesBetterThanMovingVerticesLinearly) {
  REPRISE_REQUIRE_DATA();
  const auto crane = open_sequence({.path = test::data_folder() / "ama" / "crane"});
  const Topology& topology = *crane->topology();
  const Positions source = crane->read(20).positions;
  const Positions target =
      open_sequence({.path = test::data_folder() / "ama" / "jumping"})->read(60).positions;
  // Align on the ground: centroids, then yaw by brute force.
  const Vector3d shift = centroid(source) - centroid(target);
  double best = std::numeric_limits<double>::max();
  Positions aligned;
  for (int degrees = 0; degrees < 360; ++degrees) {
    const Positions turned =
        mapped(rotated(target, AngleAxisd(degrees * std::numbers::pi / 180.0, Vector3d::UnitY())),
               [&](const Vector3d& p) -> Vector3d { return p + Vector3d(shift.x(), 0, shift.z()); });
    const double distance = static_cast<double>((turned - source).squaredNorm());
    if (distance < best) {
      best = distance;
      aligned = turned;
    }
  }
  const PoissonReconstruction poisson(crane->topology(), view(source));
  const Positions blended = blend(poisson, source, aligned, 0.5);
  const Positions linear = 0.5F * (source + aligned);

  struct Quality {
    double mean_ratio = 0.0;  // of edge lengths to the mean of the two inputs
    std::vector<double> ratios;
    double percentile(double p) const {
      return ratios[static_cast<std::size_t>(p * double(ratios.size() - 1))];
    }
  };
  const auto quality = [&](const Positions& frame) {
    Quality result;
    double found = 0.0;
    double expected = 0.0;
    for (const Triangle& triangle : topology.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto edge = [&](const Positions& p) {
          return static_cast<double>((p.row(triangle[k]) - p.row(triangle[(k + 1) % 3])).norm());
        };
        const double mean = 0.5 * (edge(source) + edge(aligned));
        found += edge(frame);
        expected += mean;
        result.ratios.push_back(edge(frame) / mean);
      }
    }
    std::sort(result.ratios.begin(), result.ratios.end());
    result.mean_ratio = found / expected;
    return result;
  };
  const Quality ours = quality(blended);
  const Quality plain = quality(linear);
  const double mean_volume = 0.5 * (volume(topology, source) + volume(topology, aligned));
  for (const auto& [name, q, frame] :
       {std::tuple("gradient blend", ours, blended), {"linear vertices", plain, linear}}) {
    fmt::print(
        "{:16} edge ratio mean {:.4f} min {:.3f} 1% {:.3f} 99% {:.3f} max {:.3f}; volume ratio {:.4f}\n",
        name, q.mean_ratio, q.ratios.front(), q.percentile(0.01), q.percentile(0.99), q.ratios.back(),
        volume(topology, frame) / mean_volume);
  }
  EXPECT_NEAR(ours.mean_ratio, 1.0, 0.01);
  EXPECT_LT(std::abs(ours.mean_ratio - 1.0), 0.25 * std::abs(plain.mean_ratio - 1.0));
  EXPECT_GT(ours.percentile(0.01), plain.percentile(0.01));
  EXPECT_NEAR(volume(topology, blended) / mean_volume, 1.0, 0.03);
}

}  // namespace
}  // namespace reprise
