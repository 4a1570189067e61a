// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/mocap_trial.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/similarity/vertex_metric.h"

namespace reprise {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TruthError, method, mean, max, aligned_mean, aligned_max)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(VelocityError, mean, deviation, per_joint)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(MotionQuality, pop_ratio, peak_ratio, foot_drift, foot_height,
                                   edge_stretch_p99)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(MocapFigures, velocity, velocity_as_is, quality)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(MocapTrial, trial, motion_class, description, failure, notes, held_clip,
                                   frames, scale, mean_dissimilarity, repeats, skips, transitions, retrieval,
                                   interpolation, deformation, truth, planning_seconds, animation_seconds)

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

struct Method {
  const char* name;
  Timing timing;
  DriveModel model;
};
constexpr Method methods[] = {
    {"retrieval", Timing::repeats, DriveModel::none},   {"interpolation", Timing::smooth, DriveModel::none},
    {"rest-lbs", Timing::smooth, DriveModel::rest_lbs}, {"lbs", Timing::smooth, DriveModel::lbs},
    {"dqs", Timing::smooth, DriveModel::dqs},           {"laplacian", Timing::smooth, DriveModel::laplacian},
    {"whole", Timing::smooth, DriveModel::whole},       {"part", Timing::smooth, DriveModel::part}};

PositionsView view_of(const Positions& positions) {
  return {positions.data(), positions.rows(), 3};
}

// Joints of all frames, one after the other.
Positions all_joints(const std::vector<SkeletonPose>& poses, std::size_t count) {
  const auto joints = static_cast<Eigen::Index>(poses.front().position.size());
  Positions all(static_cast<Eigen::Index>(count) * joints, 3);
  for (std::size_t f = 0; f < count; ++f) {
    for (Eigen::Index j = 0; j < joints; ++j) {
      all.row(static_cast<Eigen::Index>(f) * joints + j) =
          poses[f].position[static_cast<std::size_t>(j)].transpose().cast<float>();
    }
  }
  return all;
}

// What the performer does, where the query is: brought there once, by the joints of all frames.
class Truth {
 public:
  Truth(const MeshSequence& clip, const MocapStage& stage, const RetargetedMotion& target)
      : clip_(clip), count_(std::min(clip.frame_count(), target.motion.frames.size())) {
    std::vector<SkeletonPose> poses;
    for (std::size_t f = 0; f < count_; ++f)
      poses.push_back(stage.character().follower().pose(clip.frame(f)));
    const Positions asked = all_joints(target.motion.frames, count_);
    const Positions done = all_joints(poses, count_);
    query_from_clip_ = align_on_ground(view_of(asked), view_of(done)).a_from_b;
  }

  std::size_t frame_count() const { return count_; }
  Positions frame(std::size_t frame_idx) const {
    Positions moved(static_cast<Eigen::Index>(clip_.vertex_count()), 3);
    transform_positions(query_from_clip_, clip_.frame(frame_idx),
                        PositionsRef(moved.data(), moved.rows(), 3));
    return moved;
  }

 private:
  const MeshSequence& clip_;
  std::size_t count_;
  GroundTransform query_from_clip_;
};

// Takes the frames of one animation in order.
class TruthMeter {
 public:
  explicit TruthMeter(const Truth& truth) : truth_(truth) {}

  void add(const Mesh& frame) {
    if (frames_ >= truth_.frame_count()) return;
    const Positions truth = truth_.frame(frames_++);
    const auto measure = [&](const Positions& made, double& mean, double& max) {
      const Eigen::VectorXd distances = (made - truth).cast<double>().rowwise().norm();
      mean += distances.mean();
      max = std::max(max, distances.maxCoeff());
    };
    measure(frame.positions, error_.mean, error_.max);
    Positions aligned(frame.positions.rows(), 3);
    transform_positions(align_on_ground(view_of(truth), view_of(frame.positions)).a_from_b,
                        view_of(frame.positions), PositionsRef(aligned.data(), aligned.rows(), 3));
    measure(aligned, error_.aligned_mean, error_.aligned_max);
  }

  TruthError error(std::string method) const {
    TruthError error = error_;
    error.method = std::move(method);
    if (frames_ == 0) return error;
    error.mean /= static_cast<double>(frames_);
    error.aligned_mean /= static_cast<double>(frames_);
    return error;
  }

 private:
  const Truth& truth_;
  std::size_t frames_ = 0;
  TruthError error_;
};

class TrialRun {
 public:
  TrialRun(const MocapStage& stage, MocapPlan plan) : stage_(stage), plan_(std::move(plan)) {}

  const MocapPlan& plan() const { return plan_; }

  void animate(Timing timing, DriveModel model, const FrameSink& sink) {
    MocapOptions options = stage_.options().mocap;
    options.timing = timing;
    options.model = model;
    MocapPlan plan = plan_;
    plan.times = path_times(plan.retrieval.path_frame, timing);
    stage_.character().animate(plan, options, sink);
  }

  // Seconds without those of the measuring.
  double measured(Timing timing, DriveModel model, MocapFigures& figures) {
    MocapMeter meter(stage_.character(), stage_.quality_scale(), plan_.target);
    double measuring = 0.0;
    const auto start = Clock::now();
    animate(timing, model, [&](const Mesh& frame, const FrameOrigin& origin) {
      const auto here = Clock::now();
      meter.add(frame, origin);
      measuring += seconds_since(here);
    });
    const double seconds = seconds_since(start) - measuring;
    figures = meter.figures();
    return seconds;
  }

 private:
  const MocapStage& stage_;
  MocapPlan plan_;
};

void compare(TrialRun& run, const MocapStage& stage, const MeshSequence& clip, MocapTrial& result) {
  const Truth truth(clip, stage, run.plan().target);
  if (clip.frame_count() != result.frames) {
    result.notes.push_back(fmt::format("the truth has {} frames, the query {}: the first {} are compared",
                                       clip.frame_count(), result.frames, truth.frame_count()));
  }
  for (const Method& method : methods) {
    TruthMeter meter(truth);
    run.animate(method.timing, method.model,
                [&](const Mesh& frame, const FrameOrigin&) { meter.add(frame); });
    result.truth.push_back(meter.error(method.name));
  }
}

void run_checked(const MocapStage& stage, const CorpusTrial& trial, const MeshSequence* truth,
                 MocapTrial& result) {
  const auto start = Clock::now();
  const MocapStage::Query query = stage.read({.source = trial.source, .name = trial.trial});
  for (const MotionDefect& defect : query.defects) {
    result.notes.push_back(to_string(defect, query.file.motion.skeleton));
  }
  auto plans = stage.character().plan(query.motion, stage.options().mocap);
  result.planning_seconds = seconds_since(start);
  if (!plans) {
    result.failure = "no retrieval: " + plans.error().reason;
    return;
  }
  TrialRun run(stage, std::move(plans->front()));
  const Retrieval& retrieval = run.plan().retrieval;
  result.frames = run.plan().target.motion.frames.size();
  result.scale = run.plan().target.scale;
  result.repeats = retrieval.repeats;
  result.skips = retrieval.skips;
  result.transitions = retrieval.transitions;
  for (const double distance : retrieval.dissimilarity) result.mean_dissimilarity += distance;
  result.mean_dissimilarity /= static_cast<double>(std::max<std::size_t>(1, retrieval.dissimilarity.size()));

  const MocapOptions& options = stage.options().mocap;
  run.measured(Timing::repeats, DriveModel::none, result.retrieval);
  run.measured(options.timing, DriveModel::none, result.interpolation);
  result.animation_seconds = run.measured(options.timing, options.model, result.deformation);
  if (truth != nullptr) compare(run, stage, *truth, result);
}

}  // namespace

const std::vector<std::string>& truth_methods() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Method& method : methods) all.emplace_back(method.name);
    return all;
  }();
  return names;
}

MocapTrial run_mocap_trial(const MocapStage& stage, const CorpusTrial& trial, const MeshSequence* truth) {
  MocapTrial result{
      .trial = trial.trial, .motion_class = trial.motion_class, .description = trial.description};
  if (!trial.flags.empty()) result.notes.push_back("the index says: " + trial.flags);
  try {
    run_checked(stage, trial, truth, result);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    result.failure = error.what();
  }
  return result;
}

nlohmann::json to_exchange(const MocapTrial& trial) {
  return trial;
}

MocapTrial from_exchange(const nlohmann::json& text) {
  return text.get<MocapTrial>();
}

}  // namespace reprise
