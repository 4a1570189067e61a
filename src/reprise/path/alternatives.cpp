// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/alternatives.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"

namespace reprise {
namespace {

// Numbers that differ by less are the same: they are sums in different orders.
constexpr double tolerance = 1e-9;

void validate(const AlternativesOptions& options) {
  if (options.count < 1) throw InvalidArgument("alternatives: expected a count of at least 1, found 0");
  if (options.radius < 0) {
    throw InvalidArgument(
        fmt::format("alternatives: expected a radius of at least 0 frames, found {}", options.radius));
  }
  if (!(options.share > 0.0 && options.share <= 1.0)) {
    throw InvalidArgument(
        fmt::format("alternatives: expected a share of joins in (0, 1], found {}", options.share));
  }
  if (options.max_searches < 1) {
    throw InvalidArgument("alternatives: expected at least 1 search, found 0");
  }
}

bool is_near(const Transition& a, const Transition& b, int radius) {
  return a.source_clip == b.source_clip && a.target_clip == b.target_clip && std::abs(a.m - b.m) <= radius &&
         std::abs(a.n - b.n) <= radius;
}

bool takes(const MotionPath& path, const Transition& join, int radius) {
  return std::ranges::any_of(path.segments, [&](const PathSegment& segment) {
    return segment.transition && is_near(*segment.transition, join, radius);
  });
}

struct Join {
  Transition transition;
  double weight =
      0.0;  // share of the path's time: half of what is played to its left and right, and its blend
};

// The joins of a path; their weights add up to 1.
std::vector<Join> joins_of(const MotionPath& path, int radius) {
  std::vector<Join> joins;
  std::vector<std::size_t> join_from_transition;
  double frames = 0.0;
  for (std::size_t i = 0; i < path.segments.size(); ++i) {
    const PathSegment& segment = path.segments[i];
    const double played = segment.last_frame - segment.first_frame + 1;
    frames += played;
    // The first and the last stretch have a join on one side only.
    const double share = i == 0 || i + 1 == path.segments.size() ? 1.0 : 0.5;
    if (i > 0) joins[join_from_transition.back()].weight += share * played;
    if (!segment.transition) continue;
    const auto found = std::ranges::find_if(
        joins, [&](const Join& join) { return is_near(*segment.transition, join.transition, radius); });
    join_from_transition.push_back(static_cast<std::size_t>(found - joins.begin()));
    if (found == joins.end()) joins.push_back({*segment.transition});
    const double blended = 2 * segment.transition->half_window - 1;
    frames += blended;
    joins[join_from_transition.back()].weight += share * played + blended;
  }
  for (Join& join : joins) join.weight /= frames;
  return joins;
}

// Those of an earlier path's joins that `path` takes as well, the weightiest first.
std::vector<Join> shared_joins(const MotionPath& path, const MotionPath& earlier, int radius) {
  std::vector<Join> joins = joins_of(earlier, radius);
  std::erase_if(joins, [&](const Join& join) { return !takes(path, join.transition, radius); });
  std::ranges::stable_sort(joins, std::ranges::greater{}, &Join::weight);
  return joins;
}

// Whether a path that takes joins of this weight shares too much with the path they are of.
bool weighs_too_much(double weight, const AlternativesOptions& options) {
  return weight > 1.0 - options.share + tolerance;
}

std::vector<std::pair<std::size_t, int>> frames_shown(const MotionPath& path) {
  std::vector<std::pair<std::size_t, int>> frames;
  for (const PathSegment& segment : path.segments) {
    for (int f = segment.first_frame; f <= segment.last_frame; ++f) frames.emplace_back(segment.clip_idx, f);
    if (!segment.transition) continue;
    const Transition& transition = *segment.transition;
    for (int k = -transition.half_window + 1; k < transition.half_window; ++k) {
      k <= 0 ? frames.emplace_back(transition.source_clip, transition.m + k)
             : frames.emplace_back(transition.target_clip, transition.n + k);
    }
  }
  return frames;
}

// Lawler's partition (1972) of what is left of all paths. A set is all paths that keep clear of some joins
// and of some spans of time; `find_keyframe_path` finds its best one. The sets not yet divided ("open")
// together hold every path that differs from all answers so far:
//
// - At first one set holds all paths.
// - A set is divided when its best path P does not differ from some answer A. Of A's joins that P takes too,
//   the first few, by weight, weigh too much together. A path of the set that differs from A does without one
//   of these few at least, so it is in one of the parts "the set, and clear of this join". (A has no joins:
//   the path lasts longer or less long than A.)
//
// So the least lower bound over all open sets is a lower bound on every path that differs from all answers,
// and when the best path of the set with that bound does differ, it is the optimum among them: the next
// answer. Its set stays open, and is divided later because its best path does not differ from itself. Every
// part allows fewer transitions or less time than its set, so this ends.
class Partition {
 public:
  Partition(const PathMetrics& metrics, const KeyframeQuery& query, const KeyframeOptions& options,
            const AlternativesOptions& alternatives, const std::vector<std::string>& clip_names)
      : metrics_(metrics),
        query_(query),
        options_(options),
        alternatives_(alternatives),
        clip_names_(clip_names) {}

  tl::expected<std::vector<MotionPath>, NoPath> find() {
    PathSet all{.forbidden = std::vector<bool>(metrics_.transitions().size(), false),
                .min_time = query_.min_time,
                .max_time = query_.max_time};
    if (const std::optional<NoPath> none = search(all)) return tl::make_unexpected(*none);
    add(std::move(all));
    while (answers_.size() < alternatives_.count && !open_.empty()) {
      throw_if_interrupted();
      // The first of least bound: sets are numbered as they were made.
      const auto least = std::ranges::min_element(open_, {}, &PathSet::lower_bound);
      if (!least->best && searches_ == alternatives_.max_searches) {
        if (!answer(least->lower_bound)) break;
      } else if (!least->best) {
        if (search(*least)) open_.erase(least);
      } else if (differs_from_all(*least->best)) {
        // Only if a search ended early can another set's path be cheaper than this one.
        answer(least->lower_bound);
      } else {
        divide(static_cast<std::size_t>(least - open_.begin()));
      }
    }
    return std::move(answers_);
  }

 private:
  struct PathSet {
    std::vector<bool> forbidden;  // one a transition
    double min_time = 0.0;
    double max_time = unlimited;
    double lower_bound = 0.0;                       // of its paths, once it is open
    std::optional<MotionPath> best = std::nullopt;  // once searched
  };

  bool holds(const PathSet& set, const MotionPath& path) const {
    if (path.time < set.min_time || path.time > set.max_time) return false;
    const std::vector<Transition>& transitions = metrics_.transitions();
    for (const PathSegment& segment : path.segments) {
      if (!segment.transition) continue;
      for (std::size_t i = 0; i < transitions.size(); ++i) {
        if (set.forbidden[i] && is_near(transitions[i], *segment.transition, 0)) return false;
      }
    }
    return true;
  }

  bool differs_from_all(const MotionPath& path) const {
    return std::ranges::all_of(
        answers_, [&](const MotionPath& answer) { return differs(path, answer, alternatives_); });
  }

  // Finds the best path of a set; says why if it has none.
  std::optional<NoPath> search(PathSet& set) {
    ++searches_;
    KeyframeQuery query = query_;
    query.min_time = set.min_time;
    query.max_time = set.max_time;
    auto found = find_keyframe_path(metrics_.without(set.forbidden), query, options_, clip_names_);
    if (!found) return found.error();
    set.lower_bound = std::max(set.lower_bound, found->lower_bound);
    set.best = std::move(*found);
    searched_.push_back(set);
    return std::nullopt;
  }

  // A search already made answers for a set as well if it looked at all of the set's paths and what it found
  // is one of them.
  void reuse_search(PathSet& set) const {
    for (const PathSet& wider : searched_) {
      if (wider.min_time > set.min_time || wider.max_time < set.max_time) continue;
      bool covers = true;
      for (std::size_t i = 0; covers && i < set.forbidden.size(); ++i) {
        covers = set.forbidden[i] || !wider.forbidden[i];
      }
      if (!covers || !holds(set, *wider.best)) continue;
      set.best = wider.best;
      set.lower_bound = std::max(set.lower_bound, wider.best->lower_bound);
      return;
    }
  }

  void forbid(PathSet& set, const Transition& join) const {
    for (std::size_t i = 0; i < set.forbidden.size(); ++i) {
      if (is_near(metrics_.transitions()[i], join, alternatives_.radius)) set.forbidden[i] = true;
    }
  }

  // Opens a set, unless it was open before.
  void add(PathSet set) {
    if (set.min_time > set.max_time) return;
    // What takes a join that weighs too much alone differs from no answer that takes it.
    for (const MotionPath& answer : answers_) {
      for (const Join& join : joins_of(answer, alternatives_.radius)) {
        if (weighs_too_much(join.weight, alternatives_)) forbid(set, join.transition);
      }
    }
    if (!seen_.insert({set.forbidden, {set.min_time, set.max_time}}).second) return;
    reuse_search(set);
    open_.push_back(std::move(set));
  }

  // The cheapest path known that differs from all answers becomes one. False if there is none.
  bool answer(double lower_bound) {
    const PathSet* cheapest = nullptr;
    for (const PathSet& set : open_) {
      if (set.best && (cheapest == nullptr || set.best->cost < cheapest->best->cost) &&
          differs_from_all(*set.best)) {
        cheapest = &set;
      }
    }
    if (cheapest == nullptr) return false;
    MotionPath path = *cheapest->best;
    path.lower_bound = lower_bound >= path.cost - tolerance ? path.cost : lower_bound;
    answers_.push_back(std::move(path));
    return true;
  }

  void divide(std::size_t set_idx) {
    const PathSet set = std::move(open_[set_idx]);
    open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(set_idx));
    // Of the answers the path does not differ from, the one that makes the fewest parts.
    const MotionPath* nearest = nullptr;
    std::vector<Join> joins;
    std::size_t parts = 0;
    for (const MotionPath& answer : answers_) {
      if (differs(*set.best, answer, alternatives_)) continue;
      std::vector<Join> shared = shared_joins(*set.best, answer, alternatives_.radius);
      const std::size_t count = part_count(shared);
      if (nearest != nullptr && count >= parts) continue;
      nearest = &answer;
      parts = count;
      joins = std::move(shared);
    }
    for (std::size_t part_idx = 0; part_idx < parts; ++part_idx) {
      PathSet part{.forbidden = set.forbidden,
                   .min_time = set.min_time,
                   .max_time = set.max_time,
                   .lower_bound = set.lower_bound};
      forbid(part, joins[part_idx].transition);
      add(std::move(part));
    }
    if (nearest->segments.size() > 1) return;
    const double half_frame = 0.5 / metrics_.frames_per_second();
    add({.forbidden = set.forbidden,
         .min_time = set.min_time,
         .max_time = std::min(set.max_time, nearest->time - half_frame),
         .lower_bound = set.lower_bound});
    add({.forbidden = set.forbidden,
         .min_time = std::max(set.min_time, nearest->time + half_frame),
         .max_time = set.max_time,
         .lower_bound = set.lower_bound});
  }

  // How many of the joins shared with an answer, the weightiest first, make a part: what shares all of them
  // shares too much, whatever it does with the rest.
  std::size_t part_count(const std::vector<Join>& shared) const {
    std::size_t count = 0;
    double weight = 0.0;
    while (count < shared.size() && !weighs_too_much(weight, alternatives_)) weight += shared[count++].weight;
    return count;
  }

  const PathMetrics& metrics_;
  const KeyframeQuery& query_;
  const KeyframeOptions& options_;
  const AlternativesOptions& alternatives_;
  const std::vector<std::string>& clip_names_;
  std::vector<PathSet> open_;
  std::vector<PathSet> searched_;
  std::set<std::pair<std::vector<bool>, std::pair<double, double>>> seen_;
  std::vector<MotionPath> answers_;
  std::size_t searches_ = 0;
};

}  // namespace

bool differs(const MotionPath& path, const MotionPath& earlier, const AlternativesOptions& options) {
  if (earlier.segments.size() < 2) return path.frame_count != earlier.frame_count;
  double weight = 0.0;
  for (const Join& join : shared_joins(path, earlier, options.radius)) weight += join.weight;
  return !weighs_too_much(weight, options);
}

double difference(const MotionPath& a, const MotionPath& b) {
  std::map<std::pair<std::size_t, int>, int> excess;
  for (const auto& frame : frames_shown(a)) ++excess[frame];
  for (const auto& frame : frames_shown(b)) --excess[frame];
  int only_a = 0;
  int only_b = 0;
  for (const auto& [frame, count] : excess) (count > 0 ? only_a : only_b) += std::abs(count);
  const int longer = std::max(a.frame_count, b.frame_count);
  return longer == 0 ? 0.0 : static_cast<double>(std::max(only_a, only_b)) / longer;
}

tl::expected<std::vector<MotionPath>, NoPath> find_alternative_paths(
    const PathMetrics& metrics, const KeyframeQuery& query, const KeyframeOptions& options,
    const AlternativesOptions& alternatives, const std::vector<std::string>& clip_names) {
  validate(alternatives);
  auto paths = Partition(metrics, query, options, alternatives, clip_names).find();
  // In order already, unless a search ended before its proof.
  if (paths) std::ranges::stable_sort(*paths, {}, &MotionPath::cost);
  return paths;
}

}  // namespace reprise
