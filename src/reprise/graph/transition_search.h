// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The transitions of one ordered pair of clips, best first, from a matrix of bounds.

#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <queue>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "reprise/graph/blend_acceleration.h"
#include "reprise/graph/local_minima.h"
#include "reprise/graph/pair_alignment.h"

namespace reprise {

// Everything that stays the same over all pairs.
struct TransitionSearch {
  TransitionSearch(const PerformanceDatabase& searched_database, const RefinableMatrix& searched_matrix,
                   const TransitionOptions& search_options);

  // Of the half window L.
  const WindowWeights& weights_of(int L) const {
    return weights[static_cast<std::size_t>(L - options.min_half_window)];
  }

  const PerformanceDatabase& database;
  RefinableMatrix matrix;
  const TransitionOptions& options;
  PairAlignment alignment;
  std::vector<WindowWeights> weights;
  std::vector<SampledClip> clips;
  Eigen::Index coarse_count = 0;  // first samples, enough for a good lower bound of the peak acceleration
  std::size_t batch_size = 1;     // entries made exact at a time
  bool peak_counts = true;        // in the cost
  float max_square_peak = 0.0F;   // of an admissible window
  bool peak_matters = true;       // in the cost or as a limit
};

// Best first: every pixel that may be a local minimum stands in a queue at a lower bound of its cost. The
// least is looked at more closely, in this order: the dissimilarities of its windows by their bounds; peak
// accelerations of a few samples; of all; whether it is a local minimum, which makes entries exact; the
// window that costs least, likewise. What is still first after all that is the next transition. What lies too
// near to a transition found before can only cost more and is dropped unseen. A window whose peak is above
// the limit costs infinitely much: so do bounds of it that are.
class PairSearch {
 public:
  PairSearch(const TransitionSearch& search, std::size_t source_clip, std::size_t target_clip);

  std::vector<Transition> run();

  // What `run` would find at p, were it a minimum; nothing if every window pops. Requires that the shortest
  // window fits there.
  std::optional<Transition> measure(Pixel p);

 private:
  enum class Stage : std::uint8_t { distortion, coarse_peak, windows };
  struct Candidate {
    double cost = 0.0;  // at least so much
    Pixel pixel;
    Stage stage = Stage::distortion;
    bool operator>(const Candidate& other) const {
      return std::tie(cost, pixel) > std::tie(other.cost, other.pixel);
    }
  };
  enum class Peak : std::uint8_t { coarse, cut, exact };
  // What is known of the windows of a pixel, L from `min_half_window`.
  struct Windows {
    GroundTransform source_from_target;
    std::vector<float> square_peaks;  // lower bounds unless exact
    std::vector<Peak> states;
  };
  struct Choice {
    int half_window = 0;
    double cost = 0.0;
  };

  void fill_queue();
  bool is_first(const Candidate& candidate) const;
  bool is_near_found(Pixel p) const;
  std::size_t key(Pixel p) const;
  int max_half_window(Pixel p) const;

  // Eq. 3 with lower bounds, exact where they are; of all windows of a pixel.
  const std::vector<double>& distortions(Pixel p);
  double cost(int L, double distortion, float square_peak) const;
  double least_distortion_cost(Pixel p);
  // Square of the peak above which a window cannot cost less than `least`.
  float useful_square_peak(double least, int L, double distortion) const;
  // Peaks of the first samples; returns the least cost they allow.
  double look_coarsely(Pixel p, Windows& windows);
  // The window of least cost as far as dissimilarities are known; its peak is exact.
  Choice choose(Pixel p, Windows& windows);
  void make_peak_exact(Pixel p, int L, Windows& windows);

  // Makes p exact, and with it others that are next in the queue if several are made exact at a time.
  void make_exact_with_followers(Pixel p);
  // True if an entry of the window was not exact, some are now.
  bool refine_window(Pixel p, int L);
  Transition transition(Pixel p, const Choice& choice, Windows& windows);

  const TransitionSearch& search_;
  const TransitionOptions& options_;
  std::size_t source_clip_;
  std::size_t target_clip_;
  MatrixBlock block_;
  TransitionRegion region_;
  LocalMinima minima_;
  BlendWindow blend_;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
  std::unordered_map<std::size_t, Windows> windows_;
  std::vector<Transition> found_;
  std::vector<double> diagonal_;
  std::vector<double> distortions_;
};

}  // namespace reprise
