// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/earth_movers_distance.h"

#include <map>
#include <random>

#include <gtest/gtest.h>
#include <lemon/network_simplex.h>
#include <lemon/smart_graph.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

std::shared_ptr<const BinGrid> small_grid() {
  const HistogramOptions options{.radius_bins = 3, .polar_bins = 4, .azimuth_bins = 8};
  return std::make_shared<const BinGrid>(
      options, 0.95, std::vector<BinGrid::ColorBin>{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {9, 3, 1}});
}

Signature signature_of(const std::map<BinId, int>& masses) {
  Signature signature;
  for (const auto& [bin, mass] : masses) {
    signature.bins.push_back(bin);
    signature.masses.push_back(mass);
    signature.total += mass;
  }
  return signature;
}

Signature random_signature(const BinGrid& grid, std::mt19937& random, int size, int largest_mass) {
  std::uniform_int_distribution<BinId> bin(0, grid.cell_count() * grid.color_count() - 1);
  std::uniform_int_distribution<int> mass(1, largest_mass);
  std::map<BinId, int> masses;
  for (int k = 0; k < size; ++k) masses[bin(random)] += mass(random);
  return signature_of(masses);
}

// A few of the masses moved to other bins, the total kept.
Signature disturbed(const Signature& signature, const BinGrid& grid, std::mt19937& random) {
  std::map<BinId, int> masses;
  std::uniform_int_distribution<BinId> bin(0, grid.cell_count() * grid.color_count() - 1);
  std::bernoulli_distribution moves(0.2);
  for (std::size_t k = 0; k < signature.size(); ++k) {
    masses[moves(random) ? bin(random) : signature.bins[k]] += signature.masses[k];
  }
  return signature_of(masses);
}

// The same problem, solved by LEMON over all arcs.
double lemon_distance(const BinGrid& grid, const Signature& a, const Signature& b) {
  lemon::SmartDigraph graph;
  lemon::SmartDigraph::NodeMap<std::int64_t> supply(graph, 0);
  lemon::SmartDigraph::ArcMap<std::int64_t> cost(graph);
  std::vector<lemon::SmartDigraph::Node> sources;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sources.push_back(graph.addNode());
    supply[sources.back()] = a.masses[i] * b.total;
  }
  for (std::size_t j = 0; j < b.size(); ++j) {
    const auto sink = graph.addNode();
    supply[sink] = -b.masses[j] * a.total;
    for (std::size_t i = 0; i < a.size(); ++i) {
      cost[graph.addArc(sources[i], sink)] = grid.distance(a.bins[i], b.bins[j]);
    }
  }
  lemon::NetworkSimplex<lemon::SmartDigraph, std::int64_t, std::int64_t> simplex(graph);
  EXPECT_EQ(simplex.costMap(cost).supplyMap(supply).run(), simplex.OPTIMAL);
  return static_cast<double>(simplex.totalCost<std::int64_t>()) / static_cast<double>(a.total * b.total) *
         BinGrid::distance_unit;
}

// Difference of the means of a potential over two histograms, metres.
double bound(const std::shared_ptr<const BinGrid>& grid, const Potential& potential, const Signature& a,
             const Signature& b) {
  PotentialFunction function(grid);
  function.set(potential);
  const auto mean = [&](const Signature& s) {
    double sum = 0.0;
    for (std::size_t i = 0; i < s.size(); ++i) {
      sum += static_cast<double>(function(s.bins[i])) * s.masses[i];
    }
    return sum / static_cast<double>(s.total);
  };
  return (mean(a) - mean(b)) * BinGrid::distance_unit;
}

TEST(EarthMoversDistance, OfTwoBinsIsTheirDistance) {
  const auto grid = small_grid();
  EarthMoversSolver solver(grid);
  EXPECT_EQ(solver.solve(signature_of({{5, 3}}), signature_of({{77, 8}})).distance,
            grid->distance(5, 77) * BinGrid::distance_unit);
}

TEST(EarthMoversDistance, EqualsLemon) {
  const auto grid = small_grid();
  EarthMoversSolver solver(grid);
  std::mt19937 random(1);
  for (int k = 0; k < 400; ++k) {
    const int size = 1 + k % 60;
    // Few and small masses: many ties, the case in which a simplex may go round in circles.
    const int largest_mass = k % 3 == 0 ? 1 : 50;
    const Signature a = random_signature(*grid, random, size, largest_mass);
    const Signature b =
        k % 4 == 0 ? disturbed(a, *grid, random) : random_signature(*grid, random, size, largest_mass);
    const EarthMoversDistance result = solver.solve(a, b);
    ASSERT_TRUE(result.exact);
    ASSERT_NEAR(result.distance, lemon_distance(*grid, a, b), 1e-12) << "problem " << k;
    ASSERT_EQ(result.lower_bound, result.distance);
  }
}

TEST(EarthMoversDistance, PotentialProvesTheDistance) {
  const auto grid = small_grid();
  EarthMoversSolver solver(grid);
  std::mt19937 random(2);
  for (int k = 0; k < 50; ++k) {
    const Signature a = random_signature(*grid, random, 40, 30);
    const Signature b = random_signature(*grid, random, 40, 30);
    const double distance = solver.solve(a, b).distance;
    const Potential potential = solver.potential();
    for (std::size_t i = 0; i < potential.bins.size(); ++i) {
      for (std::size_t j = 0; j < potential.bins.size(); ++j) {
        ASSERT_LE(potential.values[i] - potential.values[j],
                  grid->distance(potential.bins[i], potential.bins[j]));
      }
    }
    PotentialFunction function(grid);
    function.set(potential);
    for (std::size_t i = 0; i < potential.bins.size(); ++i) {
      ASSERT_EQ(function(potential.bins[i]), potential.values[i]) << "the extension changes what is given";
    }
    ASSERT_NEAR(bound(grid, potential, a, b), distance, 1e-12);
  }
}

TEST(EarthMoversDistance, AnyPotentialBoundsAnyDistance) {
  const auto grid = small_grid();
  EarthMoversSolver solver(grid);
  std::mt19937 random(3);
  for (int k = 0; k < 50; ++k) {
    const Signature a = random_signature(*grid, random, 40, 30);
    const Signature b = random_signature(*grid, random, 40, 30);
    solver.solve(a, b);
    const Potential potential = solver.potential();
    // Mostly in bins where the potential is not given and has to be extended.
    const Signature c = disturbed(a, *grid, random);
    const Signature d = random_signature(*grid, random, 40, 30);
    ASSERT_LE(bound(grid, potential, c, b), solver.solve(c, b).distance + 1e-12);
    ASSERT_LE(bound(grid, potential, c, d), solver.solve(c, d).distance + 1e-12);
    ASSERT_GT(bound(grid, potential, c, b), 0.0);
  }
}

TEST(EarthMoversDistance, AGuessChangesNothing) {
  const auto grid = small_grid();
  EarthMoversSolver solver(grid);
  std::mt19937 random(4);
  for (int k = 0; k < 100; ++k) {
    const Signature a = random_signature(*grid, random, 40, 30);
    const Signature b = random_signature(*grid, random, 40, 30);
    const Signature c = disturbed(a, *grid, random);
    solver.solve(a, b);
    const Potential guess = solver.potential();
    const double with_guess = solver.solve(c, b, &guess).distance;
    const double with_itself = solver.solve(c, b, &solver.potential()).distance;
    const double without = solver.solve(c, b).distance;
    ASSERT_EQ(with_guess, without);
    ASSERT_EQ(with_itself, without);
  }
}

TEST(EarthMoversDistance, IsAMetric) {
  const auto grid = small_grid();
  EarthMoversSolver solver(grid);
  std::mt19937 random(5);
  for (int k = 0; k < 100; ++k) {
    const Signature a = random_signature(*grid, random, 1 + k % 30, 20);
    const Signature b = k % 2 == 0 ? disturbed(a, *grid, random) : random_signature(*grid, random, 20, 20);
    const Signature c = disturbed(b, *grid, random);
    const double ab = solver.solve(a, b).distance;
    EXPECT_EQ(solver.solve(a, a).distance, 0.0);
    EXPECT_EQ(solver.solve(b, a).distance, ab);
    EXPECT_LE(solver.solve(a, c).distance, ab + solver.solve(b, c).distance + 1e-15);
  }
}

TEST(EarthMoversDistance, DependsOnSharesOfMassAlone) {
  const auto grid = small_grid();
  EarthMoversSolver solver(grid);
  std::mt19937 random(6);
  const Signature a = random_signature(*grid, random, 30, 20);
  const Signature b = random_signature(*grid, random, 30, 20);
  Signature tripled = a;
  for (std::int32_t& mass : tripled.masses) mass *= 3;
  tripled.total *= 3;
  EXPECT_NEAR(solver.solve(tripled, b).distance, solver.solve(a, b).distance, 1e-15);
  EXPECT_EQ(solver.solve(tripled, a).distance, 0.0);
}

TEST(EarthMoversDistance, StopsAboveTheCutoffAndNotBelow) {
  const auto grid = small_grid();
  EarthMoversSolver solver(grid);
  std::mt19937 random(7);
  for (int k = 0; k < 50; ++k) {
    const Signature a = random_signature(*grid, random, 40, 30);
    const Signature b = disturbed(a, *grid, random);
    const double distance = solver.solve(a, b).distance;
    const EarthMoversDistance above = solver.solve(a, b, nullptr, 1.001 * distance);
    EXPECT_TRUE(above.exact);
    EXPECT_EQ(above.distance, distance);
    const EarthMoversDistance below = solver.solve(a, b, nullptr, 0.5 * distance);
    EXPECT_GT(below.lower_bound, 0.5 * distance);
    EXPECT_LE(below.lower_bound, distance);
    EXPECT_EQ(solver.potential().empty(), !below.exact);
  }
}

TEST(EarthMoversDistance, RefusesAnEmptyHistogram) {
  EarthMoversSolver solver(small_grid());
  EXPECT_THROW(solver.solve({}, signature_of({{1, 1}})), InvalidArgument);
  EXPECT_THROW(solver.solve(signature_of({{1, 1}}), {}), InvalidArgument);
}

}  // namespace
}  // namespace reprise
