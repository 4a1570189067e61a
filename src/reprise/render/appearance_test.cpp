// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What is drawn on the surface: textures, colours, soft light.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/render/camera.h"
#include "reprise/render/openness.h"
#include "reprise/render/renderer.h"
#include "support/shapes.h"

namespace reprise {
namespace {

constexpr RenderOptions small = {.width = 320, .height = 180};

MeshSequence still(const TopologyPtr& topology, const Positions& positions) {
  MeshSequence sequence("still", topology, 1, 25.0);
  sequence.frame(0) = positions;
  return sequence;
}

Image plain_image(int width, int height, Color color) {
  Image image{.width = width, .height = height};
  for (int i = 0; i < width * height; ++i) image.rgb.insert(image.rgb.end(), color.begin(), color.end());
  return image;
}

using UvOf = std::array<float, 2> (*)(const Eigen::Vector3f& corner, const Eigen::Vector3f& triangle_middle);

// A texture coordinate for every corner of every triangle.
TopologyPtr textured(const test::Shape& shape, const Image& image, UvOf uv_of) {
  Topology topology = *shape.topology;
  const auto at = [&](std::int32_t v) { return Eigen::Vector3f(shape.positions.row(v).transpose()); };
  for (const Triangle& t : topology.triangles) {
    const Eigen::Vector3f middle = (at(t[0]) + at(t[1]) + at(t[2])) / 3.0F;
    const auto first = static_cast<std::int32_t>(topology.uvs.size());
    for (const std::int32_t v : t) topology.uvs.push_back(uv_of(at(v), middle));
    topology.triangle_uvs.push_back({first, first + 1, first + 2});
  }
  topology.texture = std::make_shared<const Image>(image);
  return std::make_shared<const Topology>(std::move(topology));
}

Color pixel(const Image& image, int x, int y) {
  const std::size_t i =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
  return {image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]};
}

// Where a point of the world is in the picture.
Eigen::Vector2d place(const CameraPath& path, const RenderOptions& options, const Eigen::Vector3d& point) {
  const View view = path.view(0);
  const Eigen::Vector3d p = point - view.eye;
  const Eigen::Vector2d slope = Eigen::Vector2d(view.right.dot(p), view.up.dot(p)) / view.forward.dot(p);
  const Eigen::Vector2d unit =
      (slope - path.tan_middle())
          .cwiseQuotient(Eigen::Vector2d(path.tan_half_width(), path.tan_half_height()));
  return {0.5 * (1.0 + unit.x()) * options.width, 0.5 * (1.0 - unit.y()) * options.height};
}

double mean_difference(const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) sum += std::abs(int{a.rgb[i]} - int{b.rgb[i]});
  return sum / static_cast<double>(a.rgb.size());
}

int largest_difference(const Image& a, const Image& b) {
  int largest = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i)
    largest = std::max(largest, std::abs(int{a.rgb[i]} - int{b.rgb[i]}));
  return largest;
}

TEST(Texture, ItsColoursAppearWhereItsCoordinatesSay) {
  // The sheet spans x and z from 0 to 1; texture coordinates have their origin at the bottom left.
  Image image{.width = 8, .height = 8};
  for (int row = 0; row < 8; ++row) {
    for (int column = 0; column < 8; ++column) {
      image.rgb.push_back(column < 4 ? 210 : 20);
      image.rgb.push_back(row < 4 ? 210 : 20);
      image.rgb.push_back(20);
    }
  }
  const test::Shape shape = test::sheet(4);
  const TopologyPtr topology = textured(shape, image, [](const Eigen::Vector3f& p, const Eigen::Vector3f&) {
    return std::array<float, 2>{p.x(), p.z()};
  });
  const MeshSequence sequence = still(topology, shape.positions);
  for (const double pitch : {80.0, 40.0}) {
    for (const double yaw : {0.0, 35.0, 200.0}) {
      RenderOptions options = small;
      options.camera_pitch_degrees = pitch;
      options.camera_yaw_degrees = yaw;
      const CameraPath path(sequence, options);
      const Image drawn = SequenceRenderer(sequence, options).draw(0);
      for (const float x : {0.1F, 0.4F, 0.6F, 0.9F}) {
        for (const float z : {0.1F, 0.4F, 0.6F, 0.9F}) {
          const Eigen::Vector2d at = place(path, options, {x, 0.0, z});
          const Color c = pixel(drawn, static_cast<int>(at.x()), static_cast<int>(at.y()));
          EXPECT_EQ(c[0] > c[2] + 60, x < 0.5F) << x << ", " << z << " yaw " << yaw;
          EXPECT_EQ(c[1] > c[2] + 60, z > 0.5F) << x << ", " << z << " yaw " << yaw;
        }
      }
    }
  }
}

// Up to two steps: drivers decode sRGB textures by approximations of their own.
TEST(Texture, IsLitLikeVertexColoursOfTheSameColour) {
  const test::Shape shape = test::sphere(4);
  const UvOf middle = [](const Eigen::Vector3f&, const Eigen::Vector3f&) {
    return std::array<float, 2>{0.5F, 0.5F};
  };
  for (const Color color : {Color{200, 60, 20}, Color{30, 90, 120}, Color{128, 128, 128}}) {
    const MeshSequence with_texture =
        still(textured(shape, plain_image(5, 3, color), middle), shape.positions);
    MeshSequence with_colors = still(shape.topology, shape.positions);
    with_colors.set_colors(std::vector<Color>(with_colors.vertex_count(), color));
    EXPECT_LE(largest_difference(SequenceRenderer(with_texture, small).draw(0),
                                 SequenceRenderer(with_colors, small).draw(0)),
              2);
  }
}

TEST(Texture, ASeamInItsCoordinatesCannotBeSeen) {
  const test::Shape shape = test::sphere(3);
  const Image image = plain_image(64, 64, {190, 170, 150});
  const UvOf whole = [](const Eigen::Vector3f& p, const Eigen::Vector3f&) {
    return std::array<float, 2>{0.5F + 0.2F * p.x(), 0.2F + 0.2F * p.y()};
  };
  // Two halves that lie apart in the texture.
  const UvOf halves = [](const Eigen::Vector3f& p, const Eigen::Vector3f& middle) {
    const float shift = middle.x() > middle.z() ? 0.4F : 0.0F;
    return std::array<float, 2>{shift + 0.2F + 0.15F * p.x(), shift + 0.15F * p.y()};
  };
  const MeshSequence uncut = still(textured(shape, image, whole), shape.positions);
  const MeshSequence cut = still(textured(shape, image, halves), shape.positions);
  EXPECT_LE(largest_difference(SequenceRenderer(cut, small).draw(0), SequenceRenderer(uncut, small).draw(0)),
            1);
}

TEST(Texture, FineStripesSeenFromFarTurnIntoTheirMeanInLinearLight) {
  Image stripes{.width = 512, .height = 512};
  for (int i = 0; i < 512 * 512; ++i) stripes.rgb.insert(stripes.rgb.end(), 3, i % 2 == 0 ? 0 : 255);
  const UvOf over_it = [](const Eigen::Vector3f& p, const Eigen::Vector3f&) {
    return std::array<float, 2>{4.0F * p.x(), 4.0F * p.z()};
  };
  const test::Shape shape = test::sheet(4);
  RenderOptions options = small;
  options.camera_pitch_degrees = 80.0;
  const Image drawn =
      SequenceRenderer(still(textured(shape, stripes, over_it), shape.positions), options).draw(0);
  // Half of the light is sRGB 188, not 128.
  const Image grey =
      SequenceRenderer(still(textured(shape, plain_image(4, 4, {188, 188, 188}), over_it), shape.positions),
                       options)
          .draw(0);
  EXPECT_LT(mean_difference(drawn, grey), 1.0);
}

TEST(Appearance, IsChosenAmongWhatThereIs) {
  const test::Shape shape = test::sphere(3);
  const TopologyPtr topology =
      textured(shape, plain_image(4, 4, {20, 200, 20}), [](const Eigen::Vector3f&, const Eigen::Vector3f&) {
        return std::array<float, 2>{0.5F, 0.5F};
      });
  MeshSequence both = still(topology, shape.positions);
  both.set_colors(std::vector<Color>(both.vertex_count(), Color{200, 20, 20}));
  MeshSequence colored = still(shape.topology, shape.positions);
  colored.set_colors(std::vector<Color>(colored.vertex_count(), Color{200, 20, 20}));
  const MeshSequence bare = still(shape.topology, shape.positions);
  const auto middle = [](const MeshSequence& sequence, Appearance appearance) {
    RenderOptions options = small;
    options.appearance = appearance;
    options.surface_color = {20, 20, 200};
    const Color c = pixel(SequenceRenderer(sequence, options).draw(0), 160, 90);
    return std::max_element(c.begin(), c.end()) - c.begin();
  };
  EXPECT_EQ(middle(both, Appearance::automatic), 1);
  EXPECT_EQ(middle(both, Appearance::texture), 1);
  EXPECT_EQ(middle(both, Appearance::vertex_colors), 0);
  EXPECT_EQ(middle(both, Appearance::plain), 2);
  EXPECT_EQ(middle(colored, Appearance::automatic), 0);
  EXPECT_EQ(middle(bare, Appearance::automatic), 2);
  EXPECT_THROW(middle(colored, Appearance::texture), InvalidArgument);
  EXPECT_THROW(middle(bare, Appearance::vertex_colors), InvalidArgument);
}

TEST(Appearance, ASurfaceThatIsInsideOutIsLitLikeTheSameOneTheRightWayRound) {
  const test::Shape shape = test::body();
  Topology reversed = *shape.topology;
  for (Triangle& t : reversed.triangles) std::swap(t[1], t[2]);
  const Image right = SequenceRenderer(still(shape.topology, shape.positions), small).draw(0);
  const Image wrong =
      SequenceRenderer(still(std::make_shared<const Topology>(reversed), shape.positions), small).draw(0);
  EXPECT_LT(mean_difference(right, wrong), 0.05);
}

TEST(Zoom, EnlargesThePictureAboutThePlaceLookedAt) {
  const test::Shape shape = test::sphere(4);
  const MeshSequence ball = still(shape.topology, shape.positions);
  for (const CameraMode mode : {CameraMode::follow, CameraMode::fixed, CameraMode::side}) {
    RenderOptions options = small;
    options.camera = mode;
    const CameraPath whole(ball, options);
    options.zoom = 5.0;
    options.look_at = {0.2, 0.7};
    const CameraPath close(ball, options);
    const Image image = SequenceRenderer(ball, options).draw(0);
    const Eigen::Vector2d middle(160.0, 90.0);
    // The ball's outline is 1 high, whatever the angle: 0.74 of the picture.
    const Eigen::Vector2d looked_at(160.0 + 0.2 * 0.74 * 180.0, 90.0 - 0.2 * 0.74 * 180.0);
    for (const Eigen::Vector3d& point : {Eigen::Vector3d(0.1, 1.3, 0.5), Eigen::Vector3d(0.0, 0.0, 0.0)}) {
      const Eigen::Vector2d expected = middle + 5.0 * (place(whole, small, point) - looked_at);
      EXPECT_LT((place(close, options, point) - expected).norm(), 1.0);
    }
    // All of the picture shows the ball.
    EXPECT_LT(int{pixel(image, 5, 175)[2]}, 190);
    EXPECT_LT(int{pixel(image, 150, 90)[2]}, 190);
  }
  RenderOptions options = small;
  options.zoom = 0.5;
  EXPECT_THROW(SequenceRenderer(ball, options), InvalidArgument);
  options.zoom = NAN;
  EXPECT_THROW(SequenceRenderer(ball, options), InvalidArgument);
  options = small;
  options.look_at = {0.0, INFINITY};
  EXPECT_THROW(SequenceRenderer(ball, options), InvalidArgument);
}

TEST(Zoom, DrawsWhatTheWholePictureShowsThere) {
  const MeshSequence clip = test::walk("walk", 3);
  RenderOptions large = {.width = 1280, .height = 720};
  const Image whole = SequenceRenderer(clip, large).draw(1);
  RenderOptions options = small;
  options.zoom = 4.0;
  const Image close = SequenceRenderer(clip, options).draw(1);
  // The middle 320 x 180 of the large picture.
  Image middle{.width = 320, .height = 180};
  for (int y = 0; y < 180; ++y) {
    for (int x = 0; x < 320; ++x) {
      const Color c = pixel(whole, x + 480, y + 270);
      middle.rgb.insert(middle.rgb.end(), c.begin(), c.end());
    }
  }
  EXPECT_LT(mean_difference(close, middle), 0.5);
}

std::vector<Openness> openness_of(const test::Shape& shape) {
  const PositionsView positions(shape.positions.data(), shape.positions.rows(), 3);
  const Positions normals = vertex_normals(*shape.topology, positions);
  return openness(*shape.topology, positions, PositionsView(normals.data(), normals.rows(), 3));
}

test::Shape turned(test::Shape shape, const Eigen::Quaternionf& turn) {
  for (Eigen::Index v = 0; v < shape.positions.rows(); ++v)
    shape.positions.row(v) = (turn * shape.positions.row(v).transpose()).transpose().eval();
  return shape;
}

TEST(Openness, ALoneConvexBodySeesEverything) {
  for (const float angle : {0.0F, 0.7F, 2.0F}) {
    const Eigen::Quaternionf turn(Eigen::AngleAxisf(angle, Eigen::Vector3f(1, 2, -1).normalized()));
    for (const Openness& open : openness_of(turned(test::sphere(4), turn))) {
      EXPECT_GT(open.front, 0.97F);
      EXPECT_LT(open.back, 0.03F);
    }
  }
}

TEST(Openness, BetweenTwoSheetsItIsOneLessTheirViewFactor) {
  // From the middle of one unit square to all of another one above it (Howell, factor B-4 by four quarters).
  for (const float gap : {0.25F, 0.5F, 1.0F}) {
    const double a = 0.5 / gap;
    const double root = std::sqrt(1.0 + a * a);
    const double factor = 4.0 / (2.0 * std::numbers::pi) * (2.0 * a / root * std::atan(a / root));
    test::Shape shape = test::sheet(20);
    Topology topology = *shape.topology;
    const std::int32_t count = topology.vertex_count;
    topology.vertex_count *= 2;
    for (const Triangle& t : shape.topology->triangles)
      topology.triangles.push_back({t[0] + count, t[1] + count, t[2] + count});
    Positions positions(2 * count, 3);
    positions << shape.positions, shape.positions.rowwise() + Eigen::RowVector3f(0.0F, gap, 0.0F);
    shape = {std::make_shared<const Topology>(std::move(topology)), std::move(positions)};
    double mean = 0.0;
    constexpr int turns = 24;
    for (int i = 0; i < turns; ++i) {
      const auto angle = 0.9F * static_cast<float>(i);
      const Eigen::Vector3f axis(std::sin(angle), std::cos(1.7F * angle), 0.3F);
      const Eigen::Quaternionf turn(Eigen::AngleAxisf(angle, axis.normalized()));
      const std::vector<Openness> open = openness_of(turned(shape, turn));
      // Twelve directions a side are coarse; their error has no preferred sign.
      EXPECT_NEAR(open[220].front, 1.0 - factor, 0.26) << "gap " << gap << " turn " << i;
      EXPECT_NEAR(open[220 + 441].back, 1.0 - factor, 0.26) << "gap " << gap << " turn " << i;
      EXPECT_GT(open[220].back, 0.97F);
      EXPECT_GT(open[220 + 441].front, 0.97F);
      mean += static_cast<double>(open[220].front) / turns;
    }
    EXPECT_NEAR(mean, 1.0 - factor, 0.05) << "gap " << gap;
  }
}

TEST(Openness, BrokenCoordinatesHarmNobodyElse) {
  test::Shape shape = test::sphere(2);
  shape.positions.row(7).setConstant(std::numeric_limits<float>::quiet_NaN());
  const std::vector<Openness> open = openness_of(shape);
  EXPECT_EQ(open[7].front, 1.0F);
  for (const Openness& value : open) {
    EXPECT_TRUE(value.front >= 0.0F && value.front <= 1.0F);
    EXPECT_TRUE(value.back >= 0.0F && value.back <= 1.0F);
  }
}

TEST(SurfaceSides, TellClosedOpenAndInsideOutApart) {
  const test::Shape ball = test::sphere(1);
  Topology topology = *ball.topology;
  const std::int32_t count = topology.vertex_count;
  // Beside it the same ball inside out, and one with a hole.
  for (const Triangle& t : ball.topology->triangles)
    topology.triangles.push_back({t[0] + count, t[2] + count, t[1] + count});
  for (const Triangle& t : ball.topology->triangles)
    topology.triangles.push_back({t[0] + 2 * count, t[1] + 2 * count, t[2] + 2 * count});
  topology.triangles.pop_back();
  topology.vertex_count *= 3;
  Positions positions(3 * count, 3);
  positions << ball.positions, ball.positions.rowwise() + Eigen::RowVector3f(3, 0, 0),
      ball.positions.rowwise() + Eigen::RowVector3f(6, 0, 0);
  const std::vector<SurfaceSide> sides =
      surface_sides(topology, PositionsView(positions.data(), positions.rows(), 3));
  for (std::int32_t v = 0; v < count; ++v) {
    EXPECT_EQ(sides[static_cast<std::size_t>(v)], SurfaceSide::normal);
    EXPECT_EQ(sides[static_cast<std::size_t>(v + count)], SurfaceSide::opposite);
    EXPECT_EQ(sides[static_cast<std::size_t>(v + 2 * count)], SurfaceSide::both);
  }
}

}  // namespace
}  // namespace reprise
