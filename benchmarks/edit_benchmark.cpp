// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Time of one drag of a captured frame by the learnt parts of its performer, beside CGAL's as-rigid-as-
// possible deformation with the same handles and anchors and CHOLMOD's bare back-substitution, and of
// learning the parts. Everything on one thread, processor time.
//
//   edit_benchmark DATABASE...   databases with a markup, such as `reprise perform` writes; if REPRISE_DATA
//                                names a folder of captures, `ama` besides

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "cholmod_peer.h"
#include "real_data.h"
#include "reprise/database/body_parts.h"
#include "reprise/deform/example_selection.h"
#include "reprise/deform/laplacian_editor.h"
#include "reprise/deform/learning.h"
#include "reprise/deform/part_editor.h"
#include "reprise/deform/surface_laplacian.h"
#include "reprise/io/database_file.h"
#include "reprise/io/markup_file.h"
#include "reprise/skeleton/markup_proposal.h"
#include "thread_time.h"
#ifdef REPRISE_HAS_CGAL
#include "arap_peer.h"
#endif

namespace {

using namespace reprise;
using benchmark::thread_ms;

constexpr int drags = 20;   // targets on the circle
constexpr int rounds = 10;  // of all drags
constexpr std::size_t example_count = 100;

PositionsView view(const Positions& positions) {
  return {positions.data(), positions.rows(), 3};
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// About twenty vertices spread over the label of a joint.
std::vector<std::int32_t> some_of(const Markup& markup, const std::string& joint) {
  const std::vector<std::int32_t> all = markup.vertices_of_joint(markup.skeleton.joint_idx(joint));
  const std::size_t step = std::max<std::size_t>(1, all.size() / 20);
  std::vector<std::int32_t> some;
  for (std::size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
  return some;
}

// Handles that go round a circle of 10 cm, first where they are, while anchors stay.
struct Drag {
  std::string name;
  std::vector<std::int32_t> handles;
  std::vector<std::int32_t> anchors;

  std::vector<PositionConstraint> constraints(const Positions& frame, int step) const {
    constexpr double radius = 0.1;  // metres
    const double angle = 2.0 * std::numbers::pi * step / drags;
    const Eigen::Vector3d move(radius * std::sin(angle), radius * (std::cos(angle) - 1.0), 0.0);
    std::vector<PositionConstraint> constraints;
    const auto add = [&](std::int32_t v, const Eigen::Vector3d& by) {
      constraints.push_back({.vertex = v, .target = frame.row(v).cast<double>().transpose() + by});
    };
    for (const std::int32_t v : handles) add(v, move);
    for (const std::int32_t v : anchors) add(v, Eigen::Vector3d::Zero());
    return constraints;
  }
};

struct Timing {
  double first = 0.0, median = 0.0;  // ms
  double iterations = 0.0;           // mean
  double residual = 0.0;             // metres: handle least well met in any drag
};

// All drags, the first of them apart since it factorises. A drag is done when the frame can be drawn: with
// normals.
Timing time_editor(SurfaceEditor& editor, const Topology& topology, const Positions& frame,
                   const Drag& drag) {
  editor.set_frame(view(frame));
  Timing timing;
  std::vector<double> times;
  Positions shown;
  for (int repeat = -1; repeat < rounds * drags; ++repeat) {
    const std::vector<PositionConstraint> constraints = drag.constraints(frame, (repeat + drags) % drags);
    const double start = thread_ms();
    const DeformReport report = editor.deform(constraints);
    shown = editor.positions().cast<float>();
    const Positions normals = vertex_normals(topology, view(shown));
    const double ms = thread_ms() - start;
    if (repeat < 0) {
      timing.first = ms;
      continue;
    }
    times.push_back(ms);
    timing.iterations += static_cast<double>(report.iterations) / (rounds * drags);
    timing.residual = std::max(timing.residual, report.largest_residual);
  }
  timing.median = median(std::move(times));
  timing.first -= timing.median;
  return timing;
}

void print_row(const char* what, double ms, double baseline, double first, const std::string& remark) {
  fmt::print("    {:34} {:9.3f} ms  x{:<8.3f} {:9.1f} ms   {}\n", what, ms, ms / baseline, first, remark);
}

// The matrix of plain Laplacian editing with these constraints, lower triangle.
Eigen::SparseMatrix<double> system_matrix(const TopologyPtr& topology, const Positions& reference,
                                          const std::vector<PositionConstraint>& constraints) {
  const SurfaceLaplacian laplacian(topology, view(reference));
  Eigen::SparseMatrix<double> A = laplacian.matrix().transpose() * laplacian.matrix();
  const double weight = PartEditorOptions().constraint_weight / mean_edge_length(*topology, view(reference));
  for (const PositionConstraint& constraint : constraints)
    A.coeffRef(constraint.vertex, constraint.vertex) += weight * weight;
  return A.triangularView<Eigen::Lower>();
}

void measure_drag(const TopologyPtr& topology, const Markup& markup, const Positions& frame,
                  const std::shared_ptr<const PartModel>& model, const Drag& drag) {
  std::vector<std::int32_t> held = drag.handles;
  held.insert(held.end(), drag.anchors.begin(), drag.anchors.end());
  fmt::print("  {}: {} handles, {} anchors\n", drag.name, drag.handles.size(), drag.anchors.size());
  fmt::print("    {:34} {:>12}  {:9} {:>12}\n", "", "one drag", "ratio", "preparation");

  // CHOLMOD.
  const Eigen::SparseMatrix<double> A = system_matrix(topology, markup.reference, drag.constraints(frame, 0));
  const double start = thread_ms();
  benchmark::CholmodPeer cholmod(A, CHOLMOD_SIMPLICIAL, CHOLMOD_AMD);
  const double factorization = thread_ms() - start;
  Eigen::MatrixXd b = frame.cast<double>();
  std::vector<double> times;
  for (int repeat = 0; repeat < rounds * drags; ++repeat) {
    const double before = thread_ms();
    cholmod.solve(b);
    times.push_back(thread_ms() - before);
  }
  const double bare = median(std::move(times));

  std::optional<double> arap;
#ifdef REPRISE_HAS_CGAL
  benchmark::ArapPeer peer(*topology, frame, held);
  std::string remark = peer.refusal();
  if (remark.empty()) {
    times.clear();
    for (int repeat = -1; repeat < 2 * drags; ++repeat) {
      const std::vector<PositionConstraint> constraints = drag.constraints(frame, (repeat + drags) % drags);
      const double before = thread_ms();
      peer.drag(constraints);
      if (repeat >= 0) times.push_back(thread_ms() - before);
    }
    arap = median(std::move(times));
    bool is_finite = true;
    for (std::int32_t v = 0; v < topology->vertex_count; ++v)
      is_finite = is_finite && peer.position(v).allFinite();
    remark = is_finite ? "10 iterations, without normals" : "10 iterations; the result is not finite";
    print_row("CGAL ARAP", *arap, *arap, peer.preparation_ms(), remark);
  } else {
    fmt::print("    CGAL ARAP: {}\n", remark);
  }
#endif
  const double baseline = arap.value_or(bare);
  const auto row = [&](const char* what, SurfaceEditor& editor) {
    const Timing timing = time_editor(editor, *topology, frame, drag);
    print_row(what, timing.median, baseline, timing.first,
              fmt::format("{:.0f} bare solves; {:.1f} iterations; handles within {:.1f} mm",
                          timing.median / bare, timing.iterations, 1e3 * timing.residual));
  };
  PartEditor parts(model);
  row("learnt parts", parts);
  LaplacianEditor plain(topology, view(markup.reference));
  row("plain Laplacian editing", plain);
  print_row("CHOLMOD's bare solve", bare, baseline, factorization, "3 right-hand sides, simplicial");
}

// The frame in the middle of the last clip, as one that few examples are near to.
void measure(const std::string& name, const PerformanceDatabase& database) {
  const TopologyPtr& topology = database.topology();
  const Markup& markup = *database.markup();
  fmt::print("{}: {} vertices, {} frames\n", name, topology->vertex_count, database.frame_count());

  double start = thread_ms();
  const std::vector<BodyPart> parts =
      body_parts(*topology, markup.reference, markup.skeleton, markup.joint_of_vertex);
  std::vector<std::vector<FrameId>> examples;
  for (const BodyPart& part : parts) {
    examples.push_back(select_examples(database, markup.reference, part.vertices,
                                       {.count = example_count, .smallest_radius = 0.0})
                           .frames);
  }
  const double choosing = 1e-3 * (thread_ms() - start);
  start = thread_ms();
  const LearntModel learnt = learn_model(database, markup.reference, parts, examples);
  const double learning = 1e-3 * (thread_ms() - start);
  fmt::print(
      "  learning {} parts from {} examples each: {:.2f} s; choosing the examples among all frames: "
      "{:.2f} s\n",
      parts.size(), examples.front().size(), learning, choosing);
  for (const LearntPart& part : learnt.parts)
    fmt::print("    {}: {} vertices, {} components\n", part.part.name, part.part.vertices.size(),
               part.component_count());

  const auto model = std::make_shared<const PartModel>(topology, learnt);
  const MeshSequence& clip = database.clips().back();
  const Positions frame = clip.frame(clip.frame_count() / 2);
  std::vector<std::int32_t> feet = some_of(markup, "left_foot");
  for (const std::int32_t v : some_of(markup, "right_foot")) feet.push_back(v);
  measure_drag(topology, markup, frame, model, {"a hand", some_of(markup, "left_hand"), feet});
  measure_drag(topology, markup, frame, model,
               {"the chest, so that all parts move", some_of(markup, "chest"), feet});
  fmt::print("\n");
}

}  // namespace

int main(int argc, char** argv) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  fmt::print("medians of {} drags, one thread, processor time\n\n", rounds * drags);
  for (int i = 1; i < argc; ++i) {
    const PerformanceDatabase database = load_database(argv[i]);
    if (!database.markup()) {
      fmt::print(stderr, "{}: has no markup\n", argv[i]);
      return 2;
    }
    measure(std::filesystem::path(argv[i]).filename().string(), database);
  }
  if (std::getenv("REPRISE_DATA") != nullptr) {
    PerformanceDatabase ama = benchmark::ama();
    const LandmarkFile landmarks =
        read_landmark_file(std::filesystem::path(REPRISE_SOURCE_DIR) / "tests/fixtures/ama_landmarks.json");
    const FrameId id = ama.parse_frame(landmarks.frame);
    ama.set_markup(propose_markup(ama.clip(id.clip_idx).mesh(id.frame_idx), landmarks.landmarks));
    measure("ama", ama);
  }
  return 0;
}
