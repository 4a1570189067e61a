// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/skeleton_retrieval.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/path/retrieval_walk.h"
#include "reprise/path/skeleton_comparison.h"
#include "reprise/path/trellis.h"
#include "reprise/path/trellis_rows.h"
#include "reprise/path/trellis_sweep.h"

namespace reprise {
namespace {

using namespace path_detail;

constexpr float never = std::numeric_limits<float>::infinity();

void check_joints(const Eigen::MatrixX3d& joints, Eigen::Index joint_count, const std::string& whose,
                  std::size_t frame) {
  if (joints.rows() != joint_count) {
    throw InvalidArgument(
        fmt::format("{}, frame {}: {} joints, expected {}", whose, frame, joints.rows(), joint_count));
  }
  if (!joints.allFinite()) {
    throw InvalidArgument(fmt::format("{}, frame {}: a joint has no finite position", whose, frame));
  }
}

std::vector<int> frame_counts(const std::vector<JointTrack>& tracks) {
  std::vector<int> counts;
  counts.reserve(tracks.size());
  for (const JointTrack& track : tracks) counts.push_back(static_cast<int>(track.size()));
  return counts;
}

void validate(const RetrievalOptions& options, std::size_t joint_count, std::size_t clip_count) {
  const auto check_cost = [](const char* name, double value) {
    if (!(value >= 0.0) || std::isinf(value)) {
      throw InvalidArgument(fmt::format("{} is {}, expected a number from 0", name, value));
    }
  };
  check_cost("retrieval_weight", options.retrieval_weight);
  check_cost("velocity_weight", options.velocity_weight);
  check_cost("repeat_cost", options.repeat_cost);
  check_cost("skip_cost", options.skip_cost);
  if (!(options.threshold > 0.0)) {
    throw InvalidArgument(fmt::format("threshold is {}, expected a number above 0", options.threshold));
  }
  if (options.most_repeats < 0 || options.most_repeats > TrellisSweep::greatest_repeats) {
    throw InvalidArgument(fmt::format("most_repeats is {}, expected 0 to {}", options.most_repeats,
                                      TrellisSweep::greatest_repeats));
  }
  if (options.count < 1) throw InvalidArgument("count is 0, expected at least 1");
  if (options.apart < 0) {
    throw InvalidArgument(fmt::format("apart is {}, expected at least 0", options.apart));
  }
  for (const std::size_t clip : options.forbidden_clips) {
    if (clip >= clip_count) {
      throw InvalidArgument(fmt::format("forbidden_clips names clip {} of {}", clip, clip_count));
    }
  }
  if (options.joint_weights.empty()) return;
  if (options.joint_weights.size() != joint_count) {
    throw InvalidArgument(fmt::format("joint_weights has {} entries, expected one for each of {} joints",
                                      options.joint_weights.size(), joint_count));
  }
  for (const double weight : options.joint_weights) check_cost("an entry of joint_weights", weight);
  if (std::ranges::all_of(options.joint_weights, [](double weight) { return weight == 0.0; })) {
    throw InvalidArgument("all joint_weights are 0, expected at least one above it");
  }
}

}  // namespace

struct SkeletonRetriever::Impl {
  std::vector<JointTrack> tracks;
  std::vector<std::string> names;
  Trellis trellis;
  BlendProfile profile;
  double frames_per_second;
  std::size_t joint_count;
  SkeletonTable table;

  Impl(const std::vector<JointTrack>& given_tracks, std::vector<std::string> clip_names,
       std::vector<Transition> transitions, BlendProfile blend_profile, double rate);

  MovingSkeleton skeleton(std::size_t node) const;
  std::string name(std::size_t captured_node) const;
};

SkeletonRetriever::Impl::Impl(const std::vector<JointTrack>& given_tracks,
                              std::vector<std::string> clip_names, std::vector<Transition> transitions,
                              BlendProfile blend_profile, double rate)
    : tracks(given_tracks),
      names(std::move(clip_names)),
      trellis(frame_counts(tracks), std::move(transitions)),
      profile(blend_profile),
      frames_per_second(rate),
      joint_count(static_cast<std::size_t>(tracks.front().front().rows())),
      table(trellis.node_count(), joint_count) {
  if (names.size() != tracks.size()) {
    throw InvalidArgument(fmt::format("{} names for {} clips", names.size(), tracks.size()));
  }
  if (!(rate > 0.0) || std::isinf(rate)) {
    throw InvalidArgument(fmt::format("{} frames per second, expected a number above 0", rate));
  }
  if (joint_count == 0) throw InvalidArgument("skeletons without joints");
  for (std::size_t clip = 0; clip < tracks.size(); ++clip) {
    for (std::size_t f = 0; f < tracks[clip].size(); ++f) {
      check_joints(tracks[clip][f], static_cast<Eigen::Index>(joint_count), names[clip], f);
    }
  }
  const std::vector<double> equal_weights(joint_count, 1.0);
  parallel_for(
      0, trellis.node_count(), [&](std::size_t node) { table.set(node, skeleton(node), equal_weights); }, 64);
}

MovingSkeleton SkeletonRetriever::Impl::skeleton(std::size_t node) const {
  const Trellis::Run& run = trellis.run_of(node);
  if (!run.blended) return moving_skeleton(tracks[run.owner_idx], node - run.first);
  const Transition& transition = trellis.transitions()[run.owner_idx];
  const int k = static_cast<int>(node - run.first) + 1 - transition.half_window;
  const double alpha = blend_weight(profile, k, transition.half_window);
  const MovingSkeleton source =
      moving_skeleton(tracks[transition.source_clip], static_cast<std::size_t>(transition.m + k));
  const MovingSkeleton target =
      moving_skeleton(tracks[transition.target_clip], static_cast<std::size_t>(transition.n + k));
  const GroundTransform& source_from_target = transition.source_from_target;
  const Eigen::Matrix3d turn = source_from_target.rotation().transpose();
  const Eigen::MatrixX3d aligned =
      (target.joints * turn).rowwise() + source_from_target.translation3().transpose();
  return {.joints = (1.0 - alpha) * source.joints + alpha * aligned,
          .velocities = (1.0 - alpha) * source.velocities + alpha * (target.velocities * turn)};
}

std::string SkeletonRetriever::Impl::name(std::size_t captured_node) const {
  const Trellis::Run& run = trellis.run_of(captured_node);
  return fmt::format("{}:{}", names[run.owner_idx], captured_node - run.first);
}

namespace {

// One query: its rows, what must not be shown, and the sweeps over them.
class Search {
 public:
  Search(const Trellis& trellis, const SkeletonTable& table, const std::vector<QuerySkeleton>& query,
         const RetrievalOptions& options, double weight_sum)
      : trellis_(trellis),
        options_(options),
        weight_sum_(weight_sum),
        rows_(table, query, options.count > 1),
        row_count_(query.size()),
        hidden_(row_count_) {
    forbid();
  }

  // The best walk; nothing if none is left.
  std::optional<TrellisSweep> sweep() {
    std::optional<TrellisSweep> sweep(std::in_place, trellis_, sweep_options(), row_count_);
    bool reached = true;
    rows_.for_each([&](std::size_t k, float* row) {
      hide(k, row);
      reached = sweep->advance(row);
      if (!reached) broken_row_ = k;
      return reached;
    });
    if (!reached) sweep.reset();
    return sweep;
  }

  // No later walk may show, at the same frames of the query, what this one shows nearby.
  void keep_apart(const std::vector<TrellisSweep::Visit>& walk) {
    const auto apart = static_cast<std::size_t>(options_.apart);
    for (std::size_t k = 0; k < walk.size(); ++k) {
      const Trellis::Run& run = trellis_.run_of(walk[k].node);
      const std::size_t first = walk[k].node - std::min(apart, walk[k].node - run.first);
      const std::size_t end = walk[k].node + std::min(apart, run.end - 1 - walk[k].node) + 1;
      hidden_[k].push_back({first, end});
    }
  }

  struct Failure {
    std::size_t row;
    double nearest = std::numeric_limits<double>::infinity();  // c_skel
    std::size_t nearest_node = 0;
    double threshold = std::numeric_limits<double>::infinity();  // least that leaves a walk; metres a joint
  };
  // After a sweep that broke: where, and what threshold would help.
  Failure explain() {
    Failure failure{.row = broken_row_};
    SweepOptions options = sweep_options();
    options.rule = SweepRule::greatest;
    options.limit = std::numeric_limits<double>::infinity();
    TrellisSweep sweep(trellis_, options, row_count_);
    bool reached = true;
    rows_.for_each([&](std::size_t k, float* row) {
      hide(k, row);
      if (k == failure.row) {
        const float* const nearest = std::min_element(row, row + trellis_.captured_count());
        failure.nearest = *nearest / weight_sum_;
        failure.nearest_node = static_cast<std::size_t>(nearest - row);
      }
      reached = reached && sweep.advance(row);
      return reached || k < failure.row;
    });
    if (reached) failure.threshold = sweep.best() / weight_sum_;
    return failure;
  }

 private:
  struct NodeRange {
    std::size_t first, end;
  };

  SweepOptions sweep_options() const {
    return {.rule = SweepRule::sum,
            .weight = options_.retrieval_weight,
            .limit = options_.threshold * weight_sum_,
            .most_repeats = options_.most_repeats,
            .allow_skips = options_.allow_skips,
            .repeat_cost = options_.repeat_cost,
            .skip_cost = options_.skip_cost};
  }

  void forbid() {
    const auto is_forbidden = [&](std::size_t clip) {
      return std::ranges::find(options_.forbidden_clips, clip) != options_.forbidden_clips.end();
    };
    for (const Trellis::Run& run : trellis_.runs()) {
      bool forbidden = false;
      if (run.blended) {
        const Transition& transition = trellis_.transitions()[run.owner_idx];
        forbidden = is_forbidden(transition.source_clip) || is_forbidden(transition.target_clip);
      } else {
        forbidden = is_forbidden(run.owner_idx);
      }
      if (forbidden) forbidden_.push_back({run.first, run.end});
    }
  }

  void hide(std::size_t k, float* row) const {
    for (const NodeRange& range : forbidden_) std::fill(row + range.first, row + range.end, never);
    for (const NodeRange& range : hidden_[k]) std::fill(row + range.first, row + range.end, never);
  }

  const Trellis& trellis_;
  const RetrievalOptions& options_;
  double weight_sum_;
  TrellisRows rows_;
  std::size_t row_count_;
  std::vector<NodeRange> forbidden_;
  std::vector<std::vector<NodeRange>> hidden_;  // of each row
  std::size_t broken_row_ = 0;
};

NoRetrieval no_retrieval(const Search::Failure& failure, const std::string& nearest_frame,
                         const RetrievalOptions& options, std::size_t query_size) {
  NoRetrieval result;
  result.query_frame = failure.row;
  result.nearest = failure.nearest;
  result.enough = failure.threshold;
  if (std::isinf(failure.nearest)) {
    result.reason = "all clips are forbidden";
    return result;
  }
  result.nearest_frame = nearest_frame;
  result.reason = fmt::format(
      "at frame {} of {} of the query no captured or blended frame within {:.3g} m a joint can be reached; "
      "the nearest captured frame there is {}, at {:.3g} m a joint",
      failure.row, query_size, options.threshold, nearest_frame, failure.nearest);
  if (std::isfinite(failure.threshold)) {
    // Rounded up, so that what is printed is enough.
    result.reason += fmt::format("; a threshold of {:.3f} would leave a path",
                                 std::ceil(failure.threshold * 1000.0) / 1000.0);
  } else {
    result.reason += fmt::format(
        "; no threshold leaves a path, since the clips end before the query does: allow more than {} repeats "
        "in a row, or add transitions to the graph",
        options.most_repeats);
  }
  return result;
}

}  // namespace

SkeletonRetriever::SkeletonRetriever(const std::vector<JointTrack>& tracks,
                                     std::vector<std::string> clip_names, std::vector<Transition> transitions,
                                     BlendProfile profile, double frames_per_second)
    : impl_(std::make_unique<Impl>(tracks, std::move(clip_names), std::move(transitions), profile,
                                   frames_per_second)) {}

SkeletonRetriever::~SkeletonRetriever() = default;
SkeletonRetriever::SkeletonRetriever(SkeletonRetriever&&) noexcept = default;

std::size_t SkeletonRetriever::node_count() const {
  return impl_->trellis.node_count();
}

tl::expected<std::vector<Retrieval>, NoRetrieval> SkeletonRetriever::retrieve(
    const JointTrack& query, const RetrievalOptions& options) const {
  const Impl& impl = *impl_;
  validate(options, impl.joint_count, impl.names.size());
  if (query.empty()) throw InvalidArgument("the query has no frames");
  for (std::size_t k = 0; k < query.size(); ++k) {
    check_joints(query[k], static_cast<Eigen::Index>(impl.joint_count), "the query", k);
  }
  const bool equal_weights = options.joint_weights.empty();
  const SkeletonWeights weights{
      .joints = equal_weights ? std::vector<double>(impl.joint_count, 1.0) : options.joint_weights,
      .velocity = options.velocity_weight};
  std::optional<SkeletonTable> recentred;
  if (!equal_weights) recentred = impl.table.recentred(weights.joints);
  std::vector<QuerySkeleton> skeletons;
  skeletons.reserve(query.size());
  for (std::size_t k = 0; k < query.size(); ++k) {
    skeletons.emplace_back(moving_skeleton(query, k), weights);
  }

  Search search(impl.trellis, recentred ? *recentred : impl.table, skeletons, options, weights.sum());
  std::vector<Retrieval> answers;
  while (answers.size() < options.count) {
    const std::optional<TrellisSweep> sweep = search.sweep();
    if (!sweep) break;
    const std::vector<TrellisSweep::Visit> walk = sweep->walk();
    Retrieval answer = lay_out_walk(impl.trellis, walk, impl.frames_per_second);
    for (std::size_t k = 0; k < query.size(); ++k) {
      const double dissimilarity =
          skeleton_dissimilarity(moving_skeleton(query, k), impl.skeleton(walk[k].node), weights);
      answer.dissimilarity.push_back(dissimilarity / weights.sum());
      answer.retrieval_cost += dissimilarity;
    }
    answer.cost = answer.transition_cost + options.retrieval_weight * answer.retrieval_cost +
                  answer.repeats * options.repeat_cost + answer.skips * options.skip_cost;
    answers.push_back(std::move(answer));
    search.keep_apart(walk);
  }
  if (!answers.empty()) return answers;
  const Search::Failure failure = search.explain();
  return tl::unexpected(no_retrieval(failure, impl.name(failure.nearest_node), options, query.size()));
}

}  // namespace reprise
