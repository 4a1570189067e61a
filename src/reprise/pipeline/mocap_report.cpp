// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/mocap_report.h"

#include <algorithm>

#include <fmt/format.h>

#include "reprise/pipeline/path_report.h"

namespace reprise {
namespace {

using nlohmann::json;

const char* timing_name(Timing timing) {
  switch (timing) {
    case Timing::repeats:
      return "repeats";
    case Timing::linear:
      return "linear";
    case Timing::smooth:
      return "smooth";
  }
  return "";
}

const char* kind_name(MotionDefect::Kind kind) {
  switch (kind) {
    case MotionDefect::Kind::jump:
      return "jump";
    case MotionDefect::Kind::rest_pose:
      return "rest_pose";
    case MotionDefect::Kind::flip:
      return "flip";
  }
  return "";
}

json describe_query(const MocapQuery& query, const MocapStage::Query& read) {
  json defects = json::array();
  for (const MotionDefect& defect : read.defects) {
    defects.push_back({{"kind", kind_name(defect.kind)},
                       {"first_frame", defect.first_frame},
                       {"last_frame", defect.last_frame},
                       {"distance", defect.distance},
                       {"text", to_string(defect, read.file.motion.skeleton)}});
  }
  return {{"motion", query.source.motion.string()},
          {"frames", read.file.motion.frames.size()},
          {"frames_per_second", read.file.motion.frames_per_second},
          {"metres_per_unit", read.file.metres_per_unit},
          {"notes", read.file.notes},
          {"defects", std::move(defects)}};
}

json describe_map(const JointMap& map) {
  return {{"name", map.name}, {"joints", map.joints}, {"missing", map.missing}, {"unused", map.unused}};
}

json describe_plan(const MocapStage& stage, const MocapPlan& plan, const std::vector<FrameOrigin>& origins) {
  const Retrieval& retrieval = plan.retrieval;
  const std::vector<double>& distances = retrieval.dissimilarity;
  double sum = 0.0;
  for (const double distance : distances) sum += distance;
  json frames = describe_frames(origins);
  for (std::size_t f = 0; f < frames.size() && f < plan.times.size(); ++f) {
    frames[f]["path_time"] = plan.times[f];
    frames[f]["dissimilarity"] = distances[f];
  }
  const auto standing = [&](std::size_t side) {
    return std::ranges::count_if(plan.target.contacts, [side](const FootContacts& c) { return c[side]; });
  };
  return {{"cost", retrieval.cost},
          {"transition_cost", retrieval.transition_cost},
          {"retrieval_cost", retrieval.retrieval_cost},
          {"mean_dissimilarity", distances.empty() ? 0.0 : sum / static_cast<double>(distances.size())},
          {"repeats", retrieval.repeats},
          {"skips", retrieval.skips},
          {"transition_count", retrieval.transitions},
          {"transitions", describe_transitions(retrieval.path, stage.graph())},
          {"contact_frames", {standing(0), standing(1)}},
          {"frames", std::move(frames)}};
}

}  // namespace

json describe_mocap(const MocapStage& stage, const MocapQuery& query, const MocapStage::Query& read,
                    const std::vector<MocapPlan>& plans,
                    const std::vector<std::vector<FrameOrigin>>& origins) {
  const RetargetedMotion& target = plans.front().target;
  const MocapStageOptions& options = stage.options();
  json answers = json::array();
  for (std::size_t p = 0; p < plans.size(); ++p) {
    json answer = describe_plan(stage, plans[p], origins[p]);
    answer["name"] = p == 0 ? query.name : fmt::format("{}-{}", query.name, p + 1);
    answers.push_back(std::move(answer));
  }
  const CapturedNaturalness& captured = stage.quality_scale().captured();
  return {{"query", describe_query(query, read)},
          {"joint_map", describe_map(target.map)},
          {"scale", target.scale},
          {"left_out", target.left_out},
          {"frame_count", target.motion.frames.size()},
          {"database_rate", target.motion.frames_per_second},
          {"model", to_string(options.mocap.model)},
          {"timing", timing_name(options.mocap.timing)},
          {"threshold", options.mocap.retrieval.threshold},
          {"velocity_weight", options.mocap.retrieval.velocity_weight},
          {"without", options.without},
          {"drive_vertices", stage.character().drive_vertices().size()},
          {"metric", stage.graph().metric},
          {"database_hash", stage.graph().database_hash},
          {"captured",
           {{"pop_ratio", captured.pop_ratio},
            {"foot_drift_cm_s", captured.foot_drift},
            {"edge_stretch_p99", captured.edge_stretch_p99}}},
          {"answers", std::move(answers)}};
}

}  // namespace reprise
