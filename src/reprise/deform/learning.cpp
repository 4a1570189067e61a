// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/learning.h"

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/core/parallel.h"
#include "reprise/deform/part_alignment.h"
#include "reprise/linalg/principal_components.h"

namespace reprise {
namespace {

// The examples of one part as Laplacian coordinates, made anew when they are wanted: thousands need no more
// memory than a few.
class ExampleRows {
 public:
  ExampleRows(const PerformanceDatabase& database, const PartHierarchy::Part& part,
              const Positions& reference, const std::vector<FrameId>& frames)
      : database_(&database),
        part_(&part),
        frames_(&frames),
        reference_(rows_of(PositionsView(reference.data(), reference.rows(), 3), part.vertices)),
        laplacian_(part_laplacian(part, reference_)) {}

  Eigen::Index size() const { return 3 * laplacian_.vertex_count(); }

  // Calls `take(row)` for one example after the other.
  template <typename Take>
  void for_each(const Take& take) const {
    constexpr std::size_t block = 64;
    std::vector<Eigen::VectorXd> rows(std::min(block, frames_->size()));
    for (std::size_t first = 0; first < frames_->size(); first += block) {
      throw_if_interrupted();
      const std::size_t count = std::min(block, frames_->size() - first);
      parallel_for(0, count, [&](std::size_t i) { rows[i] = row((*frames_)[first + i]); });
      for (std::size_t i = 0; i < count; ++i) take(rows[i]);
    }
  }

 private:
  Eigen::VectorXd row(FrameId frame) const {
    const Coordinates positions =
        rows_of(database_->clip(frame.clip_idx).frame(frame.frame_idx), part_->vertices);
    const Coordinates delta = laplacian_(align(positions, reference_).apply(positions));
    return Eigen::Map<const Eigen::VectorXd>(delta.data(), size());
  }

  const PerformanceDatabase* database_;
  const PartHierarchy::Part* part_;
  const std::vector<FrameId>* frames_;
  Coordinates reference_;
  SurfaceLaplacian laplacian_;
};

LearntPart learn_part(const PerformanceDatabase& database, const PartHierarchy::Part& part,
                      const Positions& reference, const std::vector<FrameId>& frames,
                      const LearningOptions& options) {
  const ExampleRows rows(database, part, reference, frames);
  PrincipalComponentsBuilder builder(
      {.kept_variance = options.kept_variance, .most_components = options.most_components});
  rows.for_each([&](const Eigen::VectorXd& row) { builder.add(row); });
  const PrincipalComponents components = builder.finish();

  LearntPart learnt;
  learnt.part = {.name = part.name, .parent = part.parent, .vertices = part.vertices};
  learnt.mean = components.mean.cast<float>();
  learnt.basis = components.basis.cast<float>();
  learnt.deviations = components.deviations;
  learnt.total_variance = components.total_variance;
  learnt.discarded_variance = std::max(0.0, components.total_variance - components.explained_variance);

  // Of what is stored, so that a coefficient means the same in both.
  const Eigen::VectorXd mean = learnt.mean.cast<double>();
  const Eigen::MatrixXd basis = learnt.basis.cast<double>();
  learnt.least.setZero(basis.cols());
  learnt.greatest.setZero(basis.cols());
  bool is_first = true;
  rows.for_each([&](const Eigen::VectorXd& row) {
    const Eigen::VectorXd coefficients = basis.transpose() * (row - mean);
    learnt.least = is_first ? coefficients : Eigen::VectorXd(learnt.least.cwiseMin(coefficients));
    learnt.greatest = is_first ? coefficients : Eigen::VectorXd(learnt.greatest.cwiseMax(coefficients));
    is_first = false;
  });
  for (const FrameId& frame : frames) learnt.examples.push_back(database.to_string(frame));
  return learnt;
}

}  // namespace

LearntModel learn_model(const PerformanceDatabase& database, const Positions& reference,
                        const std::vector<BodyPart>& parts, std::span<const std::vector<FrameId>> examples,
                        const LearningOptions& options) {
  if (database.empty()) throw InvalidArgument("there is no clip to learn from");
  if (examples.size() != parts.size()) {
    throw InvalidArgument(
        fmt::format("{} lists of examples for {} parts; expected one a part", examples.size(), parts.size()));
  }
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (examples[p].empty())
      throw InvalidArgument(fmt::format("part '{}' has no examples to learn from", parts[p].name));
    for (const FrameId& frame : examples[p]) database.clip(frame.clip_idx).frame(frame.frame_idx);
  }
  if (options.most_components < 0) {
    throw InvalidArgument(
        fmt::format("most_components: expected 0 or more, found {}", options.most_components));
  }
  const PartHierarchy hierarchy(database.topology(), PositionsView(reference.data(), reference.rows(), 3),
                                parts);
  LearntModel model{.reference = reference, .parts = std::vector<LearntPart>(parts.size())};
  parallel_for(0, parts.size(), [&](std::size_t p) {
    model.parts[p] =
        learn_part(database, hierarchy.part(static_cast<int>(p)), reference, examples[p], options);
  });
  validate(model, database.topology()->vertex_count);
  return model;
}

}  // namespace reprise
