// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/position_constraint.h"

#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

std::string refusal(const std::vector<PositionConstraint>& constraints) {
  try {
    validate(constraints, 10);
  } catch (const InvalidArgument& error) {
    return error.what();
  }
  return "";
}

TEST(PositionConstraint, NoneAndAllVerticesAreValid) {
  std::vector<PositionConstraint> constraints;
  EXPECT_EQ(refusal(constraints), "");
  for (std::int32_t v = 9; v >= 0; --v) constraints.push_back({.vertex = v, .target = {1e9, 0, 0}});
  EXPECT_EQ(refusal(constraints), "");
}

TEST(PositionConstraint, RefusesVerticesOutOfRange) {
  using testing::HasSubstr;
  EXPECT_THAT(refusal({{.vertex = 1}, {.vertex = 10}}), HasSubstr("constraint 1 is on vertex 10"));
  EXPECT_THAT(refusal({{.vertex = -1}}), HasSubstr("expected 0 to 9"));
  EXPECT_THROW(validate(std::vector<PositionConstraint>{{.vertex = 0}}, 0), InvalidArgument);
}

TEST(PositionConstraint, RefusesAVertexTwice) {
  EXPECT_THAT(refusal({{.vertex = 4}, {.vertex = 3}, {.vertex = 4}}),
              testing::HasSubstr("constraints 0 and 2 are both on vertex 4"));
}

TEST(PositionConstraint, RefusesTargetsThatAreNotFinite) {
  EXPECT_THAT(refusal({{.vertex = 2, .target = {0, nan, 0}}}), testing::HasSubstr("vertex 2"));
  EXPECT_THAT(refusal({{.vertex = 2, .target = {0, 0, -infinity}}}), testing::HasSubstr("not finite"));
}

TEST(PositionConstraint, RefusesWeightsThatAreNotPositiveAndFinite) {
  for (const double weight : {0.0, -1.0, nan, infinity}) {
    EXPECT_THAT(refusal({{.vertex = 0, .target = {0, 0, 0}, .weight = weight}}), testing::HasSubstr("weight"))
        << weight;
  }
}

}  // namespace
}  // namespace reprise
