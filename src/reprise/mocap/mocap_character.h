// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Motion capture drives the captured character (HSSMG 5.2): retrieval, temporal interpolation, deformation.

#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "reprise/mocap/drive_model.h"
#include "reprise/mocap/drive_vertices.h"
#include "reprise/path/skeleton_retrieval.h"
#include "reprise/retarget/retarget.h"
#include "reprise/synthesis/path_timing.h"

namespace reprise {

struct MocapOptions {
  RetargetOptions retargeting;  // its rate is that of the database
  RetrievalOptions retrieval;
  Timing timing = Timing::smooth;
  DriveModel model = DriveModel::part;
  std::string name = "animation";
};

// What is made for one query.
struct MocapPlan {
  RetargetedMotion target;
  Retrieval retrieval;
  std::vector<double> times;  // along the path
};

// Receives frames in order; frames without normals or colours where the clips have none.
using FrameSink = std::function<void(const Mesh& frame, const FrameOrigin& origin)>;

// All that the queries of a character share: skeletons of the clips, the retriever, learnt operators,
// skinning weights, drive vertices. Keeps a reference to the database. Thread-safe.
class MocapCharacter {
 public:
  // `drive_vertices`: empty: chosen. Throws `InvalidArgument` that says what to do if the database has no
  // markup, or, when a model is asked for first, no learnt model. `graph` must fit the database.
  MocapCharacter(const PerformanceDatabase& database, const SurfaceMotionGraph& graph,
                 std::vector<DriveVertex> drive_vertices = {});
  ~MocapCharacter();

  const PerformanceDatabase& database() const;
  const SkeletonFollower& follower() const;
  const StandingFigure& figure() const;
  const std::vector<DriveVertex>& drive_vertices() const;

  // The answers, best first (`RetrievalOptions::count`). Throws as `retarget_motion` and `retrieve`.
  tl::expected<std::vector<MocapPlan>, NoRetrieval> plan(const SkeletalMotion& query,
                                                         const MocapOptions& options) const;
  // Makes the frames in stretches of bounded size, in parallel within, with progress, and hands them on in
  // order. Throws `Cancelled`, and what the sink throws.
  void animate(const MocapPlan& plan, const MocapOptions& options, const FrameSink& sink) const;
  // The same as one sequence.
  MeshSequence animate(const MocapPlan& plan, const MocapOptions& options) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace reprise
