// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/graph/transition_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "reprise/graph/captured_acceleration.h"
#include "reprise/graph/vertex_samples.h"

namespace reprise {
namespace {

constexpr Eigen::Index coarse_samples = 32;
// Entries worth having in work at a time over all pairs of clips. Not the number of threads: which entries
// become exact must not depend on it.
constexpr std::size_t entries_in_work = 128;
constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

TransitionSearch::TransitionSearch(const PerformanceDatabase& searched_database,
                                   const RefinableMatrix& searched_matrix,
                                   const TransitionOptions& search_options)
    : database(searched_database),
      matrix(searched_matrix),
      options(search_options),
      alignment(searched_database),
      peak_counts(options.criterion == WindowCriterion::blend_speed && options.acceleration_weight > 0.0) {
  // Relative to what the capture itself reaches: the same for a slow performer and a quick one. One that does
  // not move at all says nothing.
  const double captured = std::isinf(options.max_pop_ratio) ? 0.0 : captured_acceleration(database);
  const double max_peak = captured > 0.0 ? options.max_pop_ratio * captured : infinity;
  max_square_peak = static_cast<float>(max_peak * max_peak);
  peak_matters = peak_counts || std::isfinite(max_square_peak);
  std::size_t longest = 0;
  for (const MeshSequence& clip : database.clips()) longest = std::max(longest, clip.frame_count());
  const int max_half_window = std::min(options.max_half_window, static_cast<int>(longest) / 2);
  for (int L = options.min_half_window; L <= max_half_window; ++L) {
    weights.push_back(window_weights(options.profile, L));
  }
  const std::vector<std::int32_t> vertices = sample_vertices(*database.topology(), options.sample_vertices);
  // The first farthest-point samples lie at the tips, which move most.
  coarse_count = std::min(coarse_samples, static_cast<Eigen::Index>(vertices.size()));
  for (const MeshSequence& clip : database.clips()) clips.emplace_back(clip, vertices);
  const std::size_t clip_count = clips.size();
  batch_size = std::clamp<std::size_t>(entries_in_work / (clip_count * (clip_count + 1) / 2), 1, 16);
}

PairSearch::PairSearch(const TransitionSearch& search, std::size_t source_clip, std::size_t target_clip)
    : search_(search),
      options_(search.options),
      source_clip_(source_clip),
      target_clip_(target_clip),
      block_(search.matrix, source_clip, target_clip),
      region_(block_, source_clip == target_clip, options_),
      minima_(block_, region_, search.batch_size),
      blend_(search.clips[source_clip], search.clips[target_clip],
             std::min({options_.max_half_window, block_.rows() / 2, block_.columns() / 2})) {}

std::vector<Transition> PairSearch::run() {
  fill_queue();
  while (!queue_.empty() && found_.size() < static_cast<std::size_t>(options_.transitions_per_pair)) {
    Candidate candidate = queue_.top();
    queue_.pop();
    const Pixel p = candidate.pixel;
    if (is_near_found(p) || minima_.is_excluded(p)) {
      windows_.erase(key(p));
      continue;
    }
    if (candidate.stage == Stage::distortion && search_.peak_matters) {
      candidate.stage = Stage::coarse_peak;
      Windows windows;
      candidate.cost = look_coarsely(p, windows);
      // Kept only if it is needed at once: of most pixels it never will be.
      if (is_first(candidate)) windows_.emplace(key(p), std::move(windows));
      if (std::isfinite(candidate.cost)) queue_.push(candidate);
      continue;
    }
    const auto [entry, is_new] = windows_.try_emplace(key(p));
    Windows& windows = entry->second;
    if (is_new) look_coarsely(p, windows);
    candidate.stage = Stage::windows;
    // Dissimilarities may be known better by now.
    const Choice choice = choose(p, windows);
    if (std::isinf(choice.cost)) {  // every window pops
      windows_.erase(entry);
      continue;
    }
    candidate.cost = choice.cost;
    if (!is_first(candidate)) {
      queue_.push(candidate);
      continue;
    }
    const bool was_known = minima_.is_known(p);
    if (!was_known) make_exact_with_followers(p);
    if (!minima_.contains(p)) {
      windows_.erase(entry);
      continue;
    }
    if (!was_known || refine_window(p, choice.half_window)) {
      queue_.push(candidate);
      continue;
    }
    found_.push_back(transition(p, choice, windows));
  }
  return std::move(found_);
}

std::optional<Transition> PairSearch::measure(Pixel p) {
  Windows windows;
  look_coarsely(p, windows);
  Choice choice = choose(p, windows);
  if (std::isinf(choice.cost)) return std::nullopt;
  while (refine_window(p, choice.half_window)) choice = choose(p, windows);
  return transition(p, choice, windows);
}

void PairSearch::fill_queue() {
  std::vector<Candidate> candidates;
  for (int m = region_.first(); m <= region_.last_m(); ++m) {
    for (int n = region_.first(); n <= region_.last_n(); ++n) {
      const Pixel p{m, n};
      if (region_.is_trivial(p) || minima_.is_excluded(p)) continue;
      candidates.push_back({.cost = least_distortion_cost(p), .pixel = p});
    }
  }
  queue_ = decltype(queue_)(std::greater<>(), std::move(candidates));
}

bool PairSearch::is_first(const Candidate& candidate) const {
  return queue_.empty() || queue_.top() > candidate;
}

bool PairSearch::is_near_found(Pixel p) const {
  return std::ranges::any_of(found_, [&](const Transition& other) {
    return std::abs(p.m - other.m) < options_.separation && std::abs(p.n - other.n) < options_.separation;
  });
}

std::size_t PairSearch::key(Pixel p) const {
  return static_cast<std::size_t>(p.m) * static_cast<std::size_t>(block_.columns()) +
         static_cast<std::size_t>(p.n);
}

int PairSearch::max_half_window(Pixel p) const {
  return std::min({options_.max_half_window, p.m, block_.rows() - 1 - p.m, p.n, block_.columns() - 1 - p.n});
}

// Sums of bounds are bounds of the sums to the last bit: the same additions in the same order, and rounding
// keeps order.
const std::vector<double>& PairSearch::distortions(Pixel p) {
  const int reach = max_half_window(p) - 1;
  diagonal_.clear();
  for (int k = -reach; k <= reach; ++k) {
    diagonal_.push_back(static_cast<double>(block_.lower(p.m + k, p.n + k)));
  }
  distortions_.clear();
  for (int L = options_.min_half_window; L <= reach + 1; ++L) {
    const double* entry = diagonal_.data() + (reach + 1 - L);
    double sum = 0.0;
    for (const double weight : search_.weights_of(L).distortion) sum += weight * *entry++;
    distortions_.push_back(sum);
  }
  return distortions_;
}

double PairSearch::cost(int L, double distortion, float square_peak) const {
  if (square_peak > search_.max_square_peak) return infinity;
  if (options_.criterion == WindowCriterion::paper_sum) return distortion;
  return distortion / search_.weights_of(L).distortion_sum +
         options_.acceleration_weight * std::sqrt(static_cast<double>(square_peak));
}

double PairSearch::least_distortion_cost(Pixel p) {
  double least = infinity;
  int L = options_.min_half_window;
  for (const double distortion : distortions(p)) least = std::min(least, cost(L++, distortion, 0.0F));
  return least;
}

float PairSearch::useful_square_peak(double least, int L, double distortion) const {
  if (!search_.peak_counts) return search_.max_square_peak;
  const double rest = (least - cost(L, distortion, 0.0F)) / options_.acceleration_weight;
  return std::min(static_cast<float>(rest * rest), search_.max_square_peak);
}

double PairSearch::look_coarsely(Pixel p, Windows& windows) {
  windows.source_from_target = search_.alignment.source_from_target(source_clip_, p.m, target_clip_, p.n);
  double least = infinity;
  const std::vector<double>& sums = distortions(p);
  windows.square_peaks.assign(sums.size(), 0.0F);
  windows.states.assign(sums.size(), Peak::coarse);
  if (!search_.peak_matters) return least_distortion_cost(p);
  blend_.place(p.m, p.n, windows.source_from_target, search_.coarse_count);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const int L = options_.min_half_window + static_cast<int>(i);
    if (cost(L, sums[i], 0.0F) > least) continue;
    windows.square_peaks[i] =
        blend_.square_peak(search_.weights_of(L), useful_square_peak(least, L, sums[i]));
    least = std::min(least, cost(L, sums[i], windows.square_peaks[i]));
  }
  return least;
}

PairSearch::Choice PairSearch::choose(Pixel p, Windows& windows) {
  const std::vector<double>& sums = distortions(p);
  bool is_placed = false;
  while (true) {
    std::size_t best = 0;
    double least = infinity;
    double least_exact = infinity;
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const double bound =
          cost(options_.min_half_window + static_cast<int>(i), sums[i], windows.square_peaks[i]);
      if (windows.states[i] == Peak::exact) least_exact = std::min(least_exact, bound);
      if (bound >= least) continue;
      least = bound;
      best = i;
    }
    const int L = options_.min_half_window + static_cast<int>(best);
    if (std::isinf(least) || !search_.peak_matters || windows.states[best] == Peak::exact) {
      return {.half_window = L, .cost = least};
    }
    if (!is_placed)
      blend_.place(p.m, p.n, windows.source_from_target, search_.clips[source_clip_].sample_count());
    is_placed = true;
    // Cut short once it is no longer the best; not twice, as rounding might let it seem the best again.
    const float limit = windows.states[best] == Peak::coarse ? useful_square_peak(least_exact, L, sums[best])
                                                             : std::numeric_limits<float>::infinity();
    const float found = blend_.square_peak(search_.weights_of(L), limit);
    windows.square_peaks[best] = std::max(windows.square_peaks[best], found);
    windows.states[best] = found > limit ? Peak::cut : Peak::exact;
  }
}

void PairSearch::make_peak_exact(Pixel p, int L, Windows& windows) {
  const auto i = static_cast<std::size_t>(L - options_.min_half_window);
  if (windows.states[i] == Peak::exact) return;
  blend_.place(p.m, p.n, windows.source_from_target, search_.clips[source_clip_].sample_count());
  windows.square_peaks[i] = blend_.square_peak(search_.weights_of(L));
  windows.states[i] = Peak::exact;
}

void PairSearch::make_exact_with_followers(Pixel p) {
  if (block_.is_exact(p)) return;
  std::vector<Pixel> pixels = {p};
  std::vector<Candidate> followers;
  while (pixels.size() < search_.batch_size && !queue_.empty() && queue_.top().stage == Stage::windows) {
    followers.push_back(queue_.top());
    queue_.pop();
    const Pixel q = followers.back().pixel;
    if (!is_near_found(q) && !minima_.is_excluded(q)) pixels.push_back(q);
  }
  for (const Candidate& follower : followers) queue_.push(follower);
  block_.make_exact(pixels);
}

bool PairSearch::refine_window(Pixel p, int L) {
  struct Doubt {
    double size = 0.0;
    Pixel pixel;
  };
  std::vector<Doubt> doubts;
  for (int k = -L + 1; k <= L - 1; ++k) {
    const Pixel q{p.m + k, p.n + k};
    if (block_.is_exact(q)) continue;
    const double weight = search_.weights_of(L).distortion[static_cast<std::size_t>(k + L - 1)];
    const auto gap = static_cast<double>(block_.value(q.m, q.n) - block_.lower(q.m, q.n));
    doubts.push_back({.size = weight * gap, .pixel = q});
  }
  if (doubts.empty()) return false;
  // First those that can raise the cost most: the others may not be needed any more.
  std::ranges::sort(doubts, [](const Doubt& a, const Doubt& b) {
    return std::tuple(-a.size, a.pixel) < std::tuple(-b.size, b.pixel);
  });
  std::vector<Pixel> pixels;
  for (const Doubt& doubt : doubts) {
    if (pixels.size() < search_.batch_size) pixels.push_back(doubt.pixel);
  }
  block_.make_exact(pixels);
  return true;
}

Transition PairSearch::transition(Pixel p, const Choice& choice, Windows& windows) {
  const auto i = static_cast<std::size_t>(choice.half_window - options_.min_half_window);
  make_peak_exact(p, choice.half_window, windows);
  return {.source_clip = source_clip_,
          .target_clip = target_clip_,
          .m = p.m,
          .n = p.n,
          .half_window = choice.half_window,
          .source_from_target = windows.source_from_target,
          .distortion = distortions(p)[i],
          .peak_acceleration = std::sqrt(static_cast<double>(windows.square_peaks[i])),
          .cost = choice.cost};
}

}  // namespace reprise
