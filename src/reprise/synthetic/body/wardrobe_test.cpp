// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Tailoring on shapes whose answers are known: weights, cloth laid flat, patterns, what is worn over what.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/synthetic/body/body_skinning.h"
#include "reprise/synthetic/body/garment_texture.h"
#include "reprise/synthetic/body/layer_order.h"
#include "reprise/synthetic/body/tailor.h"

namespace reprise::body {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A grid over [0, 1] x [0, 1], placed by a function.
template <typename Place>
FittedLayer sheet(int columns, int rows, const Place& place) {
  FittedLayer fitted;
  BodyLayer& layer = fitted.layer;
  layer.points.resize((columns + 1) * (rows + 1), 3);
  for (int r = 0; r <= rows; ++r) {
    for (int c = 0; c <= columns; ++c) {
      const double u = static_cast<double>(c) / columns, v = static_cast<double>(r) / rows;
      layer.points.row(r * (columns + 1) + c) = place(u, v).transpose();
      layer.uvs.push_back({static_cast<float>(u), static_cast<float>(v)});
    }
  }
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const int a = r * (columns + 1) + c, b = a + 1, d = a + columns + 1, e = d + 1;
      layer.triangles.push_back({a, b, e});
      layer.triangles.push_back({a, e, d});
    }
  }
  layer.triangle_uvs = layer.triangles;
  layer.texture = {16, 16, std::vector<std::uint8_t>(16 * 16 * 3, 128)};
  fitted.weights.assign(static_cast<std::size_t>(layer.points.rows()), gather({{0, 1.0}}));
  return fitted;
}

FittedLayer cylinder(double radius, double low, double high) {
  return sheet(48, 24, [&](double u, double v) {
    const double angle = 2.0 * std::numbers::pi * u;
    return Vector3d(radius * std::sin(angle), low + (high - low) * v, radius * std::cos(angle));
  });
}

TEST(BoneWeights, SumToOneWhateverGoesIn) {
  const BoneWeights weights = gather({{3, 0.5}, {1, 0.25}, {3, 0.5}, {4, 0.75}, {9, -0.01}});
  EXPECT_EQ(weights.bones[0], 3);
  EXPECT_DOUBLE_EQ(weights.weights[0], 0.5);
  double sum = 0.0;
  for (const double w : weights.weights) sum += w;
  EXPECT_NEAR(sum, 1.0, 1e-15);
  std::vector<std::pair<int, double>> many;
  for (int i = 0; i < 20; ++i) many.emplace_back(i, 1.0 + i);
  sum = 0.0;
  for (const double w : gather(many).weights) sum += w;
  EXPECT_NEAR(sum, 1.0, 1e-15);
  EXPECT_THROW(gather({}), InvalidArgument);
}

TEST(SkinPoints, BetweenTwoTurnsStaysOnTheCircle) {
  // Half a turn shared by two bones: linear blending would go through the axis.
  const Points rest = Eigen::RowVector3d(1.0, 0.0, 0.0);
  const std::vector<RigidTransform> bones = {
      {}, {Eigen::Quaterniond(Eigen::AngleAxisd(3.0, Vector3d::UnitY())), Vector3d::Zero()}};
  const Points half = skin_points(rest, {gather({{0, 0.5}, {1, 0.5}})}, bones);
  EXPECT_NEAR(half.row(0).norm(), 1.0, 1e-12);
  EXPECT_NEAR(std::atan2(-half(0, 2), half(0, 0)), 1.5, 1e-12);
}

TEST(ClothCoordinates, AreTrueToSizeOnWhatCanBeLaidFlat) {
  // A half cone, in texture coordinates that stretch it into a square.
  const FittedLayer cone = sheet(30, 20, [](double u, double v) {
    const double angle = std::numbers::pi * (u - 0.5), radius = 0.3 - 0.18 * v;
    return Vector3d(radius * std::sin(angle), v * 0.7, radius * std::cos(angle));
  });
  const std::vector<Vector2d> cloth = cloth_coordinates(cone.layer);
  double worst = 0.0, sum = 0.0, count = 0.0;
  for (const Triangle& t : cone.layer.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = t[k], b = t[(k + 1) % 3];
      const double flat = (cloth[static_cast<std::size_t>(a)] - cloth[static_cast<std::size_t>(b)]).norm();
      const double real = (cone.layer.points.row(a) - cone.layer.points.row(b)).norm();
      worst = std::max(worst, std::abs(flat / real - 1.0));
      sum += std::abs(flat / real - 1.0);
      count += 1.0;
    }
  }
  EXPECT_LT(worst, 0.05);
  EXPECT_LT(sum / count, 0.015);
  // Up is up in the middle, and heights agree with the body's.
  const auto middle = [&](int row) { return cloth[static_cast<std::size_t>(row * 31 + 15)]; };
  const double up = (middle(20) - middle(0)).normalized().y();
  EXPECT_NEAR(up, 1.0, 1e-3);
  EXPECT_NEAR(middle(10).x(), 0.0, 1e-3);
  EXPECT_NEAR(middle(10).y(), 0.35, 0.06);
}

TEST(PatternColor, RepeatsAtItsScale) {
  for (const auto kind : {CostumePattern::Kind::stripes, CostumePattern::Kind::bands,
                          CostumePattern::Kind::checks, CostumePattern::Kind::dots}) {
    const CostumePattern pattern{kind, {Color{255, 0, 0}, Color{0, 0, 255}}, 0.0625};
    bool differs = false;
    for (int i = 0; i < 400; ++i) {
      const Vector2d p(i / 1024.0, (7 * i % 97) / 1024.0);  // exact, so that edges fall alike
      const Vector3d color = pattern_color(pattern, p);
      EXPECT_EQ(color, pattern_color(pattern, p + Vector2d(0.0625, 0.0)));
      EXPECT_EQ(color, pattern_color(pattern, p - Vector2d(0.0, 0.125)));
      differs = differs || color != pattern_color(pattern, Vector2d::Zero());
    }
    EXPECT_TRUE(differs);
  }
}

TEST(DrawPattern, BandsFollowTheHeightAndShadeStays) {
  FittedLayer shirt = cylinder(0.1, 1.0, 1.2);
  Image& texture = shirt.layer.texture;
  for (int x = 8; x < 16; ++x) {  // darker on one half
    for (int y = 0; y < 16; ++y) std::fill_n(&texture.rgb[static_cast<std::size_t>(3 * (16 * y + x))], 3, 64);
  }
  const CostumePattern bands{CostumePattern::Kind::bands, {Color{150, 0, 0}, Color{0, 0, 150}}, 0.04};
  draw_pattern(shirt.layer, bands, 1.0, 256);
  ASSERT_EQ(texture.width, 256);
  int checked = 0;
  for (int y = 4; y < 252; ++y) {
    const double height = 1.2 - 0.2 * (y + 0.5) / 256.0;
    const double phase = height / 0.04 - std::floor(height / 0.04);
    if (std::abs(phase - 0.5) < 0.1 || phase < 0.1 || phase > 0.9) continue;
    const auto at = [&](int x, std::size_t c) {
      return static_cast<int>(texture.rgb[3 * static_cast<std::size_t>(256 * y + x) + c]);
    };
    const std::size_t on = phase < 0.5 ? 0 : 2;
    ++checked;
    EXPECT_GT(at(40, on), 150) << y;
    EXPECT_EQ(at(40, 2 - on), 0) << y;
    EXPECT_NEAR(at(40, on), 2 * at(216, on), 4) << y;
  }
  EXPECT_GT(checked, 100);
}

TEST(LayerOrder, OuterLayersAreKeptOutsideAndHideWhatTheyCover) {
  const FittedLayer body = cylinder(0.100, 0.0, 1.0);
  FittedLayer cloth = sheet(48, 24, [](double u, double v) {
    // Tight at the middle: a centimetre inside of the body.
    const double angle = 2.0 * std::numbers::pi * u, radius = 0.104 + 0.03 * std::abs(v - 0.5) - 0.012;
    return Vector3d(radius * std::sin(angle), 0.3 + 0.4 * v, radius * std::cos(angle));
  });
  keep_outside(cloth, body, 0.004, {});
  double least = 1e9;
  for (Eigen::Index v = 0; v < cloth.layer.points.rows(); ++v) {
    least = std::min(least, std::hypot(cloth.layer.points(v, 0), cloth.layer.points(v, 2)));
  }
  EXPECT_GT(least, 0.1035);

  const std::vector<bool> hidden = hidden_under(body, cloth);
  ASSERT_EQ(hidden.size(), body.layer.triangles.size());
  for (std::size_t t = 0; t < hidden.size(); ++t) {
    double height = 0.0;
    for (const std::int32_t corner : body.layer.triangles[t]) height += body.layer.points(corner, 1) / 3.0;
    // The sheet is open along a seam at the back, where it does not hide.
    const std::int32_t corner = body.layer.triangles[t][0];
    const bool at_seam = corner % 49 < 4 || corner % 49 > 44;
    if (height < 0.29 || height > 0.71) {
      EXPECT_FALSE(hidden[t]) << height;
    }
    if (height > 0.40 && height < 0.60 && !at_seam) {
      EXPECT_TRUE(hidden[t]) << height;
    }
  }
  // What may swing away hides nothing.
  cloth.layer.freedom.assign(static_cast<std::size_t>(cloth.layer.points.rows()), 1.0);
  for (const bool is_hidden : hidden_under(body, cloth)) ASSERT_FALSE(is_hidden);
}

TEST(FittedLayer, SewingJoinsOnlyBordersThatMeet) {
  // Two half sheets that share a line of equal places.
  FittedLayer cut = sheet(4, 4, [](double u, double v) { return Vector3d(u, v, 0.0); });
  const FittedLayer other = sheet(4, 4, [](double u, double v) { return Vector3d(1.0 + u, v, 0.0); });
  const auto offset = static_cast<std::int32_t>(cut.layer.points.rows());
  Points both(2 * offset, 3);
  both << cut.layer.points, other.layer.points;
  cut.layer.points = both;
  for (const Triangle& t : other.layer.triangles) {
    cut.layer.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
    cut.layer.triangle_uvs.push_back(t);
  }
  cut.weights.insert(cut.weights.end(), other.weights.begin(), other.weights.end());
  sew(cut);
  EXPECT_EQ(cut.layer.points.rows(), 2 * offset - 5);
  EXPECT_EQ(cut.layer.triangles.size(), 64U);
  const Topology topology{
      static_cast<std::int32_t>(cut.layer.points.rows()), cut.layer.triangles, {}, {}, {}};
  EXPECT_EQ(connected_components(topology).count, 1);
}

TEST(FittedLayer, RefiningSplitsWhereClothIsFreeAndKeepsItsShape) {
  FittedLayer skirt = sheet(6, 6, [](double u, double v) { return Vector3d(u, v, 0.0); });
  skirt.layer.freedom = freedom_by_height(skirt.layer.points, {.from = 0.5, .to = 0.2, .most = 1.0});
  refine(skirt, 0.06);
  double area = 0.0, longest = 0.0;
  for (const Triangle& t : skirt.layer.triangles) {
    const Vector3d a = skirt.layer.points.row(t[0]), b = skirt.layer.points.row(t[1]),
                   c = skirt.layer.points.row(t[2]);
    EXPECT_GT((b - a).cross(c - a).z(), 0.0);
    area += 0.5 * (b - a).cross(c - a).norm();
    if (std::max({a.y(), b.y(), c.y()}) < 0.3) {
      longest = std::max({longest, (a - b).norm(), (b - c).norm(), (c - a).norm()});
    }
  }
  EXPECT_NEAR(area, 1.0, 1e-12);
  EXPECT_GT(longest, 0.0);
  EXPECT_LE(longest, 0.06);
  EXPECT_EQ(skirt.weights.size(), static_cast<std::size_t>(skirt.layer.points.rows()));
  EXPECT_EQ(skirt.layer.freedom.size(), skirt.weights.size());
}

}  // namespace
}  // namespace reprise::body
