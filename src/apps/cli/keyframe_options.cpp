// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "keyframe_options.h"

#include <algorithm>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/io/number.h"

namespace reprise::cli {
namespace {

constexpr double radians_per_degree = std::numbers::pi / 180.0;

// What is given in another form than the stage takes it.
struct GivenText {
  std::string from;
  std::vector<std::string> via;
  std::string to;
  std::string goal;
  std::optional<double> turn;
  std::optional<double> goal_tolerance;
  std::optional<double> turn_tolerance;
  std::vector<std::string> route;
  std::optional<double> max_deviation;
  bool correct = false;
  bool slide_feet = false;
  CorrectionOptions correction;
};

Eigen::Vector2d parse_ground_point(const char* option, const std::string& text) {
  const char* const end = text.data() + text.size();
  const char* const comma = text.data() + std::min(text.find(','), text.size());
  Eigen::Vector2d point;
  if (comma != end && parse_double(text.data(), comma, point.x()) == comma &&
      parse_double(comma + 1, end, point.y()) == end) {
    return point;
  }
  throw InvalidArgument(fmt::format(
      "{}: expected a point on the ground X,Z in metres, such as 3.5,-1; found '{}'", option, text));
}

void refuse_alone(const char* option, bool is_given, const char* partner) {
  if (is_given) throw InvalidArgument(fmt::format("{} is given without {}", option, partner));
}

void complete(const GivenText& given, KeyframesOptions& options) {
  options.keyframes = {given.from};
  options.keyframes.insert(options.keyframes.end(), given.via.begin(), given.via.end());
  options.keyframes.push_back(given.to);
  if (!given.goal.empty()) {
    GroundGoal& goal = options.goal.emplace();
    goal.position = parse_ground_point("--goal", given.goal);
    if (given.turn) goal.turn = *given.turn * radians_per_degree;
    if (given.goal_tolerance) goal.position_tolerance = *given.goal_tolerance;
    if (given.turn_tolerance) {
      refuse_alone("--turn-tolerance", !given.turn, "--turn");
      goal.turn_tolerance = *given.turn_tolerance * radians_per_degree;
    }
  } else {
    refuse_alone("--turn", given.turn.has_value(), "--goal");
    refuse_alone("--goal-tolerance", given.goal_tolerance.has_value(), "--goal");
    refuse_alone("--turn-tolerance", given.turn_tolerance.has_value(), "--goal");
  }
  if (!given.route.empty()) {
    GroundRoute& route = options.route.emplace();
    for (const std::string& text : given.route) route.points.push_back(parse_ground_point("--route", text));
    if (given.max_deviation) route.max_deviation = *given.max_deviation;
  } else {
    refuse_alone("--max-deviation", given.max_deviation.has_value(), "--route");
  }
  if (given.correct) options.correction = given.correction;
  options.plant_feet = !given.slide_feet;
}

}  // namespace

void add_correction_limits(CLI::App& command, CorrectionOptions& options) {
  command.add_option("--max-retiming", options.max_retiming,
                     "with correction: share by which the duration may change");
  command.add_option("--max-stretch", options.max_stretch,
                     "with correction: share by which the distance may change");
}

std::function<void()> add_keyframe_options(CLI::App& command, KeyframesOptions& options) {
  const auto given = std::make_shared<GivenText>();
  command.add_option("--from", given->from, "first key-frame, CLIP:FRAME")->required();
  command.add_option("--via", given->via, "key-frames to show on the way, in order");
  command.add_option("--to", given->to, "last key-frame, CLIP:FRAME")->required();
  command.add_option("--distance", options.distance,
                     "ground distance to travel, metres; 0: as short as possible");
  command.add_option("--time", options.time, "duration, seconds; 0: as short as possible");
  command.add_option("--min-distance", options.min_distance, "travel at least so many metres");
  command.add_option("--max-distance", options.max_distance, "travel at most so many metres");
  command.add_option("--min-time", options.min_time, "last at least so many seconds");
  command.add_option("--max-time", options.max_time, "last at most so many seconds");
  command.add_option("--forbid", options.forbidden_clips, "clips not to show");
  command.add_option("--require", options.compulsory_clips, "clips to show on the way, in any order");
  command.add_option("--goal", given->goal,
                     "where to end: X,Z in metres from where the first key-frame stands");
  command.add_option("--turn", given->turn, "with --goal: degrees to have turned by then, left positive");
  command.add_option("--goal-tolerance", given->goal_tolerance, "end at most so many metres from the goal");
  command.add_option("--turn-tolerance", given->turn_tolerance, "end at most so many degrees from the turn");
  command.add_option("--route", given->route, "line on the ground to follow: X,Z X,Z ... as for --goal");
  command.add_option("--max-deviation", given->max_deviation, "keep within so many metres of the route");
  command.add_option("--distance-weight", options.optimizer.distance_weight,
                     "cost of a metre beside the target");
  command.add_option("--time-weight", options.optimizer.time_weight, "cost of a frame beside the target");
  command.add_option("--position-weight", options.optimizer.position_weight,
                     "cost of a metre beside the goal");
  command.add_option("--turn-weight", options.optimizer.turn_weight, "cost of a radian beside the turn");
  command.add_option("--route-weight", options.optimizer.route_weight,
                     "cost of a metre beside the route, for each second");
  command
      .add_option("--max-labels", options.optimizer.max_labels,
                  "partial paths to look at before the best so far is given with its gap")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--alternatives", options.alternatives.count,
                  "different answers to give, the best one included")
      ->check(CLI::PositiveNumber);
  command.add_flag(
      "--correct", given->correct,
      "play a little faster or slower, walk a little longer or shorter, to meet time and distance");
  add_correction_limits(command, given->correction);
  command.add_flag("--slide-feet", given->slide_feet, "leave feet as the blends move them");
  command.add_option("--name", options.name, "name of the resulting clip");
  return [given, &options] { complete(*given, options); };
}

}  // namespace reprise::cli
