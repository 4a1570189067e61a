// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// One trial of `evaluate_mocap`.

#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "reprise/pipeline/mocap.h"
#include "reprise/pipeline/mocap_figures.h"
#include "reprise/pipeline/motion_corpus.h"

namespace reprise {

// Distances of all vertices from the truth, metres: mean over vertices and frames, and the greatest.
struct TruthError {
  std::string method;
  double mean = 0.0, max = 0.0;                  // the whole truth moved over the ground once, to the query
  double aligned_mean = 0.0, aligned_max = 0.0;  // each frame moved over the ground to where it fits best
};

struct MocapTrial {
  std::string trial, motion_class, description;
  std::string failure;             // empty: it was made
  std::vector<std::string> notes;  // defects of the file, what was compared
  std::string held_clip;           // nothing of it was shown or learnt from; empty: none was held out
  std::size_t frames = 0;
  double scale = 1.0;               // leg length of the character over that of the query
  double mean_dissimilarity = 0.0;  // metres a joint
  int repeats = 0, skips = 0, transitions = 0;
  MocapFigures retrieval, interpolation, deformation;
  std::vector<TruthError> truth;  // a method each; none without a truth
  // All that is not the same in every run: seconds to read and plan, and to make the deformed animation.
  double planning_seconds = 0.0, animation_seconds = 0.0;

  double frames_per_second() const {
    const double seconds = planning_seconds + animation_seconds;
    return seconds > 0.0 ? static_cast<double>(frames) / seconds : 0.0;
  }
};

// Methods that are compared with a truth: "retrieval" (frames as they are, repeats standing),
// "interpolation", "rest-lbs", "lbs", "dqs", "laplacian", "whole", "part".
const std::vector<std::string>& truth_methods();

// Retrieval as it is, with interpolation, and with deformation by the stage's model. What goes wrong with the
// trial alone becomes its `failure`. `truth`: what the performer does in this trial, null if it is not known.
// Throws `Cancelled`.
MocapTrial run_mocap_trial(const MocapStage& stage, const CorpusTrial& trial, const MeshSequence* truth);

// For the exchange between ranks; numbers to the last bit.
nlohmann::json to_exchange(const MocapTrial& trial);
MocapTrial from_exchange(const nlohmann::json& text);

}  // namespace reprise
