// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The trials of `evaluate_deformation`.

#pragma once

#include <memory>
#include <string>
#include <vector>

#include "reprise/editing/editor_factory.h"
#include "reprise/pipeline/evaluate_deformation.h"

namespace reprise {

// A frame to be reproduced, of a database that stays.
struct HeldFrame {
  const PerformanceDatabase* database = nullptr;
  FrameId id;
  std::string name;

  PositionsView positions() const { return database->clip(id.clip_idx).frame(id.frame_idx); }
};

// The models of a performer, ready to be tried. All methods are thread-safe.
class DeformationBench {
 public:
  // `learnt`: only clips that are learnt from, with the models; must outlive the bench. `models`: of
  // `deformation_models`. Makes each once, to hear what is wrong. Throws as `EditorFactory::make`.
  DeformationBench(const PerformanceDatabase& learnt, std::vector<std::string> models,
                   const std::vector<std::size_t>& constraints);

  const PerformanceDatabase& learnt() const { return learnt_; }
  const std::vector<std::string>& models() const { return models_; }
  const TrialMeter& meter() const { return *meter_; }

  std::unique_ptr<SurfaceEditor> make(const std::string& model) const;
  // Gives the editor a learnt frame to edit.
  void set_frame(SurfaceEditor& editor, const std::string& model, FrameId frame) const;
  // Of a held frame; the first `count` of the spread vertices.
  std::vector<PositionConstraint> constraints(const HeldFrame& frame, std::size_t count) const;
  FrameId source_frame(DeformationSource source, std::span<const PositionConstraint> constraints) const;

  // All trials: of each frame, of each number of constraints, of each source, of each model. Parallel.
  std::vector<DeformationTrial> try_all(const std::vector<HeldFrame>& frames,
                                        const std::vector<std::size_t>& counts) const;
  // Median milliseconds of a drag from the first learnt frame to the first few held ones, on this thread.
  double milliseconds(const std::string& model, const std::vector<HeldFrame>& frames,
                      std::size_t count) const;

 private:
  const PerformanceDatabase& learnt_;
  std::vector<std::string> models_;
  EditorFactory factory_;
  std::vector<std::int32_t> vertices_;  // as many as the most constraints
  std::unique_ptr<const TrialMeter> meter_;
};

}  // namespace reprise
