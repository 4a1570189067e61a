// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "evaluate deformation": how well the models of deformation make frames that nothing was learnt from
// (LPBM Figures 2 and 8, HSSMG Figure 10, in numbers).

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reprise/pipeline/deformation_trial.h"
#include "reprise/pipeline/learn_model.h"

namespace reprise {

struct DeformationEvaluationOptions {
  // Clips that nothing is learnt from and that are then reproduced; empty: the last one, or none if there is
  // a truth.
  std::vector<std::string> held;
  // Another database of the same surface, all of whose clips are reproduced and none is learnt from.
  std::filesystem::path truth;
  std::vector<std::string> models;  // of `deformation_models`; empty: all the database allows
  std::vector<std::size_t> constraints = {10, 20, 40};  // constrained vertices
  std::size_t stride = 4;                               // every stride-th frame is reproduced
  int pictures = 4;                                     // frames drawn beside each model's result; 0: none
  // How parts and whole learn; which models, and `without`, follow from the above.
  LearnModelOptions learning;
};

// "part", "whole", "laplacian", "lbs", "dqs" (`EditModel`), and "rigid" (`RigidEditor`).
const std::vector<std::string>& deformation_models();

// The frame that is edited into the one to be reproduced.
enum class DeformationSource {
  first,    // the first learnt frame: an artist's far drag
  nearest,  // `nearest_frame` of what was learnt: what a motion-capture stage would find
};
std::string to_string(DeformationSource source);

struct DeformationTrial {
  std::string frame;  // reproduced, CLIP:FRAME; clips of the truth as well
  std::string model;
  DeformationSource source = DeformationSource::first;
  std::string source_frame;
  std::size_t constraints = 0;
  TrialFigures figures;
};

// Over the trials of one model, one source and one number of constraints.
struct DeformationFigures {
  std::string model;
  DeformationSource source = DeformationSource::first;
  std::size_t constraints = 0;
  TrialFigures mean;          // over frames
  TrialFigures worst;         // the worst frame, figure by figure
  double milliseconds = 0.0;  // median of a drag on one thread; 0 where it was not measured (`nearest`)
};

struct DeformationEvaluation {
  std::vector<std::string> learnt_clips, held_clips;
  std::size_t frames = 0;  // reproduced
  bool has_frontier = false;
  std::vector<DeformationTrial> trials;     // frame by frame
  std::vector<DeformationFigures> figures;  // by number of constraints, source, model
  nlohmann::json learning;                  // report of `learn_models`; null if nothing is learnt
  std::vector<std::string> notes;           // what was left out, and why
};

// A frame that is held out gives its own places of N spread vertices as constraints; each model edits another
// frame to meet them; the result is compared with the frame itself. Writes into `folder`, which is made if it
// is missing: deformation.md, deformation.csv, frames.csv (every trial), deformation.png, and pictures.png
// unless no pictures are asked for; each whole or not at all. All but the milliseconds are the same in every
// run. Parallel over frames, with progress. Throws `InvalidArgument` before long work: options out of range,
// unknown clips or models, a truth of another surface, nothing to learn from or to reproduce, a model for
// which the database lacks the markup; `FileError`; `Cancelled`.
DeformationEvaluation evaluate_deformation(const PerformanceDatabase& database,
                                           const std::filesystem::path& folder,
                                           const DeformationEvaluationOptions& options = {});

}  // namespace reprise
