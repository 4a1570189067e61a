// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/database/learnt_model.h"

#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/database/learnt_model_test_support.h"

namespace reprise {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

LearntModels models() {
  const std::vector<BodyPart> parts = {{.name = "torso", .parent = -1, .vertices = {0, 2, 3}},
                                       {.name = "leg", .parent = 0, .vertices = {1, 3, 4}},
                                       {.name = "foot", .parent = 1, .vertices = {3, 4}}};
  return test::learnt_models(Positions::Constant(5, 3, 0.5F), parts);
}

TEST(LearntModel, EachOfTheTwoMayBeMissing) {
  EXPECT_NO_THROW(validate(models(), 5));
  LearntModels some = models();
  EXPECT_FALSE(some.empty());
  some.part.parts.clear();
  EXPECT_NO_THROW(validate(some, 5));
  EXPECT_FALSE(some.empty());
  some.whole.parts.clear();
  EXPECT_NO_THROW(validate(some, 5));
  EXPECT_TRUE(some.empty());
  some.part = models().part;
  EXPECT_NO_THROW(validate(some, 5));
}

TEST(LearntModel, KnowsWhatItKeeps) {
  LearntPart learnt{.discarded_variance = 0.25, .total_variance = 1.0};
  EXPECT_EQ(learnt.kept_variance(), 0.75);
  learnt.discarded_variance = 0.0;
  EXPECT_EQ(learnt.kept_variance(), 1.0);
  learnt.total_variance = 0.0;  // all examples alike
  EXPECT_EQ(learnt.kept_variance(), 1.0);
}

TEST(LearntModel, SaysWhatDoesNotFit) {
  const auto expect_refused = [](const std::function<void(LearntModels&)>& spoil, const std::string& name,
                                 const std::string& what) {
    LearntModels spoilt = models();
    spoil(spoilt);
    EXPECT_THAT([&] { validate(spoilt, 5); },
                ThrowsMessage<InvalidArgument>(AllOf(HasSubstr(name), HasSubstr(what))));
  };
  // A model of nothing, or of another surface.
  EXPECT_THAT([] { validate(LearntModel{.reference = Positions::Zero(5, 3)}, 5); },
              ThrowsMessage<InvalidArgument>(HasSubstr("has no part")));
  EXPECT_THAT([] { validate(models(), 6); },
              ThrowsMessage<InvalidArgument>(HasSubstr("5 vertices; expected 6")));
  expect_refused([](LearntModels& m) { m.whole.reference(4, 1) = nan; }, "vertex 4",
                 "not at a finite position");
  // Parts.
  expect_refused([](LearntModels& m) { m.part.parts[1].part.parent = 1; }, "'leg'", "parent 1");
  expect_refused([](LearntModels& m) { m.part.parts[1].part.vertices[2] = 5; }, "'leg'", "vertex 5");
  expect_refused([](LearntModels& m) { m.whole.parts.push_back(m.whole.parts[0]); }, "body",
                 "two parts named");
  expect_refused([](LearntModels& m) { m.whole = m.part; }, "whole body", "3 parts; expected one");
  // Sizes.
  expect_refused([](LearntModels& m) { m.part.parts[1].part.vertices.pop_back(); }, "'leg'",
                 "9 entries; expected 6");
  expect_refused([](LearntModels& m) { m.part.parts[0].mean.conservativeResize(8); }, "'torso'",
                 "a mean of 8 entries; expected 9");
  expect_refused([](LearntModels& m) { m.part.parts[0].basis.conservativeResize(8, 2); }, "'torso'",
                 "shape (8, 2); expected (9, at most 9)");
  expect_refused([](LearntModels& m) { m.part.parts[0].basis = Eigen::MatrixXf::Identity(9, 10); }, "'torso'",
                 "shape (9, 10)");
  expect_refused([](LearntModels& m) { m.part.parts[0].deviations.conservativeResize(1); }, "'torso'",
                 "deviations of 1 entries; expected 2");
  expect_refused([](LearntModels& m) { m.part.parts[0].least.conservativeResize(1); }, "'torso'", "least");
  expect_refused([](LearntModels& m) { m.whole.parts[0].greatest.resize(0); }, "'body'", "greatest");
  expect_refused([](LearntModels& m) { m.part.parts[2].examples.clear(); }, "'foot'", "no example");
  expect_refused([](LearntModels& m) { m.part.parts[0].examples[1].clear(); }, "'torso'", "without a name");
  // Numbers.
  expect_refused([](LearntModels& m) { m.part.parts[2].mean[5] = nan; }, "'foot'",
                 "a mean that is not finite at 5");
  expect_refused([](LearntModels& m) { m.part.parts[1].basis(3, 0) = nan; }, "'leg'",
                 "basis that is not finite");
  expect_refused([](LearntModels& m) { m.whole.parts[0].deviations[1] = nan; }, "'body'", "deviations");
  expect_refused([](LearntModels& m) { m.whole.parts[0].deviations[1] = -0.1; }, "'body'",
                 "deviation -0.1 at 1");
  expect_refused([](LearntModels& m) { m.whole.parts[0].least[2] = 9.0; }, "'body'", "coefficients from 9");
  expect_refused([](LearntModels& m) { m.part.parts[0].total_variance = nan; }, "'torso'", "variance nan");
  expect_refused([](LearntModels& m) { m.part.parts[0].discarded_variance = -1.0; }, "'torso'",
                 "variance -1");
  // A basis whose columns are too long, or not at right angles.
  expect_refused([](LearntModels& m) { m.part.parts[0].basis.col(1) *= 1.01F; }, "'torso'",
                 "columns 1 and 1");
  expect_refused(
      [](LearntModels& m) {
        Eigen::MatrixXf& basis = m.part.parts[0].basis;
        basis.col(1) = (basis.col(0) + basis.col(1)).normalized();
      },
      "'torso'", "not orthonormal");
}

}  // namespace
}  // namespace reprise
