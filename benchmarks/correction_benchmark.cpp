// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What correction and foot planting do to key-frame animations: distance and time errors, pops, sliding feet,
// stretched edges and processor time, each step with and without; and how well frames between frames are
// met: every second captured frame made from the others.
//
//     correction_benchmark DATABASE GRAPH QUERIES KEYFRAME-PAIR...     as stand:1,walk:16

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/deform/blend.h"
#include "reprise/io/database_file.h"
#include "reprise/path/keyframe_optimizer.h"
#include "reprise/synthesis/naturalness.h"
#include "reprise/synthesis/synthesize.h"

namespace {

using namespace reprise;

// Processor time of all threads, seconds.
double processor_seconds() {
  timespec time = {};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Squares, their number, and the largest.
struct Errors {
  double sum = 0.0;
  double largest = 0.0;
  std::size_t count = 0;

  void add(double error) {
    sum += error * error;
    largest = std::max(largest, std::abs(error));
    ++count;
  }
  double rms() const { return count == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(count)); }
};

PositionsView view(const Positions& positions) {
  return {positions.data(), positions.rows(), 3};
}

void compare_inbetweens(const PerformanceDatabase& database, const PoissonReconstruction& poisson) {
  Errors positions;
  Errors gradients;
  Errors cubic;
  for (const MeshSequence& clip : database.clips()) {
    const std::size_t half = (clip.frame_count() + 1) / 2;
    if (half < 3) continue;
    MeshSequence every_second(clip.name(), clip.topology(), half, clip.frames_per_second());
    for (std::size_t f = 0; f < half; ++f) every_second.frame(f) = clip.frame(2 * f);
    const MeshSequence made = retimed(every_second, static_cast<int>(2 * half - 1), poisson);
    for (std::size_t f = 1; f + 1 < made.frame_count(); f += 2) {
      const PositionsView truth = clip.frame(f);
      const PositionsView before = clip.frame(f - 1);
      const PositionsView after = clip.frame(f + 1);
      const Positions straight = 0.5F * (before + after);
      Positions blended(truth.rows(), 3);
      blend_frames(poisson, before, after, 0.5, PositionsRef(blended.data(), blended.rows(), 3));
      const auto add = [&](const PositionsView& frame, Errors& errors) {
        for (Eigen::Index v = 0; v < truth.rows(); ++v) {
          errors.add(1e3 * static_cast<double>((frame.row(v) - truth.row(v)).norm()));
        }
      };
      add(view(straight), positions);
      add(view(blended), gradients);
      add(made.frame(f), cubic);
    }
  }
  fmt::print("every second frame from the others, mm: rms (largest)\n");
  fmt::print("| straight lines | gradient-field blend of the neighbours | cubic in the gradient field |\n");
  fmt::print("| {:.2f} ({:.0f}) | {:.2f} ({:.0f}) | {:.2f} ({:.0f}) |\n\n", positions.rms(),
             positions.largest, gradients.rms(), gradients.largest, cubic.rms(), cubic.largest);
}

// Largest vertex acceleration anywhere, m/frame^2.
double peak_acceleration(const MeshSequence& motion) {
  float peak = 0.0F;
  for (std::size_t f = 1; f + 1 < motion.frame_count(); ++f) {
    peak = std::max(peak, (motion.frame(f - 1) - 2.0F * motion.frame(f) + motion.frame(f + 1))
                              .rowwise()
                              .squaredNorm()
                              .maxCoeff());
  }
  return std::sqrt(static_cast<double>(peak));
}

struct Variant {
  std::string name;
  bool is_corrected = false;
  bool plants_feet = false;

  Errors distance{};
  Errors time{};
  Errors prediction{};  // metres between predicted and measured distance
  double pop = 0.0;     // largest of all animations
  double peak = 0.0;    // largest acceleration anywhere over the captured 99th percentile
  double drift = 0.0;   // sums over animations
  double blend_drift = 0.0;
  double edge_stretch = 0.0;
  double seconds = 0.0;
  std::size_t frames = 0;
  std::size_t animations = 0;
};

struct Query {
  MotionPath path;
  double distance = 0.0;
  double time = 0.0;
};

// `count` targets over the grid of HSSMG Table III whose optimal path is within 1 m and 1 s of them.
std::vector<Query> choose_queries(const PerformanceDatabase& database, const PathMetrics& metrics,
                                  const std::vector<FrameId>& keyframes, std::size_t count) {
  std::mt19937 random(7);
  std::vector<Query> queries;
  for (int attempt = 0; attempt < 1000 && queries.size() < count; ++attempt) {
    Query query{.distance = 1.0 + static_cast<double>(random() % 20),
                .time = 1.0 + static_cast<double>(random() % 40)};
    auto path =
        find_keyframe_path(metrics, {.keyframes = keyframes, .distance = query.distance, .time = query.time},
                           {}, database.clip_names());
    if (!path || std::abs(path->distance - query.distance) > 1.0 || std::abs(path->time - query.time) > 1.0) {
      continue;
    }
    query.path = std::move(*path);
    queries.push_back(std::move(query));
  }
  return queries;
}

int run(int argc, char** argv) {
  if (argc < 5) {
    fmt::print(stderr, "usage: {} DATABASE GRAPH QUERIES CLIP:FRAME,CLIP:FRAME...\n", argv[0]);
    return 2;
  }
  const PerformanceDatabase database = load_database(argv[1]);
  const SurfaceMotionGraph graph = load_graph(argv[2]);
  const auto count = static_cast<std::size_t>(std::stoul(argv[3]));
  compare_inbetweens(database, PoissonReconstruction(database.topology(), database.clip(0).frame(0)));

  std::vector<std::vector<Eigen::Vector2d>> trajectories;
  for (const MeshSequence& clip : database.clips()) trajectories.push_back(ground_trajectory(clip));
  const PathMetrics metrics(std::move(trajectories), graph.active_transitions(), graph.options.profile,
                            database.frames_per_second());
  std::vector<Query> queries;
  for (int i = 4; i < argc; ++i) {
    const std::string pair = argv[i];
    const std::size_t comma = pair.find(',');
    if (comma == std::string::npos) throw InvalidArgument(fmt::format("'{}': expected two key-frames", pair));
    for (Query& query : choose_queries(
             database, metrics,
             {database.parse_frame(pair.substr(0, comma)), database.parse_frame(pair.substr(comma + 1))},
             count)) {
      queries.push_back(std::move(query));
    }
  }

  const Synthesizer synthesizer(database);
  std::vector<Variant> variants = {
      {.name = "path as found"},
      {.name = "feet planted", .plants_feet = true},
      {.name = "corrected", .is_corrected = true},
      {.name = "corrected, feet planted", .is_corrected = true, .plants_feet = true}};
  Naturalness captured;
  for (const Query& query : queries) {
    const Correction correction =
        plan_correction(query.path, query.distance, query.time, database.frames_per_second(),
                        {.max_retiming = 0.1, .max_stretch = 0.1});
    for (Variant& variant : variants) {
      SynthesisOptions options{.profile = graph.options.profile, .plant_feet = variant.plants_feet};
      if (variant.is_corrected) options.correction = correction;
      const double start = processor_seconds();
      const MeshSequence motion = synthesizer.synthesize(query.path, options);
      variant.seconds += processor_seconds() - start;
      const auto trajectory = ground_trajectory(motion);
      const double distance = ground_distance(trajectory, 0, trajectory.size() - 1);
      variant.distance.add(distance - query.distance);
      variant.time.add(motion.duration() - query.time);
      variant.prediction.add(distance - (variant.is_corrected ? correction.distance : query.path.distance));
      const Naturalness n = evaluate_naturalness(motion, database);
      variant.pop = std::max(variant.pop, n.pop_ratio);
      variant.peak = std::max(variant.peak, peak_acceleration(motion) / n.captured_acceleration_p99);
      variant.drift += n.foot_drift;
      variant.blend_drift += n.blend_foot_drift;
      variant.edge_stretch = std::max(variant.edge_stretch, n.edge_stretch_p99);
      variant.frames += motion.frame_count();
      ++variant.animations;
      captured = n;
    }
  }
  fmt::print("{} animations; captured clips: pop ratio {:.2f}, foot drift {:.2f} cm/s, edge stretch {:.3f}\n",
             queries.size(), captured.captured_pop_ratio, captured.captured_foot_drift,
             captured.captured_edge_stretch_p99);
  fmt::print(
      "| | distance error, m: rms (max) | time error, s: rms (max) | measured beside predicted, mm: max | "
      "pop ratio, max | whole motion | foot drift, cm/s | inside blends | edge stretch, max | CPU ms a frame "
      "|\n");
  fmt::print("|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Variant& v : variants) {
    const auto animations = static_cast<double>(std::max<std::size_t>(v.animations, 1));
    fmt::print(
        "| {} | {:.4f} ({:.3f}) | {:.4f} ({:.2f}) | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.3f} | "
        "{:.2f} |\n",
        v.name, v.distance.rms(), v.distance.largest, v.time.rms(), v.time.largest,
        1e3 * v.prediction.largest, v.pop, v.peak, v.drift / animations, v.blend_drift / animations,
        v.edge_stretch, 1e3 * v.seconds / static_cast<double>(std::max<std::size_t>(v.frames, 1)));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}
