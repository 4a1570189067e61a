// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/database/learnt_model.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

[[noreturn]] void refuse(const LearntPart& learnt, const std::string& what) {
  throw InvalidArgument(fmt::format("the learnt part '{}' {}", learnt.part.name, what));
}

template <typename Vector>
void check_vector(const LearntPart& learnt, std::string_view what, const Vector& values, Eigen::Index size) {
  if (values.size() != size) {
    refuse(learnt, fmt::format("has {} of {} entries; expected {}", what, values.size(), size));
  }
  for (Eigen::Index i = 0; i < size; ++i) {
    if (!std::isfinite(values[i])) refuse(learnt, fmt::format("has {} that is not finite at {}", what, i));
  }
}

void check_basis(const LearntPart& learnt, Eigen::Index size) {
  const Eigen::MatrixXf& basis = learnt.basis;
  if (basis.rows() != size || basis.cols() > size) {
    refuse(learnt, fmt::format("has a basis of shape ({}, {}); expected ({}, at most {})", basis.rows(),
                               basis.cols(), size, size));
  }
  if (basis.cols() == 0) return;
  if (!basis.allFinite()) refuse(learnt, "has a basis that is not finite");
  // Solves take the columns as orthonormal; single precision keeps 1e-6 of that.
  constexpr float tolerance = 1e-3F;
  const Eigen::MatrixXf products = basis.transpose() * basis;
  const auto off = (products - Eigen::MatrixXf::Identity(basis.cols(), basis.cols())).cwiseAbs();
  Eigen::Index row = 0;
  Eigen::Index column = 0;
  if (off.maxCoeff(&row, &column) <= tolerance) return;
  refuse(learnt, fmt::format("has a basis that is not orthonormal: columns {} and {} multiply to {}", row,
                             column, products(row, column)));
}

void check_statistics(const LearntPart& learnt) {
  const Eigen::Index l = learnt.component_count();
  check_vector(learnt, "deviations", learnt.deviations, l);
  check_vector(learnt, "least coefficients", learnt.least, l);
  check_vector(learnt, "greatest coefficients", learnt.greatest, l);
  for (Eigen::Index i = 0; i < l; ++i) {
    if (learnt.deviations[i] < 0.0) {
      refuse(learnt, fmt::format("has the deviation {} at {}", learnt.deviations[i], i));
    }
    if (learnt.least[i] > learnt.greatest[i]) {
      refuse(learnt,
             fmt::format("has coefficients from {} to {} at {}", learnt.least[i], learnt.greatest[i], i));
    }
  }
  for (const double variance : {learnt.discarded_variance, learnt.total_variance}) {
    if (!std::isfinite(variance) || variance < 0.0)
      refuse(learnt, fmt::format("has the variance {}", variance));
  }
}

}  // namespace

double LearntPart::kept_variance() const {
  if (total_variance <= 0.0) return 1.0;
  return std::clamp(1.0 - discarded_variance / total_variance, 0.0, 1.0);
}

void validate(const LearntModel& model, std::int32_t vertex_count) {
  if (model.parts.empty()) throw InvalidArgument("the learnt model has no part");
  if (model.reference.rows() != vertex_count) {
    throw InvalidArgument(
        fmt::format("the reference surface of the learnt model has {} vertices; expected {}",
                    model.reference.rows(), vertex_count));
  }
  for (Eigen::Index v = 0; v < model.reference.rows(); ++v) {
    if (!model.reference.row(v).allFinite()) {
      throw InvalidArgument(
          fmt::format("vertex {} of the learnt model's reference surface is not at a finite position", v));
    }
  }
  std::vector<BodyPart> parts;
  for (const LearntPart& learnt : model.parts) parts.push_back(learnt.part);
  validate(parts, vertex_count);
  for (const LearntPart& learnt : model.parts) {
    const Eigen::Index size = 3 * static_cast<Eigen::Index>(learnt.part.vertices.size());
    check_vector(learnt, "a mean", learnt.mean, size);
    check_basis(learnt, size);
    check_statistics(learnt);
    if (learnt.examples.empty()) refuse(learnt, "names no example");
    if (std::ranges::count(learnt.examples, std::string()) > 0)
      refuse(learnt, "names an example without a name");
  }
}

void validate(const LearntModels& models, std::int32_t vertex_count) {
  if (!models.part.parts.empty()) validate(models.part, vertex_count);
  if (models.whole.parts.empty()) return;
  validate(models.whole, vertex_count);
  if (models.whole.parts.size() > 1) {
    throw InvalidArgument(
        fmt::format("the model of the whole body has {} parts; expected one", models.whole.parts.size()));
  }
}

}  // namespace reprise
