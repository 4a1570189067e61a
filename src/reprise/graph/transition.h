// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Transitions between clips: where to leave, where to arrive, how long to blend (HSSMG 4.2).

#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "reprise/database/performance_database.h"
#include "reprise/math/ground_transform.h"
#include "reprise/similarity/dissimilarity_matrix.h"

namespace reprise {

// Blend weight along the window, alpha(-L) = 0 and alpha(L) = 1.
enum class BlendProfile {
  linear,  // Eq. 2: (k + L) / 2L; its corners at both ends are jumps of velocity
  smooth,  // smoothstep of the same: no jump of velocity
};
// alpha(k) for k in [-L, L], clamped to 0 before and 1 after. Throws `InvalidArgument` unless L >= 1.
double blend_weight(BlendProfile profile, int k, int half_window);

// Frames m - L .. m + L of the source are blended with n - L .. n + L of the target. At k = -L the pure
// source is shown, at k = L the pure target.
struct Transition {
  std::size_t source_clip = 0;
  std::size_t target_clip = 0;
  int m = 0;                           // centre frame in the source
  int n = 0;                           // centre frame in the target
  int half_window = 1;                 // L >= 1
  GroundTransform source_from_target;  // brings the target clip onto the source clip at (m, n)
  double distortion = 0.0;             // Eq. 3: weighted sum of dissimilarities over the window, metres
  // Largest acceleration of a sampled vertex inside the window when blended linearly, m/frame^2.
  double peak_acceleration = 0.0;
  // What the criterion minimised, and C_tran of a path (Eq. 8): metres, as the metric's dissimilarities.
  double cost = 0.0;

  int leave() const { return m - half_window; }   // last pure source frame
  int arrive() const { return n + half_window; }  // first pure target frame
};

// How the window L is chosen and candidates are ranked.
enum class WindowCriterion {
  // Mean weighted dissimilarity of the window (metres) plus `acceleration_weight` times the peak vertex
  // acceleration of the blend: trades distortion against how fast the blend must move the surface.
  blend_speed,
  // Eq. 5 literally: the weighted sum, which always prefers the shortest window.
  paper_sum,
};

struct TransitionOptions {
  int transitions_per_pair = 4;  // N best of each ordered pair of clips
  int max_half_window = 24;      // L < 25 (the paper's limit: overlap of up to 2 s at 25 fps)
  int min_half_window = 2;       // shortest blend worth the name, L >= 1
  int self_min_gap = 10;         // a clip links to itself only if |m - n| is at least this many frames
  int separation = 6;            // transitions of a pair lie at least this many frames apart in m or in n
  WindowCriterion criterion = WindowCriterion::blend_speed;
  double acceleration_weight =
      4.0;  // frames^2, see WindowCriterion::blend_speed; chosen in docs/transitions.md
  BlendProfile profile = BlendProfile::smooth;
  int sample_vertices = 400;  // vertices (farthest-point samples) on which accelerations are measured
  // A window whose peak acceleration is above this many times `captured_acceleration` is none: a longer one
  // is taken, or the transition left out, rather than a pop be seen (docs/transitions.md). Infinite: no
  // limit. A capture without acceleration sets none.
  double max_pop_ratio = 1.2;
};

// Throws `InvalidArgument` naming the option that is out of range.
void validate(const TransitionOptions& options);

// Makes an entry of the matrix exact: the exact entry of frames a < b. Called from several threads, for
// different pairs at the same time.
using ExactEntry = std::function<MatrixEntry(std::size_t a, std::size_t b)>;

// Transitions of all ordered pairs of clips, a clip with itself included, best first within a pair: of the
// local minima of the matrix over admissible (m, n) - both windows of at least `min_half_window` inside their
// clips; the slope towards m = n of a clip with itself is no minimum - those of least cost, `separation`
// apart. Does not change when a clip is moved rigidly on the ground. Parallel; deterministic. Throws
// `InvalidArgument` if the matrix is not of this database (clips or frame counts differ), an option is out of
// range, the clips have several rates, or bounds in the matrix leave the result undecided.
std::vector<Transition> find_transitions(const PerformanceDatabase& database,
                                         const DissimilarityMatrix& matrix,
                                         const TransitionOptions& options = {});

// Which pairs of clips are searched, asked with clip_a <= clip_b; both directions belong to a pair.
using ClipPairFilter = std::function<bool(std::size_t clip_a, std::size_t clip_b)>;

// The same list as from a matrix that is exact throughout, though only bounds may be known: entries on which
// the list depends are made exact and kept in `matrix`, the others stay as they are. Which entries those are
// depends on `matrix` and the answers alone, not on the number of threads, and none is asked for that is
// exact: the same search of the matrix it leaves asks for nothing. `share`: the pairs of clips to search,
// empty for all; only their entries are looked at, only their transitions returned. Also throws
// `InvalidArgument` if an answer is not exact or contradicts the bounds, and what `exact_entry` throws.
std::vector<Transition> find_transitions(const PerformanceDatabase& database, DissimilarityMatrix& matrix,
                                         const ExactEntry& exact_entry, const TransitionOptions& options = {},
                                         const ClipPairFilter& share = {});

}  // namespace reprise
