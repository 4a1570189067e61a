// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Weights, skinning and pose fits on a performer's database with its truth: times on one thread, and how far
// the skinned surface is from the captured one. With a second argument, a database to look at: the weights as
// colours, and one far bent pose under both skinnings.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/deform/pose_fit.h"
#include "reprise/io/database_file.h"
#include "thread_time.h"

namespace {

using namespace reprise;
using benchmark::thread_ms;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr auto skinnings = {Skinning::linear, Skinning::dual_quaternion};

const char* name_of(Skinning skinning) {
  return skinning == Skinning::linear ? "linear" : "dual quaternion";
}

PositionsView view(const Positions& positions) {
  return {positions.data(), positions.rows(), 3};
}

PositionsRef ref(Positions& positions) {
  return {positions.data(), positions.rows(), 3};
}

struct Mean {
  double sum = 0.0, largest = 0.0;
  int count = 0;

  void add(double value) {
    sum += value;
    largest = std::max(largest, value);
    ++count;
  }
  double mean() const { return sum / std::max(count, 1); }
};

// The reference surface skinned to the true pose of every fifth frame, against that frame.
void compare_with_frames(const PerformanceDatabase& database, const SkinWeights& weights, Skinning skinning) {
  const Markup& markup = *database.markup();
  const SkeletonPose rest = rest_pose(markup.skeleton);
  Mean labelled, free, time;
  Positions result(markup.reference.rows(), 3);
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    for (std::size_t f = 0; f < database.clip(c).frame_count(); f += 5) {
      const double start = thread_ms();
      skin(weights, markup.skeleton, view(markup.reference), rest, database.truth(c)->poses[f], skinning,
           ref(result));
      time.add(thread_ms() - start);
      const PositionsView frame = database.clip(c).frame(f);
      for (Eigen::Index v = 0; v < result.rows(); ++v) {
        const bool is_free = markup.joint_of_vertex[static_cast<std::size_t>(v)] < 0;
        (is_free ? free : labelled).add(100.0 * (result.row(v) - frame.row(v)).norm());
      }
    }
  }
  fmt::print(
      "  {:15}  {:.3f} ms a frame; from the captured frame: with label {:.2f} cm (max {:.1f}), without "
      "{:.2f}\n",
      name_of(skinning), time.mean(), labelled.mean(), labelled.largest, free.mean());
}

// One captured frame is fitted to some labelled vertices of another; 40 pairs.
void fit_frames(const PerformanceDatabase& database, const SkinWeights& weights, Skinning skinning,
                std::size_t constraint_count) {
  const Markup& markup = *database.markup();
  std::vector<std::int32_t> labelled;
  for (std::size_t v = 0; v < markup.joint_of_vertex.size(); ++v) {
    if (markup.joint_of_vertex[v] >= 0) labelled.push_back(static_cast<std::int32_t>(v));
  }
  std::mt19937_64 random(5);
  const auto any_frame = [&] {
    const std::size_t c = random() % database.clips().size();
    return FrameId{c, random() % database.clip(c).frame_count()};
  };
  Mean time, residual, error, iterations;
  Positions result(markup.reference.rows(), 3);
  for (int pair = 0; pair < 40; ++pair) {
    const FrameId from = any_frame(), to = any_frame();
    const PositionsView source = database.clip(from.clip_idx).frame(from.frame_idx);
    const PositionsView target = database.clip(to.clip_idx).frame(to.frame_idx);
    const SkeletonPose& source_pose = database.truth(from.clip_idx)->poses[from.frame_idx];
    std::vector<PositionConstraint> constraints;
    for (std::size_t i = 0; i < constraint_count; ++i) {
      std::swap(labelled[i], labelled[i + random() % (labelled.size() - i)]);
      constraints.push_back(
          {.vertex = labelled[i], .target = target.row(labelled[i]).cast<double>().transpose()});
    }
    const double start = thread_ms();
    const PoseFit fit =
        fit_pose(weights, markup.skeleton, source, source_pose, constraints, {.skinning = skinning});
    time.add(thread_ms() - start);
    iterations.add(fit.iterations);
    residual.add(100.0 * fit.residual);
    skin(weights, markup.skeleton, source, source_pose, fit.pose, skinning, ref(result));
    for (const std::int32_t v : labelled) error.add(100.0 * (result.row(v) - target.row(v)).norm());
  }
  fmt::print(
      "  {:15}  {:2} constraints: {:.2f} ms (max {:.1f}), {:.0f} iterations, left {:.2f} cm; vertices with "
      "label "
      "{:.2f} cm\n",
      name_of(skinning), constraint_count, time.mean(), time.largest, iterations.mean(), residual.mean(),
      error.mean());
}

// Arms lifted and wrung, one knee drawn up.
SkeletonPose bent_pose(const Skeleton& skeleton) {
  struct Turn {
    const char* joint;
    double degrees;
    Vector3d axis;
  };
  const std::array<Turn, 10> turns{{{"spine", 25, Vector3d::UnitY()},
                                    {"head", 40, Vector3d::UnitY()},
                                    {"left_upper_arm", 100, Vector3d::UnitZ()},
                                    {"left_forearm", -60, Vector3d::UnitY()},
                                    {"left_hand", 60, Vector3d::UnitX()},
                                    {"right_upper_arm", -20, Vector3d::UnitX()},
                                    {"right_forearm", -110, Vector3d::UnitX()},
                                    {"left_thigh", -85, Vector3d::UnitX()},
                                    {"left_shin", 100, Vector3d::UnitX()},
                                    {"right_thigh", -15, Vector3d::UnitZ()}}};
  std::vector<Quaterniond> rotations(skeleton.joints.size(), Quaterniond::Identity());
  for (const Turn& turn : turns) {
    rotations[static_cast<std::size_t>(skeleton.joint_idx(turn.joint))] =
        Quaterniond(Eigen::AngleAxisd(turn.degrees * std::numbers::pi / 180.0, turn.axis));
  }
  for (std::size_t j = 0; j < rotations.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    if (parent >= 0) rotations[j] = rotations[static_cast<std::size_t>(parent)] * rotations[j];
  }
  return pose_from_rotations(skeleton, rotations, skeleton.joints[0].rest_position);
}

// Bones in turn around the circle of hues, mixed by their weights.
std::vector<Color> weight_colors(const SkinWeights& weights) {
  std::vector<Color> colors;
  for (Eigen::Index v = 0; v < weights.rows(); ++v) {
    Vector3d sum = Vector3d::Zero();
    for (SkinWeights::InnerIterator it(weights, v); it; ++it) {
      const double hue = 2.0 * std::numbers::pi * 0.31 * static_cast<double>(it.col());
      for (int k = 0; k < 3; ++k) {
        sum[k] += it.value() * (140.0 + 100.0 * std::cos(hue - 2.0 * std::numbers::pi * k / 3.0));
      }
    }
    Color color{};
    for (std::size_t k = 0; k < 3; ++k)
      color[k] = static_cast<std::uint8_t>(std::lround(sum[static_cast<int>(k)]));
    colors.push_back(color);
  }
  return colors;
}

void write_pictures(const PerformanceDatabase& database, const SkinWeights& weights,
                    const std::string& path) {
  const Markup& markup = *database.markup();
  DatabaseWriter writer(path, database.topology());
  const auto write = [&](const std::string& name, const Positions& positions, std::vector<Color> colors) {
    MeshSequence clip(name, database.topology(), 1, 25.0);
    clip.frame(0) = positions;
    if (!colors.empty()) clip.set_colors(std::move(colors));
    writer.write_clip(clip);
  };
  write("weights", markup.reference, weight_colors(weights));
  const SkeletonPose bent = bent_pose(markup.skeleton);
  for (const Skinning skinning : skinnings) {
    Positions result(markup.reference.rows(), 3);
    skin(weights, markup.skeleton, view(markup.reference), rest_pose(markup.skeleton), bent, skinning,
         ref(result));
    std::vector<Color> colors;
    if (database.clip(0).has_colors()) {
      const auto first = database.clip(0).colors(0);
      colors.assign(first.begin(), first.end());
    }
    write(skinning == Skinning::linear ? "linear" : "dual", result, std::move(colors));
  }
  writer.commit();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    fmt::print(stderr, "usage: skinning_benchmark PERFORMER.reprise [PICTURES.reprise]\n");
    return 2;
  }
  try {
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    const PerformanceDatabase database = load_database(argv[1]);
    if (!database.markup() || database.truth(0) == nullptr) {
      throw InvalidArgument("expected a database with markup and truth, as `reprise perform` makes it");
    }
    const double start = thread_ms();
    const SkinWeights weights = skin_weights(database.topology(), *database.markup());
    fmt::print("{} vertices, {} joints; weights: {:.0f} ms, {:.1f} bones a vertex\n", weights.rows(),
               weights.cols(), thread_ms() - start,
               static_cast<double>(weights.nonZeros()) / static_cast<double>(weights.rows()));
    for (const Skinning skinning : skinnings) compare_with_frames(database, weights, skinning);
    for (const std::size_t count : {10U, 40U}) {
      for (const Skinning skinning : skinnings) fit_frames(database, weights, skinning, count);
    }
    if (argc == 3) write_pictures(database, weights, argv[2]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
