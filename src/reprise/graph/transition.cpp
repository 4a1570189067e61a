// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/graph/transition.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"
#include "reprise/graph/vertex_samples.h"
#include "reprise/similarity/vertex_metric.h"

namespace reprise {
namespace {

// Candidates of a pair whose windows are looked at vertex by vertex: the first by dissimilarity, at least
// this many.
constexpr int min_evaluated = 48;
constexpr int evaluated_per_kept = 12;

struct Candidate {
  int m = 0;
  int n = 0;
  float value = 0.0F;
};

// The block of the matrix that compares two clips.
class Block {
 public:
  Block(const DissimilarityMatrix& matrix, std::size_t source, std::size_t target)
      : rows_(static_cast<int>(matrix.clip_frame_counts()[source])),
        columns_(static_cast<int>(matrix.clip_frame_counts()[target])) {
    values_.reserve(matrix.clip_frame_counts()[source] * matrix.clip_frame_counts()[target]);
    for (std::size_t m = 0; m < matrix.clip_frame_counts()[source]; ++m) {
      for (std::size_t n = 0; n < matrix.clip_frame_counts()[target]; ++n) {
        values_.push_back(matrix.value(matrix.first_frame(source) + m, matrix.first_frame(target) + n));
      }
    }
  }

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  float operator()(int m, int n) const { return values_[index(m, n)]; }
  std::size_t index(int m, int n) const {
    return static_cast<std::size_t>(m) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(n);
  }
  std::size_t size() const { return values_.size(); }

 private:
  int rows_;
  int columns_;
  std::vector<float> values_;
};

// Where the centre of a transition may lie: the shortest window fits into both clips, and a clip does not
// meet itself at nearly the same time.
class Region {
 public:
  Region(const Block& block, bool is_self, const TransitionOptions& options)
      : first_(options.min_half_window),
        last_m_(block.rows() - 1 - options.min_half_window),
        last_n_(block.columns() - 1 - options.min_half_window),
        min_gap_(is_self ? options.self_min_gap : 0) {}

  int first() const { return first_; }
  int last_m() const { return last_m_; }
  int last_n() const { return last_n_; }
  bool fits(int m, int n) const { return m >= first_ && m <= last_m_ && n >= first_ && n <= last_n_; }
  bool is_trivial(int m, int n) const { return std::abs(m - n) < min_gap_; }
  bool contains(int m, int n) const { return fits(m, n) && !is_trivial(m, n); }

 private:
  int first_;
  int last_m_;
  int last_n_;
  int min_gap_;
};

// Local minima of a block among the eight neighbours, one for a plateau of equal values (its first in reading
// order). Neighbours whose window would not fit do not count: a clip's end may cut a valley. Those near the
// diagonal of a clip with itself do count: the slope down to "no transition at all" is not a valley.
std::vector<Candidate> local_minima(const Block& block, const Region& region) {
  std::vector<Candidate> minima;
  std::vector<bool> visited(block.size(), false);
  std::vector<std::pair<int, int>> plateau;
  for (int m = region.first(); m <= region.last_m(); ++m) {
    for (int n = region.first(); n <= region.last_n(); ++n) {
      if (region.is_trivial(m, n) || visited[block.index(m, n)]) continue;
      const float value = block(m, n);
      bool is_minimum = true;
      plateau.assign(1, {m, n});
      visited[block.index(m, n)] = true;
      for (std::size_t p = 0; p < plateau.size(); ++p) {
        const auto [pm, pn] = plateau[p];
        for (int qm = pm - 1; qm <= pm + 1; ++qm) {
          for (int qn = pn - 1; qn <= pn + 1; ++qn) {
            if (!region.fits(qm, qn)) continue;
            const float other = block(qm, qn);
            if (other < value) is_minimum = false;
            if (other != value || region.is_trivial(qm, qn) || visited[block.index(qm, qn)]) continue;
            visited[block.index(qm, qn)] = true;
            plateau.emplace_back(qm, qn);
          }
        }
      }
      if (!is_minimum) continue;
      const auto room = [&](const std::pair<int, int>& at) {
        return std::min({at.first, block.rows() - 1 - at.first, at.second, block.columns() - 1 - at.second});
      };
      // The first of the largest: reading order decides, not the order of the walk over the plateau.
      std::ranges::sort(plateau);
      const auto [best_m, best_n] = *std::ranges::max_element(plateau, {}, room);
      minima.push_back({best_m, best_n, value});
    }
  }
  return minima;
}

// Greedily keeps the first items that lie `separation` frames apart in m or in n from all kept before, at
// most `count`.
template <typename Item>
std::vector<Item> keep_separated(const std::vector<Item>& ranked, int separation, std::size_t count) {
  std::vector<Item> kept;
  for (const Item& item : ranked) {
    if (kept.size() == count) break;
    const bool is_near = std::ranges::any_of(kept, [&](const Item& other) {
      return std::abs(item.m - other.m) < separation && std::abs(item.n - other.n) < separation;
    });
    if (!is_near) kept.push_back(item);
  }
  return kept;
}

// Sampled vertices of all frames of a clip: a frame's x of all samples, then y, then z.
using FrameSamples = Eigen::Array<float, Eigen::Dynamic, 3>;
using ClipSamples = std::vector<FrameSamples>;

// The frames around a candidate on common ground, ready to be blended with any window.
class BlendWindow {
 public:
  BlendWindow(const ClipSamples& source, const ClipSamples& target, const Transition& transition,
              int max_half_window)
      : reach_(max_half_window + 1),
        frames_before_(transition.m),
        frames_after_(static_cast<int>(target.size()) - 1 - transition.n) {
    // About the middle of the source frame, where float32 keeps the most digits.
    const Eigen::Array3d origin =
        source[static_cast<std::size_t>(transition.m)].cast<double>().colwise().mean();
    const Eigen::Matrix3d R = transition.source_from_target.rotation();
    const Eigen::Vector3d t = transition.source_from_target.translation3() - origin.matrix();
    for (int k = -reach_; k <= reach_; ++k) {
      // Frames beyond a clip's end get weight zero: any frame may stand in for them.
      const FrameSamples& a = frame(source, transition.m + k);
      source_.push_back((a.cast<double>().rowwise() - origin.transpose()).cast<float>());
      const FrameSamples& b = frame(target, transition.n + k);
      const Eigen::MatrixX3d moved = (b.matrix().cast<double>() * R.transpose()).rowwise() + t.transpose();
      target_.push_back(moved.array().cast<float>());
    }
  }

  // Largest acceleration of a sample from the first to the last frame of the window, the pure frames outside
  // included so that a corner at either end counts. Infinite, without looking further, once it is above
  // `limit`.
  double peak_acceleration(BlendProfile profile, int half_window, double limit) const {
    const auto square_limit = static_cast<float>(limit * limit);
    float peak = 0.0F;
    for (int k = -half_window; k <= half_window && peak <= square_limit; ++k) {
      if ((k == -half_window && k + frames_before_ < 1) || (k == half_window && frames_after_ - k < 1))
        continue;
      const auto weight = [&](int j) {
        return static_cast<float>(j < -half_window  ? 0.0
                                  : j > half_window ? 1.0
                                                    : blend_weight(profile, j, half_window));
      };
      peak = std::max(peak, square_acceleration(k, weight(k - 1), weight(k), weight(k + 1)));
    }
    if (peak > square_limit) return std::numeric_limits<double>::infinity();
    return std::sqrt(static_cast<double>(peak));
  }

 private:
  static const FrameSamples& frame(const ClipSamples& clip, int frame_idx) {
    return clip[static_cast<std::size_t>(std::clamp(frame_idx, 0, static_cast<int>(clip.size()) - 1))];
  }

  // Second difference of x = (1 - alpha) a + alpha b at k, squared, its largest over the samples.
  float square_acceleration(int k, float alpha_before, float alpha, float alpha_after) const {
    const auto at = static_cast<std::size_t>(k + reach_);
    const auto component = [&](int c) {
      return (1.0F - alpha_before) * source_[at - 1].col(c) + alpha_before * target_[at - 1].col(c) -
             2.0F * ((1.0F - alpha) * source_[at].col(c) + alpha * target_[at].col(c)) +
             (1.0F - alpha_after) * source_[at + 1].col(c) + alpha_after * target_[at + 1].col(c);
    };
    return (component(0).square() + component(1).square() + component(2).square()).maxCoeff();
  }

  int reach_;
  int frames_before_;  // frames of the source before m
  int frames_after_;   // frames of the target after n
  ClipSamples source_;
  ClipSamples target_;
};

// Everything that stays the same over all pairs.
struct Search {
  const PerformanceDatabase& database;
  const DissimilarityMatrix& matrix;
  const TransitionOptions& options;
  std::vector<ClipSamples> samples;
};

// Chooses the window of a candidate.
Transition evaluate(const Search& search, const Block& block, std::size_t source, std::size_t target,
                    const Candidate& candidate) {
  const TransitionOptions& options = search.options;
  Transition best{.source_clip = source, .target_clip = target, .m = candidate.m, .n = candidate.n};
  best.source_from_target =
      align_on_ground(search.database.clip(source).frame(static_cast<std::size_t>(candidate.m)),
                      search.database.clip(target).frame(static_cast<std::size_t>(candidate.n)))
          .a_from_b;
  best.cost = std::numeric_limits<double>::infinity();
  const int max_half_window = std::min({options.max_half_window, candidate.m, block.rows() - 1 - candidate.m,
                                        candidate.n, block.columns() - 1 - candidate.n});
  const BlendWindow window(search.samples[source], search.samples[target], best, max_half_window);
  const bool is_paper = options.criterion == WindowCriterion::paper_sum;
  for (int L = options.min_half_window; L <= max_half_window; ++L) {
    double distortion = 0.0;  // Eq. 3
    double weight_sum = 0.0;
    for (int k = -L; k <= L; ++k) {
      const double alpha = blend_weight(options.profile, k, L);
      const double weight = std::min(1.0 - alpha, alpha);
      distortion += weight * static_cast<double>(block(candidate.m + k, candidate.n + k));
      weight_sum += weight;
    }
    const double mean = distortion / weight_sum;
    // The acceleration above which this window cannot win.
    const double limit = is_paper || options.acceleration_weight == 0.0
                             ? std::numeric_limits<double>::infinity()
                             : (best.cost - mean) / options.acceleration_weight;
    if ((is_paper ? distortion : mean) >= best.cost) continue;
    const double peak = window.peak_acceleration(options.profile, L, limit);
    const double cost = is_paper ? distortion : mean + options.acceleration_weight * peak;
    if (cost >= best.cost) continue;
    best.half_window = L;
    best.distortion = distortion;
    best.peak_acceleration = peak;
    best.cost = cost;
  }
  return best;
}

std::vector<Transition> pair_transitions(const Search& search, std::size_t source, std::size_t target) {
  const TransitionOptions& options = search.options;
  const Block block(search.matrix, source, target);
  std::vector<Candidate> candidates = local_minima(block, Region(block, source == target, options));
  std::ranges::sort(candidates, {}, [](const Candidate& c) { return std::tuple(c.value, c.m, c.n); });
  // Half the separation at first: of two neighbours the window, not the single frame, shall choose.
  candidates = keep_separated(
      candidates, (options.separation + 1) / 2,
      static_cast<std::size_t>(std::max(min_evaluated, evaluated_per_kept * options.transitions_per_pair)));
  std::vector<Transition> transitions;
  for (const Candidate& candidate : candidates) {
    transitions.push_back(evaluate(search, block, source, target, candidate));
  }
  std::ranges::sort(transitions, {}, [](const Transition& t) { return std::tuple(t.cost, t.m, t.n); });
  return keep_separated(transitions, options.separation,
                        static_cast<std::size_t>(options.transitions_per_pair));
}

std::vector<ClipSamples> sample_clips(const PerformanceDatabase& database, int count) {
  const std::vector<std::int32_t> vertices = sample_vertices(*database.topology(), count);
  std::vector<ClipSamples> samples;
  for (const MeshSequence& clip : database.clips()) {
    ClipSamples& frames = samples.emplace_back();
    for (std::size_t f = 0; f < clip.frame_count(); ++f) {
      frames.push_back(clip.frame(f)(vertices, Eigen::all).array());
    }
  }
  return samples;
}

void check_matrix_fits(const PerformanceDatabase& database, const DissimilarityMatrix& matrix) {
  if (matrix.clip_names() != database.clip_names()) {
    throw InvalidArgument(fmt::format("the dissimilarity matrix is of the clips {}, the database has {}",
                                      fmt::join(matrix.clip_names(), ", "),
                                      fmt::join(database.clip_names(), ", ")));
  }
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    if (matrix.clip_frame_counts()[c] != database.clip(c).frame_count()) {
      throw InvalidArgument(fmt::format(
          "clip '{}' has {} frames in the dissimilarity matrix and {} in the database",
          database.clip(c).name(), matrix.clip_frame_counts()[c], database.clip(c).frame_count()));
    }
  }
}

}  // namespace

double blend_weight(BlendProfile profile, int k, int half_window) {
  if (half_window < 1) {
    throw InvalidArgument(fmt::format("a blend of half window {}: expected at least 1", half_window));
  }
  const double t = std::clamp((k + half_window) / (2.0 * half_window), 0.0, 1.0);
  return profile == BlendProfile::linear ? t : t * t * (3.0 - 2.0 * t);
}

void validate(const TransitionOptions& options) {
  const auto check = [](const char* name, int value, int least) {
    if (value < least) {
      throw InvalidArgument(fmt::format("{} is {}, expected at least {}", name, value, least));
    }
  };
  check("transitions_per_pair", options.transitions_per_pair, 1);
  check("min_half_window", options.min_half_window, 1);
  check("self_min_gap", options.self_min_gap, 1);
  check("separation", options.separation, 1);
  check("sample_vertices", options.sample_vertices, 1);
  if (options.max_half_window < options.min_half_window) {
    throw InvalidArgument(fmt::format("max_half_window is {}, expected at least min_half_window, which is {}",
                                      options.max_half_window, options.min_half_window));
  }
  if (!(options.acceleration_weight >= 0.0) || std::isinf(options.acceleration_weight)) {
    throw InvalidArgument(
        fmt::format("acceleration_weight is {}, expected a number from 0", options.acceleration_weight));
  }
}

std::vector<Transition> find_transitions(const PerformanceDatabase& database,
                                         const DissimilarityMatrix& matrix,
                                         const TransitionOptions& options) {
  validate(options);
  check_matrix_fits(database, matrix);
  if (database.empty()) return {};
  (void)database.frames_per_second();  // frames of one duration, or accelerations cannot be compared
  const Search search{database, matrix, options, sample_clips(database, options.sample_vertices)};

  const std::size_t clip_count = database.clips().size();
  std::vector<std::vector<Transition>> of_pair(clip_count * clip_count);
  Progress progress("finding transitions", of_pair.size());
  parallel_for(0, of_pair.size(), [&](std::size_t p) {
    of_pair[p] = pair_transitions(search, p / clip_count, p % clip_count);
    progress.advance();
  });
  std::vector<Transition> transitions;
  for (const std::vector<Transition>& found : of_pair) {
    transitions.insert(transitions.end(), found.begin(), found.end());
  }
  return transitions;
}

}  // namespace reprise
