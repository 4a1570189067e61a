// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Learnt models with every kind of number in them, for tests of what keeps them.

#pragma once

#include <random>
#include <string>

#include <gtest/gtest.h>

#include "reprise/database/body_parts.h"
#include "reprise/database/learnt_model.h"

namespace reprise::test {

// A part with `components` random orthonormal components and as many examples, at least one.
inline LearntPart learnt_part(BodyPart part, Eigen::Index components, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0.0F, 0.01F);
  const Eigen::Index size = 3 * static_cast<Eigen::Index>(part.vertices.size());
  LearntPart learnt{.part = std::move(part)};
  learnt.mean = Eigen::VectorXf::NullaryExpr(size, [&] { return normal(random); });
  learnt.basis = Eigen::MatrixXf::NullaryExpr(size, components, [&] { return normal(random); });
  for (Eigen::Index k = 0; k < components; ++k) {
    for (Eigen::Index before = 0; before < k; ++before) {
      learnt.basis.col(k) -= learnt.basis.col(before).dot(learnt.basis.col(k)) * learnt.basis.col(before);
    }
    learnt.basis.col(k).normalize();
  }
  learnt.deviations = Eigen::VectorXd::LinSpaced(components, 1.0 / 3.0, 0.1);
  learnt.least = -2.0 * learnt.deviations;
  learnt.greatest = 7.0 / 3.0 * learnt.deviations;
  learnt.discarded_variance = 1e-3 / 7.0;
  learnt.total_variance = learnt.deviations.squaredNorm() + learnt.discarded_variance;
  for (Eigen::Index e = 0; e < std::max<Eigen::Index>(components, 1); ++e) {
    learnt.examples.push_back("walk:" + std::to_string(7 * e));
  }
  return learnt;
}

// Of the parts 2, 1 and 0 components alternate; of the whole 3.
inline LearntModels learnt_models(const Positions& reference, const std::vector<BodyPart>& parts) {
  LearntModels models{.part = {.reference = reference}, .whole = {.reference = reference}};
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const auto components = static_cast<Eigen::Index>(2 - p % 3);
    models.part.parts.push_back(learnt_part(parts[p], components, static_cast<std::uint32_t>(p)));
  }
  const auto vertex_count = static_cast<std::int32_t>(reference.rows());
  models.whole.parts.push_back(learnt_part(whole_body_part(vertex_count), 3, 100));
  return models;
}

// To the last bit.
inline void expect_equal(const LearntModel& a, const LearntModel& b) {
  ASSERT_EQ(a.parts.size(), b.parts.size());
  EXPECT_EQ(a.reference, b.reference);
  for (std::size_t p = 0; p < a.parts.size(); ++p) {
    const LearntPart& m = a.parts[p];
    const LearntPart& n = b.parts[p];
    EXPECT_EQ(m.part.name, n.part.name);
    EXPECT_EQ(m.part.parent, n.part.parent);
    EXPECT_EQ(m.part.vertices, n.part.vertices);
    EXPECT_EQ(m.mean, n.mean);
    EXPECT_EQ(m.basis, n.basis);
    EXPECT_EQ(m.deviations, n.deviations);
    EXPECT_EQ(m.least, n.least);
    EXPECT_EQ(m.greatest, n.greatest);
    EXPECT_EQ(m.discarded_variance, n.discarded_variance);
    EXPECT_EQ(m.total_variance, n.total_variance);
    EXPECT_EQ(m.examples, n.examples);
  }
}

inline void expect_equal(const LearntModels& a, const LearntModels& b) {
  expect_equal(a.part, b.part);
  expect_equal(a.whole, b.whole);
}

}  // namespace reprise::test
