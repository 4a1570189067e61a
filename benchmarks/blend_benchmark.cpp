// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Time of one blended frame, and of its back-substitution beside those of CHOLMOD and Eigen on the same
// matrix in the same run. One thread, processor time. Uses two captured frames if REPRISE_DATA names a folder
// of captures, else a sphere.

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/SparseCholesky>
#include <fmt/format.h>

#include "cholmod_peer.h"
#include "reprise/deform/blend.h"
#include "reprise/io/sequence_reader.h"
#include "support/shapes.h"
#include "thread_time.h"

namespace {

using namespace reprise;
using benchmark::CholmodPeer;
using benchmark::thread_ms;

// Median time in milliseconds.
template <typename Work>
double median_ms(const Work& work) {
  std::vector<double> times;
  for (int repeat = 0; repeat < 210; ++repeat) {
    const double start = thread_ms();
    work();
    if (repeat >= 10) times.push_back(thread_ms() - start);
  }
  std::nth_element(times.begin(), times.begin() + 100, times.end());
  return times[100];
}

struct Pair {
  std::string name;
  TopologyPtr topology;
  Positions source;
  Positions target;
};

Pair load_pair() {
  if (const char* folder = std::getenv("REPRISE_DATA"); folder != nullptr) {
    const std::filesystem::path ama = std::filesystem::path(folder) / "ama";
    const auto crane = open_sequence({.path = ama / "crane"});
    return {"ama crane 20, jumping 60", crane->topology(), crane->read(20).positions,
            open_sequence({.path = ama / "jumping"})->read(60).positions};
  }
  test::Shape sphere = test::sphere(6);
  for (Eigen::Index v = 0; v < sphere.positions.rows(); ++v) sphere.positions(v, 0) *= 1.5F;
  Positions target = sphere.positions;
  for (Eigen::Index v = 0; v < target.rows(); ++v) target(v, 2) += 0.3F * target(v, 0) * target(v, 0);
  return {"sphere", sphere.topology, sphere.positions, target};
}

PositionsView view(const Positions& positions) {
  return {positions.data(), positions.rows(), 3};
}

void row(const char* what, double ms, double baseline, double nonzeros, double error) {
  fmt::print("  {:44} {:8.3f} ms  x{:<6.2f} {:>9.0f} entries   error {:.1e}\n", what, ms, ms / baseline,
             nonzeros, error);
}

}  // namespace

int main() {
  const Pair pair = load_pair();
  const double start = thread_ms();
  const PoissonReconstruction poisson(pair.topology, view(pair.source));
  const double set_up = thread_ms() - start;
  fmt::print(
      "{}: {} vertices, {} triangles; set-up once {:.0f} ms; medians of 200, one thread, processor time\n\n",
      pair.name, pair.topology->vertex_count, pair.topology->triangles.size(), set_up);

  Positions blended(pair.source.rows(), 3);
  const double blend = median_ms([&] {
    blend_frames(poisson, view(pair.source), view(pair.target), 0.4,
                 PositionsRef(blended.data(), blended.rows(), 3));
  });
  const double gradients = median_ms([&] { poisson.gradients(view(pair.target)); });
  const GradientField field = poisson.gradients(view(pair.source));
  const GradientField target_field = poisson.gradients(view(pair.target));
  const double interpolation = median_ms([&] { interpolate(field, target_field, 0.4); });
  const Eigen::MatrixX3d centroids = poisson.component_centroids(view(pair.source));
  const double reconstruction = median_ms([&] { poisson.reconstruct(field, centroids); });

  // The matrix as it is factorised: one vertex of each component held, here one component.
  Eigen::SparseMatrix<double> L = poisson.laplacian();
  L.coeffRef(0, 0) *= 2.0;
  const Eigen::SparseMatrix<double> lower = L.triangularView<Eigen::Lower>();
  const Eigen::MatrixXd truth = pair.source.cast<double>();
  Eigen::MatrixXd b = L * truth;
  const auto error = [&](const Eigen::MatrixXd& x) { return (x - truth).cwiseAbs().maxCoeff(); };

  CholmodPeer simplicial(lower, CHOLMOD_SIMPLICIAL, CHOLMOD_AMD);
  CholmodPeer simplicial_metis(lower, CHOLMOD_SIMPLICIAL, CHOLMOD_METIS);
  CholmodPeer supernodal(lower, CHOLMOD_SUPERNODAL, CHOLMOD_AMD);
  CholmodPeer supernodal_metis(lower, CHOLMOD_SUPERNODAL, CHOLMOD_METIS);
  const double baseline = median_ms([&] { simplicial.solve(b); });

  fmt::print("one frame\n");
  const auto stage = [](const char* what, double ms) { fmt::print("  {:44} {:8.3f} ms\n", what, ms); };
  stage("blend_frames: gradients, blend, solve, write", blend);
  stage("one gradient field alone", gradients);
  stage("interpolate alone", interpolation);
  stage("reconstruct alone", reconstruction);

  fmt::print("\nback-substitution, 3 right-hand sides (ratio to CHOLMOD simplicial)\n");
  {
    const SparseCholesky cholesky(lower);
    const SparseCholesky::RowMajorMatrix rhs = b;
    SparseCholesky::RowMajorMatrix x = rhs;
    const double ms = median_ms([&] {
      x = rhs;
      cholesky.solve_in_place(x);
    });
    row("Reprise SparseCholesky, row-major", ms, baseline, static_cast<double>(cholesky.factor_nonzeros()),
        error(x));
    row("Reprise SparseCholesky, column-major", median_ms([&] { cholesky.solve(b); }), baseline,
        static_cast<double>(cholesky.factor_nonzeros()), error(cholesky.solve(b)));
  }
  row("CHOLMOD simplicial, AMD", baseline, baseline, simplicial.factor_nonzeros(),
      error(simplicial.solve(b)));
  row("CHOLMOD simplicial, METIS", median_ms([&] { simplicial_metis.solve(b); }), baseline,
      simplicial_metis.factor_nonzeros(), error(simplicial_metis.solve(b)));
  row("CHOLMOD supernodal (GPL), AMD", median_ms([&] { supernodal.solve(b); }), baseline,
      supernodal.factor_nonzeros(), error(supernodal.solve(b)));
  row("CHOLMOD supernodal (GPL), METIS", median_ms([&] { supernodal_metis.solve(b); }), baseline,
      supernodal_metis.factor_nonzeros(), error(supernodal_metis.solve(b)));
  {
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt(L);
    Eigen::MatrixXd x;
    const double ms = median_ms([&] { x = ldlt.solve(b); });
    row("Eigen SimplicialLDLT", ms, baseline,
        static_cast<double>(ldlt.matrixL().nestedExpression().nonZeros()), error(x));
  }
  return 0;
}
