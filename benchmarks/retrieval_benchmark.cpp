// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Retrieval of a query of 500 frames on databases of growing size, beside Dijkstra's algorithm on the same
// trellis. One thread: processor time; two threads: time on the clock.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "dijkstra_peer.h"
#include "reprise/graph/surface_motion_graph.h"
#include "reprise/io/database_file.h"
#include "reprise/path/skeleton_comparison.h"
#include "reprise/skeleton/skeleton_extraction.h"
#include "thread_time.h"

namespace {

using reprise::JointTrack;
using reprise::Transition;
using reprise::benchmark::thread_ms;
using reprise::path_detail::QuerySkeleton;
using reprise::path_detail::SkeletonTable;
using reprise::path_detail::SkeletonWeights;

struct Data {
  std::string name;
  std::vector<JointTrack> tracks;
  std::vector<std::string> clip_names;
  std::vector<Transition> transitions;

  std::size_t frame_count() const {
    std::size_t count = 0;
    for (const JointTrack& track : tracks) count += track.size();
    return count;
  }
};

double wall_ms() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double, std::milli>(now).count();
}

// Median milliseconds of a clock over some runs.
double median_ms(int runs, const auto& clock, const auto& run) {
  std::vector<double> times;
  for (int i = 0; i < runs; ++i) {
    const double start = clock();
    run();
    times.push_back(clock() - start);
  }
  std::ranges::sort(times);
  return times[times.size() / 2];
}

// Shaped like the graph of a performer with ten clips: clips of 44 frames, 38 transitions a clip, most of
// their half windows short.
Data generated_data(std::size_t frame_count) {
  constexpr int joint_count = 21;
  constexpr std::size_t clip_length = 44;
  constexpr std::array<int, 12> half_windows = {2, 2, 2, 2, 2, 3, 3, 4, 5, 7, 9, 12};
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  Data data{.name = "random", .tracks = {}, .clip_names = {}, .transitions = {}};
  Eigen::MatrixX3d rest(joint_count, 3);
  for (double& value : rest.reshaped()) value = 0.4 * normal(random);
  for (std::size_t left = frame_count; left > 0;) {
    const std::size_t length = left < 2 * clip_length ? left : clip_length;
    left -= length;
    Eigen::MatrixX3d swing(joint_count, 3);
    for (double& value : swing.reshaped()) value = 0.15 * normal(random);
    const double phase = 3.0 * normal(random);
    JointTrack track;
    for (std::size_t f = 0; f < length; ++f) {
      track.push_back(rest + swing * std::sin(0.25 * static_cast<double>(f) + phase));
    }
    data.tracks.push_back(std::move(track));
    data.clip_names.push_back(fmt::format("clip{}", data.clip_names.size()));
  }
  std::uniform_int_distribution<std::size_t> clip(0, data.tracks.size() - 1);
  for (std::size_t t = 0; t < 38 * data.tracks.size(); ++t) {
    Transition transition;
    transition.source_clip = clip(random);
    transition.target_clip = clip(random);
    transition.half_window = half_windows[t % half_windows.size()];
    const auto center = [&](std::size_t of) {
      const int last = static_cast<int>(data.tracks[of].size()) - 1;
      return std::uniform_int_distribution<int>(transition.half_window,
                                                last - transition.half_window)(random);
    };
    transition.m = center(transition.source_clip);
    transition.n = center(transition.target_clip);
    transition.source_from_target = {.yaw = normal(random), .translation = {normal(random), normal(random)}};
    transition.cost = 0.05 * std::abs(normal(random));
    data.transitions.push_back(transition);
  }
  return data;
}

Data real_data(const char* database_path, const char* graph_path) {
  const reprise::PerformanceDatabase database = reprise::load_database(database_path);
  if (!database.markup()) {
    fmt::print(stderr, "{} has no markup\n", database_path);
    std::exit(2);
  }
  Data data{.name = database_path, .tracks = {}, .clip_names = {}, .transitions = {}};
  for (const reprise::MeshSequence& clip : database.clips()) {
    const reprise::SkeletalMotion motion = reprise::extract_skeleton(clip, *database.markup());
    JointTrack track;
    for (const reprise::SkeletonPose& pose : motion.frames) {
      track.emplace_back(static_cast<Eigen::Index>(pose.position.size()), 3);
      for (std::size_t j = 0; j < pose.position.size(); ++j) {
        track.back().row(static_cast<Eigen::Index>(j)) = pose.position[j].transpose();
      }
    }
    data.tracks.push_back(std::move(track));
    data.clip_names.push_back(clip.name());
  }
  data.transitions = reprise::load_graph(graph_path).active_transitions();
  return data;
}

// Stretches of some clips, one after the other, every sixth frame left out, all joints off by some 3 cm.
JointTrack query_of(const Data& data, std::size_t frame_count) {
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0.0, 0.02);
  std::uniform_int_distribution<std::size_t> clip(0, data.tracks.size() - 1);
  JointTrack query;
  while (query.size() < frame_count) {
    const JointTrack& track = data.tracks[clip(random)];
    for (std::size_t f = 0; f < track.size() && query.size() < frame_count; ++f) {
      if (f % 6 == 5) continue;
      query.push_back(track[f]);
      for (double& value : query.back().reshaped()) value += noise(random);
    }
  }
  return query;
}

// Cost by Dijkstra's algorithm and its milliseconds; the rows are given to it.
std::pair<double, double> solve_by_peer(const Data& data, const JointTrack& query,
                                        const reprise::RetrievalOptions& options) {
  std::vector<int> frame_counts;
  for (const JointTrack& track : data.tracks) frame_counts.push_back(static_cast<int>(track.size()));
  const reprise::path_detail::Trellis trellis(frame_counts, data.transitions);
  const SkeletonWeights weights{.joints =
                                    std::vector<double>(static_cast<std::size_t>(query.front().rows()), 1.0)};
  SkeletonTable table(trellis.node_count(), weights.joints.size());
  for (const auto& run : trellis.runs()) {
    for (std::size_t node = run.first; node < run.end; ++node) {
      if (!run.blended) {
        table.set(node, reprise::path_detail::moving_skeleton(data.tracks[run.owner_idx], node - run.first),
                  weights.joints);
        continue;
      }
      const Transition& t = data.transitions[run.owner_idx];
      const int k = static_cast<int>(node - run.first) + 1 - t.half_window;
      const double alpha = reprise::blend_weight(reprise::BlendProfile::smooth, k, t.half_window);
      reprise::path_detail::MovingSkeleton blended = reprise::path_detail::moving_skeleton(
          data.tracks[t.source_clip], static_cast<std::size_t>(t.m + k));
      const Eigen::MatrixX3d& target = data.tracks[t.target_clip][static_cast<std::size_t>(t.n + k)];
      const Eigen::MatrixX3d aligned = (target * t.source_from_target.rotation().transpose()).rowwise() +
                                       t.source_from_target.translation3().transpose();
      blended.joints = (1.0 - alpha) * blended.joints + alpha * aligned;
      table.set(node, blended, weights.joints);
    }
  }
  std::vector<std::vector<float>> rows(query.size());
  for (std::size_t k = 0; k < query.size(); ++k) {
    const QuerySkeleton skeleton(reprise::path_detail::moving_skeleton(query, k), weights);
    rows[k].resize(table.block_count() * SkeletonTable::lanes);
    for (std::size_t block = 0; block < table.block_count(); ++block) {
      table.compare(skeleton, block, rows[k].data() + block * SkeletonTable::lanes);
    }
  }
  reprise::benchmark::DijkstraPeer peer(trellis);
  const double start = thread_ms();
  const double cost = peer.solve(rows, options, options.threshold * weights.sum());
  return {cost, thread_ms() - start};
}

void measure(const Data& data, int runs, bool with_peer) {
  const JointTrack query = query_of(data, 500);
  const double start = wall_ms();
  const reprise::SkeletonRetriever retriever(data.tracks, data.clip_names, data.transitions,
                                             reprise::BlendProfile::smooth, 25.0);
  const double preparation = wall_ms() - start;
  const reprise::RetrievalOptions options;
  const auto retrieve = [&] { return retriever.retrieve(query, options); };
  const auto answers = retrieve();
  if (!answers) {
    fmt::print("{}: {}\n", data.name, answers.error().reason);
    return;
  }
  const double two_threads = median_ms(runs, wall_ms, retrieve);
  std::optional<tbb::global_control> limit(std::in_place, tbb::global_control::max_allowed_parallelism, 1);
  const double one_thread = median_ms(runs, thread_ms, retrieve);
  limit.reset();
  std::string peer = fmt::format("{:>12} {:>7} {:>12}", "", "", "");
  if (with_peer) {
    const auto [cost, ms] = solve_by_peer(data, query, options);
    peer = fmt::format("{:>12.1f} {:>7.0f} {:>12.1e}", ms, ms / one_thread,
                       std::abs(cost - answers->front().cost));
  }
  fmt::print("{:>8} {:>12} {:>9} {:>8.1f} {:>12.2f} {:>12.2f} {}\n", data.frame_count(),
             data.transitions.size(), retriever.node_count(), preparation, one_thread, two_threads, peer);
  std::fflush(stdout);
}

}  // namespace

// retrieval_benchmark [DATABASE GRAPH]...
int main(int argc, char** argv) {
  fmt::print("{:>8} {:>12} {:>9} {:>8} {:>12} {:>12} {:>12} {:>7} {:>12}\n", "frames", "transitions", "nodes",
             "prep. ms", "1 thread ms", "2 threads ms", "Dijkstra ms", "ratio", "cost differs");
  for (int i = 1; i + 1 < argc; i += 2) {
    fmt::print("{}\n", argv[i]);
    measure(real_data(argv[i], argv[i + 1]), 21, true);
  }
  fmt::print("random\n");
  for (const std::size_t frame_count : {442, 1'000, 10'000, 100'000}) {
    measure(generated_data(frame_count),
            frame_count > 50'000  ? 1
            : frame_count > 5'000 ? 5
                                  : 21,
            frame_count < 5'000);
  }
  return 0;
}
