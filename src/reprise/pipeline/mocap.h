// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "mocap": skeletal motion becomes an animation of the captured character (HSSMG 5.2).

#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <tl/expected.hpp>

#include "reprise/io/motion_file.h"
#include "reprise/mocap/mocap_character.h"
#include "reprise/mocap/motion_quality.h"

namespace reprise {

struct MocapQuery {
  MotionSource source;
  std::string name;  // of the clip; further answers are NAME-2, NAME-3, ...
};

struct MocapStageOptions {
  MocapOptions mocap;                    // its rate, name and forbidden clips are set by the stage
  std::vector<std::string> without;      // clips that are not to be shown
  std::filesystem::path graph;           // empty: made with default options, as `reprise graph` does
  std::filesystem::path joint_map;       // JSON (`read_joint_map`); empty: found from the names
  std::filesystem::path drive_vertices;  // JSON (`read_drive_vertices`); empty: chosen
  bool measure = false;  // the animation and, for comparison, retrieval with interpolation alone
  int strip_frames = 0;  // kept of the best answer for a picture
};

struct MocapResult {
  std::vector<MocapPlan> plans;  // best first
  // Motion file, joints, scale, defects, answers: docs/mocap.md lists every field. The same in every run.
  nlohmann::json report;
  nlohmann::json measures;     // of each answer, if asked for; null otherwise
  std::size_t frames = 0;      // made, of all answers
  double seconds = 0.0;        // for plans and frames, without measuring
  MeshSequence strip;          // frames of the best answer, evenly spread
  SkeletalMotion strip_query;  // the query at those frames, as large as the character and in its place
  SkeletalMotion query;        // all of it, likewise
};

// The database as models ask for it: what is not learnt yet is learnt now, in memory, from all clips, and
// said so. Throws as `learn_models`.
void learn_what_is_missing(PerformanceDatabase& database, const std::vector<DriveModel>& models);

// All that the queries of a character share.
class MocapStage {
 public:
  // `database_path`: where the database was read from; the cache of the graph lies beside it. Throws as
  // `open_graph`, `MocapCharacter`, `read_joint_map`, `read_drive_vertices`, and `InvalidArgument` for a clip
  // that is not there.
  MocapStage(PerformanceDatabase database, const std::filesystem::path& database_path,
             MocapStageOptions options);
  MocapStage(PerformanceDatabase database, SurfaceMotionGraph graph, MocapStageOptions options);
  ~MocapStage();
  MocapStage(const MocapStage&) = delete;
  MocapStage& operator=(const MocapStage&) = delete;

  const PerformanceDatabase& database() const;
  const SurfaceMotionGraph& graph() const;
  const MocapCharacter& character() const;
  const MotionQualityScale& quality_scale() const;
  const MocapStageOptions& options() const;

  // The query as it is planned and made: read and rid of its defects, which are said.
  struct Query {
    MotionFile file;  // as read
    SkeletalMotion motion;
    std::vector<MotionDefect> defects;
  };
  Query read(const MocapQuery& query) const;

  // Makes the answers and writes them to `output`, a database with markup and models, frame by frame, whole
  // or not at all. Throws what reading and retargeting throw, `FileError`, `Cancelled`.
  tl::expected<MocapResult, NoRetrieval> run(const MocapQuery& query,
                                             const std::filesystem::path& output) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// What became of one query of many.
struct MocapOutcome {
  std::string name;
  std::filesystem::path output;
  std::string failure;    // empty: it was made
  nlohmann::json report;  // of the query, with measures and seconds; null if it failed
};

// Many queries, each to FOLDER/NAME.reprise; whole queries are shared over MPI ranks, and every file has the
// bytes that `run` writes. One that cannot be read or answered is an outcome, and the others go on. Outcomes
// of all ranks, in the order of the queries. Throws `InvalidArgument` before the work for a name that is
// taken or unfit, `FileError`, `Cancelled`.
std::vector<MocapOutcome> run_mocap_folder(const MocapStage& stage, const std::vector<MocapQuery>& queries,
                                           const std::filesystem::path& folder);

// The report of a query with its measures and times.
nlohmann::json full_report(const MocapResult& result);

// Which rank takes which query: the longest first, always to the rank with least to do.
std::vector<int> shares_of_ranks(const std::vector<std::uintmax_t>& sizes, int rank_count);

}  // namespace reprise
