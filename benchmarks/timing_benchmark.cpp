// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// How well repeated and skipped frames are played over: every second frame of each clip is taken out, a query
// passes through the clip at a pace that swings between half and one and a half frames of what is left, and
// is shown the nearest frames, or frames beside them. What it should have been shown was captured.
//
//     timing_benchmark DATABASE...

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "reprise/core/random.h"
#include "reprise/io/database_file.h"
#include "reprise/synthesis/path_player.h"

namespace {

using namespace reprise;

struct Errors {
  double position = 0.0;  // squared, m^2, summed over vertices
  double velocity = 0.0;
  double acceleration = 0.0;       // largest of a vertex, m/frame^2
  double true_acceleration = 0.0;  // the same of the captured frames
  std::size_t positions = 0;
  std::size_t velocities = 0;
  double seconds = 0.0;
  std::size_t frames = 0;
};

// Captured frames that a query shows: one, two or three further each time, in long swings.
std::vector<std::size_t> query_frames(std::size_t count, double phase) {
  std::vector<std::size_t> frames;
  double time = 0.0;
  for (int k = 0; time <= static_cast<double>(count - 1); ++k) {
    frames.push_back(static_cast<std::size_t>(time));
    time += std::round(2.0 + 1.4 * std::sin(0.17 * k + phase));
  }
  return frames;
}

double largest_row(const Positions& rows) {
  return std::sqrt(static_cast<double>(rows.rowwise().squaredNorm().maxCoeff()));
}

void compare(const MeshSequence& clip, double phase, const PoissonReconstruction& poisson, double unsure,
             Timing timing, Errors& errors) {
  const std::vector<std::size_t> query = query_frames(clip.frame_count(), phase);
  PerformanceDatabase thinned;
  MeshSequence half(clip.name(), clip.topology(), (clip.frame_count() + 1) / 2, clip.frames_per_second());
  for (std::size_t f = 0; f < half.frame_count(); ++f) half.frame(f) = clip.frame(2 * f);
  const int last = static_cast<int>(half.frame_count()) - 1;
  thinned.add(std::move(half));
  MotionPath path;
  path.segments = {{.clip_idx = 0, .first_frame = 0, .last_frame = last, .transition = {}}};
  path.frame_count = last + 1;

  std::vector<int> path_frame;
  const RandomField field(1);
  for (std::size_t k = 0; k < query.size(); ++k) {
    // Half-way between two frames either is the nearest: now this one, now that one (`nearbyint`).
    const double wanted = 0.5 * static_cast<double>(query[k]) + unsure * field.normal_pair(k, 0)[0];
    const int before = path_frame.empty() ? 0 : path_frame.back();
    const int most = path_frame.empty() ? 0 : before + 2;
    path_frame.push_back(std::min(std::clamp(static_cast<int>(std::nearbyint(wanted)), before, most), last));
  }
  const std::clock_t start = std::clock();  // of all threads
  const PathPlayer player(thinned, poisson, path, BlendProfile::smooth, path_times(path_frame, timing));
  const MeshSequence made = player.frames(0, player.frame_count());
  errors.seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  errors.frames += query.size();
  for (std::size_t k = 0; k < query.size(); ++k) {
    const PositionsView truth = clip.frame(query[k]);
    const Positions off = made.frame(k) - truth;
    errors.position += static_cast<double>(off.squaredNorm());
    errors.positions += static_cast<std::size_t>(off.rows());
    if (k == 0) continue;
    const Positions off_before = made.frame(k - 1) - clip.frame(query[k - 1]);
    errors.velocity += static_cast<double>((off - off_before).squaredNorm());
    errors.velocities += static_cast<std::size_t>(off.rows());
    if (k == 1) continue;
    errors.acceleration = std::max(errors.acceleration,
                                   largest_row(made.frame(k) - 2.0F * made.frame(k - 1) + made.frame(k - 2)));
    errors.true_acceleration =
        std::max(errors.true_acceleration,
                 largest_row(truth - 2.0F * clip.frame(query[k - 1]) + clip.frame(query[k - 2])));
  }
}

void measure(const std::string& path) {
  const PerformanceDatabase database = load_database(path);
  const PoissonReconstruction poisson(database.topology(), database.clip(0).frame(0));
  constexpr std::pair<Timing, const char*> timings[] = {
      {Timing::repeats, "repeats"}, {Timing::linear, "linear"}, {Timing::smooth, "smooth"}};
  constexpr std::pair<double, const char*> retrievals[] = {{0.0, "nearest frames"}, {0.3, "frames beside"}};
  fmt::print(
      "\n{}\n\n| retrieved | timing | vertices, mm rms | their velocity, mm/frame rms | greatest "
      "acceleration, share of the true one | ms a frame |\n|---|---|---|---|---|---|\n",
      path);
  for (const auto& [unsure, retrieved] : retrievals) {
    for (const auto& [timing, name] : timings) {
      Errors errors;
      for (std::size_t c = 0; c < database.clips().size(); ++c) {
        const MeshSequence& clip = database.clip(c);
        const auto phase = 2.0 * static_cast<double>(c);
        if (clip.frame_count() >= 8) compare(clip, phase, poisson, unsure, timing, errors);
      }
      const auto rms = [](double sum, std::size_t count) {
        return 1e3 * std::sqrt(sum / static_cast<double>(count));
      };
      fmt::print("| {} | {} | {:.1f} | {:.1f} | {:.2f} | {:.2f} |\n", retrieved, name,
                 rms(errors.position, errors.positions), rms(errors.velocity, errors.velocities),
                 errors.acceleration / errors.true_acceleration,
                 1e3 * errors.seconds / static_cast<double>(errors.frames));
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc < 2) {
      std::fputs("usage: timing_benchmark DATABASE...\n", stderr);
      return 2;
    }
    for (int i = 1; i < argc; ++i) measure(argv[i]);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}
