// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/mocap.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/log.h"
#include "reprise/core/stopwatch.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/graph.h"
#include "reprise/pipeline/learn_model.h"
#include "reprise/pipeline/mocap_figures.h"
#include "reprise/pipeline/mocap_report.h"
#include "reprise/pipeline/mocap_strip.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;

MocapStageOptions completed(MocapStageOptions options, const PerformanceDatabase& database) {
  options.mocap.retargeting.frames_per_second = database.frames_per_second();
  options.mocap.retrieval.forbidden_clips.clear();
  for (const std::string& name : options.without) {
    options.mocap.retrieval.forbidden_clips.push_back(database.clip_idx(name));
  }
  if (!options.joint_map.empty()) {
    options.mocap.retargeting.joint_map = read_joint_map(options.joint_map);
  }
  return options;
}

void check(const PerformanceDatabase& database) {
  if (database.empty()) throw InvalidArgument("the database has no clip that could be shown");
  if (database.markup()) return;
  throw InvalidArgument(
      "the database has no markup, which says where the joints of the performer are: give it one with "
      "`reprise "
      "markup`");
}

// Frames spread evenly, the first and the last among them.
std::vector<std::size_t> spread_frames(std::size_t frame_count, int wanted) {
  const std::size_t count = std::min(frame_count, static_cast<std::size_t>(std::max(wanted, 0)));
  std::vector<std::size_t> frames;
  for (std::size_t i = 0; i < count; ++i) {
    frames.push_back(count == 1 ? 0 : (2 * i * (frame_count - 1) + count - 1) / (2 * (count - 1)));
  }
  return frames;
}

}  // namespace

void learn_what_is_missing(PerformanceDatabase& database, const std::vector<DriveModel>& models) {
  using Model = LearnModelOptions::Model;
  const bool needs_part =
      std::ranges::count(models, DriveModel::part) > 0 && database.models().part.parts.empty();
  const bool needs_whole =
      std::ranges::count(models, DriveModel::whole) > 0 && database.models().whole.parts.empty();
  if (!needs_part && !needs_whole) return;
  spdlog::info(
      "the learnt models that are missing are learnt now, from {} clips; `reprise model learn` keeps them",
      database.clips().size());
  LearnModelOptions options;
  options.model = needs_part && needs_whole ? Model::both : needs_part ? Model::part : Model::whole;
  database.set_models(learn_models(database, options).models);
}

struct MocapStage::Impl {
  Impl(PerformanceDatabase given, SurfaceMotionGraph made, MocapStageOptions wanted)
      : database(std::move(given)),
        graph(std::move(made)),
        options(completed(std::move(wanted), database)),
        character(database, graph,
                  options.drive_vertices.empty() ? std::vector<DriveVertex>()
                                                 : read_drive_vertices(options.drive_vertices, database)),
        quality(database, character.figure().map()) {}

  PerformanceDatabase database;
  SurfaceMotionGraph graph;
  MocapStageOptions options;
  MocapCharacter character;
  MotionQualityScale quality;
};

MocapStage::MocapStage(PerformanceDatabase database, const fs::path& database_path,
                       MocapStageOptions options) {
  check(database);
  learn_what_is_missing(database, {options.mocap.model});
  SurfaceMotionGraph graph = open_graph(database, database_path, options.graph);
  impl_ = std::make_unique<Impl>(std::move(database), std::move(graph), std::move(options));
}

MocapStage::MocapStage(PerformanceDatabase database, SurfaceMotionGraph graph, MocapStageOptions options) {
  check(database);
  learn_what_is_missing(database, {options.mocap.model});
  check_graph_fits(graph, database);
  impl_ = std::make_unique<Impl>(std::move(database), std::move(graph), std::move(options));
}

MocapStage::~MocapStage() = default;

const PerformanceDatabase& MocapStage::database() const {
  return impl_->database;
}
const SurfaceMotionGraph& MocapStage::graph() const {
  return impl_->graph;
}
const MocapCharacter& MocapStage::character() const {
  return impl_->character;
}
const MotionQualityScale& MocapStage::quality_scale() const {
  return impl_->quality;
}
const MocapStageOptions& MocapStage::options() const {
  return impl_->options;
}

MocapStage::Query MocapStage::read(const MocapQuery& query) const {
  Query read{.file = read_motion(query.source)};
  read.defects = find_defects(read.file.motion);
  for (const MotionDefect& defect : read.defects) {
    spdlog::warn("{}: {}", query.source.motion.string(), to_string(defect, read.file.motion.skeleton));
  }
  read.motion = read.defects.empty() ? read.file.motion : without_defects(read.file.motion, read.defects);
  return read;
}

tl::expected<MocapResult, NoRetrieval> MocapStage::run(const MocapQuery& query,
                                                       const fs::path& output) const {
  const Query read = this->read(query);
  const Stopwatch planning;
  MocapOptions options = impl_->options.mocap;
  auto plans = impl_->character.plan(read.motion, options);
  if (!plans) return tl::make_unexpected(std::move(plans.error()));
  MocapResult result{.plans = std::move(*plans), .seconds = planning.seconds()};
  result.query = query_in_place(read.motion, result.plans.front().target);
  const std::vector<std::size_t> pictured =
      spread_frames(result.plans.front().times.size(), impl_->options.strip_frames);
  StripFrames strip(impl_->database.topology(), impl_->database.frames_per_second(), pictured);

  DatabaseWriter writer(output, impl_->database.topology());
  writer.set_markup(*impl_->database.markup());
  writer.set_models(impl_->database.models());
  std::vector<std::vector<FrameOrigin>> origins(result.plans.size());
  result.measures = nlohmann::json();
  for (std::size_t p = 0; p < result.plans.size(); ++p) {
    const MocapPlan& plan = result.plans[p];
    options.name = p == 0 ? query.name : fmt::format("{}-{}", query.name, p + 1);
    writer.begin_clip(options.name, impl_->database.frames_per_second());
    const Stopwatch making;
    double measuring = 0.0;
    MocapMeter meter(impl_->character, impl_->quality, plan.target);
    impl_->character.animate(plan, options, [&](const Mesh& frame, const FrameOrigin& origin) {
      writer.append(frame);
      if (p == 0) strip.add(frame, origins[p].size());
      origins[p].push_back(origin);
      if (!impl_->options.measure) return;
      const Stopwatch here;
      meter.add(frame, origin);
      measuring += here.seconds();
    });
    writer.set_origins(origins[p]);
    result.seconds += making.seconds() - measuring;
    result.frames += origins[p].size();
    if (!impl_->options.measure) continue;
    // For comparison, as the paper has it: the same without deformation.
    MocapMeter undriven(impl_->character, impl_->quality, plan.target);
    MocapOptions retrieval_alone = options;
    retrieval_alone.model = DriveModel::none;
    if (options.model != DriveModel::none) {
      impl_->character.animate(plan, retrieval_alone, [&](const Mesh& frame, const FrameOrigin& origin) {
        undriven.add(frame, origin);
      });
    }
    const MocapFigures driven = meter.figures();
    result.measures.push_back(
        {{"animation", describe(driven, plan.target)},
         {"interpolation_only",
          describe(options.model == DriveModel::none ? driven : undriven.figures(), plan.target)}});
  }
  result.report = describe_mocap(*this, query, read, result.plans, origins);
  writer.set_note(result.report.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  writer.commit();
  result.strip = strip.take();
  result.strip_query = frames_of(result.query, pictured);
  return result;
}

nlohmann::json full_report(const MocapResult& result) {
  nlohmann::json report = result.report;
  report["seconds"] = result.seconds;
  report["frames_per_second"] =
      result.seconds > 0.0 ? static_cast<double>(result.frames) / result.seconds : 0.0;
  for (std::size_t p = 0; p < result.plans.size(); ++p) {
    if (!result.measures.is_null()) report["answers"][p]["measures"] = result.measures[p];
  }
  return report;
}

}  // namespace reprise
