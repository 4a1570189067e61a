// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/io/motion_file.h"

namespace reprise {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double radians_per_degree = std::numbers::pi / 180.0;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The rotation of a joint against its parent.
Quaterniond local_rotation(const SkeletalMotion& motion, std::size_t frame, std::size_t joint) {
  const SkeletonPose& pose = motion.frames[frame];
  const auto parent = static_cast<std::size_t>(motion.skeleton.joints[joint].parent);
  return pose.rotation[parent].conjugate() * pose.rotation[joint];
}

// Joints that turn against their parents in the course of a motion: fingers of a body suit never do.
class MovingJoints {
 public:
  explicit MovingJoints(const SkeletalMotion& motion) : motion_(motion) {
    constexpr double least = 5.0 * radians_per_degree;
    constexpr std::size_t samples = 50;
    const std::size_t step = std::max<std::size_t>(1, motion.frames.size() / samples);
    const std::size_t middle = motion.frames.size() / 2;
    for (std::size_t j = 0; j < motion.skeleton.joints.size(); ++j) {
      if (motion.skeleton.joints[j].parent < 0) continue;
      double greatest = 0.0;
      for (std::size_t f = 0; f < motion.frames.size(); f += step) {
        greatest = std::max(greatest, local(f, j).angularDistance(local(middle, j)));
      }
      if (greatest > least) joints_.push_back(j);
    }
  }

  bool empty() const { return joints_.empty(); }
  // Share of them that are as at rest in a frame.
  double share_at_rest(std::size_t frame) const {
    constexpr double near = 2.5 * radians_per_degree;
    std::size_t count = 0;
    for (const std::size_t j : joints_) {
      if (local(frame, j).angularDistance(Quaterniond::Identity()) < near) ++count;
    }
    return static_cast<double>(count) / static_cast<double>(joints_.size());
  }
  // Mean angle by which they turn from a frame to the next.
  double turn_after(std::size_t frame) const {
    double sum = 0.0;
    for (const std::size_t j : joints_) sum += local(frame, j).angularDistance(local(frame + 1, j));
    return sum / static_cast<double>(joints_.size());
  }

 private:
  Quaterniond local(std::size_t frame, std::size_t joint) const {
    return local_rotation(motion_, frame, joint);
  }

  const SkeletalMotion& motion_;
  std::vector<std::size_t> joints_;
};

// Number of frames at the beginning in the rest pose, out of which the figure then leaps: a motion that
// begins at rest and moves on smoothly has none. In a converter's T-pose a few joints are not as at rest.
std::size_t rest_frames(const SkeletalMotion& motion) {
  constexpr double at_rest = 0.6, moving = 0.45;
  constexpr double longest = 1.0;  // second
  constexpr double least_turn = 5.0 * radians_per_degree;
  constexpr double leap = 2.5;  // times what joints turn in a frame otherwise
  if (motion.frames.size() < 3) return 0;
  const MovingJoints joints(motion);
  if (joints.empty()) return 0;
  const std::size_t last =
      std::min(motion.frames.size() - 2, static_cast<std::size_t>(longest * motion.frames_per_second));
  std::size_t count = 0;
  while (count <= last && joints.share_at_rest(count) >= at_rest) ++count;
  if (count == 0 || count > last || joints.share_at_rest(count) > moving) return 0;
  std::vector<double> turns;
  for (std::size_t f = count; f + 1 < motion.frames.size(); ++f) turns.push_back(joints.turn_after(f));
  const double usual = turns.empty() ? 0.0 : median(std::move(turns));
  return joints.turn_after(count - 1) > std::max(least_turn, leap * usual) ? count : 0;
}

struct Leap {
  Vector3d common = Vector3d::Zero();  // by which the joints go farther than before and after
  double apart = 0.0;                  // how far most of them are from that
};

// From a frame to the next; `begin`: the first frame that counts.
Leap leap_after(const SkeletalMotion& motion, std::size_t frame, std::size_t begin) {
  const std::size_t count = motion.skeleton.joints.size();
  const auto step = [&](std::size_t f, std::size_t j) -> Vector3d {
    return motion.frames[f + 1].position[j] - motion.frames[f].position[j];
  };
  std::vector<Vector3d> excess(count);
  for (std::size_t j = 0; j < count; ++j) {
    // Median of up to two steps before and after: another leap nearby does not count.
    std::vector<Vector3d> near;
    for (const int offset : {-2, -1, 1, 2}) {
      const auto f = static_cast<std::ptrdiff_t>(frame) + offset;
      if (f < static_cast<std::ptrdiff_t>(begin) ||
          f + 1 >= static_cast<std::ptrdiff_t>(motion.frames.size())) {
        continue;
      }
      near.push_back(step(static_cast<std::size_t>(f), j));
    }
    Vector3d usual = Vector3d::Zero();
    for (int axis = 0; axis < 3 && !near.empty(); ++axis) {
      std::vector<double> values;
      for (const Vector3d& value : near) values.push_back(value[axis]);
      std::ranges::sort(values);
      usual[axis] = 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
    }
    excess[j] = step(frame, j) - usual;
  }
  Leap leap;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Vector3d& value : excess) values.push_back(value[axis]);
    leap.common[axis] = median(std::move(values));
  }
  std::vector<double> apart;
  for (const Vector3d& value : excess) apart.push_back((value - leap.common).norm());
  const auto most = apart.begin() + static_cast<std::ptrdiff_t>(3 * apart.size() / 4);
  std::nth_element(apart.begin(), most, apart.end());
  leap.apart = *most;
  return leap;
}

// How far the farthest joint that hangs on one is from it at rest.
double reach_below(const Skeleton& skeleton, std::size_t joint) {
  double farthest = 0.0;
  std::vector<bool> hangs(skeleton.joints.size(), false);
  hangs[joint] = true;
  for (std::size_t j = joint + 1; j < skeleton.joints.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    hangs[j] = parent >= 0 && hangs[static_cast<std::size_t>(parent)];
    if (!hangs[j]) continue;
    farthest =
        std::max(farthest, (skeleton.joints[j].rest_position - skeleton.joints[joint].rest_position).norm());
  }
  return farthest;
}

// Spans in which a joint is turned over: between two leaps that no body makes, of which the second takes the
// first one back, or between a leap and the end that is near.
void find_flips(const SkeletalMotion& motion, std::size_t joint, std::size_t begin,
                std::vector<MotionDefect>& defects) {
  constexpr double fastest = 8000.0 * radians_per_degree;  // a second
  constexpr double least = 60.0 * radians_per_degree;      // a frame
  constexpr double longest = 0.25;                         // seconds
  const auto turn = [&](std::size_t a, std::size_t b) {
    return local_rotation(motion, a, joint).angularDistance(local_rotation(motion, b, joint));
  };
  const double limit = std::max(least, fastest / motion.frames_per_second);
  const std::size_t end = motion.frames.size();
  const auto reach = static_cast<std::size_t>(longest * motion.frames_per_second);
  std::vector<std::size_t> leaps;  // between these frames and the next
  for (std::size_t f = begin; f + 1 < end; ++f) {
    if (turn(f, f + 1) > limit) leaps.push_back(f);
  }
  const auto add = [&](std::size_t first, std::size_t last) {
    defects.push_back({.kind = MotionDefect::Kind::flip,
                       .first_frame = first,
                       .last_frame = last,
                       .joint = static_cast<int>(joint)});
  };
  // Of several leaps near an end, the one that is farthest from it counts.
  std::optional<std::size_t> leading, trailing;
  for (std::size_t i = 0; i < leaps.size(); ++i) {
    const std::size_t f = leaps[i];
    const bool returns =
        i + 1 < leaps.size() && leaps[i + 1] - f <= reach && turn(f, leaps[i + 1] + 1) < 0.5 * limit;
    if (returns) {
      add(f + 1, leaps[i + 1]);
      ++i;
    } else if (f - begin < reach) {
      leading = f;
    } else if (end - 2 - f < reach && !trailing) {
      trailing = f;
    }
  }
  if (leading) add(begin, *leading);
  if (trailing) add(*trailing + 1, end - 1);
}

// The joint's rotation against its parent over the span, with all that hangs on it.
void lead_over(SkeletalMotion& motion, const MotionDefect& flip, std::size_t begin) {
  const auto joint = static_cast<std::size_t>(flip.joint);
  const bool has_before = flip.first_frame > begin, has_after = flip.last_frame + 1 < motion.frames.size();
  if (!has_before && !has_after) return;
  const Quaterniond before =
      local_rotation(motion, has_before ? flip.first_frame - 1 : flip.last_frame + 1, joint);
  const Quaterniond after =
      local_rotation(motion, has_after ? flip.last_frame + 1 : flip.first_frame - 1, joint);
  const double steps = static_cast<double>(flip.last_frame + 2 - flip.first_frame);
  for (std::size_t f = flip.first_frame; f <= flip.last_frame; ++f) {
    const SkeletonPose old = motion.frames[f];
    SkeletonPose& pose = motion.frames[f];
    for (std::size_t j = joint; j < old.rotation.size(); ++j) {
      if (motion.skeleton.joints[j].parent < 0) continue;
      const auto parent = static_cast<std::size_t>(motion.skeleton.joints[j].parent);
      const Quaterniond from_parent =
          j == joint ? before.slerp(static_cast<double>(f + 1 - flip.first_frame) / steps, after)
                     : old.rotation[parent].conjugate() * old.rotation[j];
      pose.rotation[j] = (pose.rotation[parent] * from_parent).normalized();
      pose.position[j] = pose.position[parent] +
                         pose.rotation[parent] *
                             (old.rotation[parent].conjugate() * (old.position[j] - old.position[parent]));
    }
  }
}

}  // namespace

std::vector<MotionDefect> find_defects(const SkeletalMotion& motion) {
  constexpr double shortest = 0.04;  // metres
  // Three to four times free fall: what bodies do to change their way within a frame.
  constexpr double greatest_acceleration = 40.0;
  std::vector<MotionDefect> defects;
  if (motion.skeleton.joints.empty()) return defects;
  const std::size_t rest = rest_frames(motion);
  if (rest > 0) {
    defects.push_back(
        {.kind = MotionDefect::Kind::rest_pose, .first_frame = 0, .last_frame = rest - 1, .distance = 0.0});
  }
  const double tick = 1.0 / motion.frames_per_second;
  const double least = std::max(shortest, greatest_acceleration * tick * tick);
  // A jump is told from the steps before and after it.
  for (std::size_t f = rest + 1; f + 2 < motion.frames.size(); ++f) {
    const Leap leap = leap_after(motion, f, rest);
    const double distance = leap.common.norm();
    if (!(distance > least) || distance < leap.apart) continue;
    defects.push_back(
        {.kind = MotionDefect::Kind::jump, .first_frame = f, .last_frame = f + 1, .distance = distance});
  }
  constexpr double shortest_bone = 0.05;  // metres: thumbs of body suits flutter, and nobody sees it
  for (std::size_t j = 0; j < motion.skeleton.joints.size(); ++j) {
    if (motion.skeleton.joints[j].parent < 0 || reach_below(motion.skeleton, j) < shortest_bone) continue;
    find_flips(motion, j, rest, defects);
  }
  return defects;
}

std::string to_string(const MotionDefect& defect, const Skeleton& skeleton) {
  const std::size_t first = defect.first_frame + 1, last = defect.last_frame + 1;
  if (defect.kind == MotionDefect::Kind::jump) {
    return fmt::format("the figure jumps {:.0f} cm between frames {} and {}", 100.0 * defect.distance, first,
                       last);
  }
  if (defect.kind == MotionDefect::Kind::flip) {
    const std::string& name = skeleton.joints.at(static_cast<std::size_t>(defect.joint)).name;
    return first == last ? fmt::format("{} is turned over in frame {}", name, first)
                         : fmt::format("{} is turned over in frames {} to {}", name, first, last);
  }
  return first == last ? fmt::format("frame {} is in the rest pose", first)
                       : fmt::format("frames {} to {} are in the rest pose", first, last);
}

SkeletalMotion without_defects(const SkeletalMotion& motion, const std::vector<MotionDefect>& defects) {
  SkeletalMotion result = motion;
  std::size_t begin = 0;
  for (const MotionDefect& defect : defects) {
    if (defect.last_frame >= motion.frames.size() || defect.first_frame > defect.last_frame) {
      throw InvalidArgument(fmt::format("a defect at frames {} to {} of a motion of {} frames",
                                        defect.first_frame, defect.last_frame, motion.frames.size()));
    }
    if (defect.kind == MotionDefect::Kind::rest_pose) begin = std::max(begin, defect.last_frame + 1);
  }
  for (const MotionDefect& defect : defects) {
    if (defect.kind == MotionDefect::Kind::flip) lead_over(result, defect, begin);
    if (defect.kind != MotionDefect::Kind::jump || defect.first_frame < begin) continue;
    const Vector3d shift = leap_after(motion, defect.first_frame, begin).common;
    for (std::size_t f = 0; f <= defect.first_frame; ++f) {
      for (Vector3d& position : result.frames[f].position) position += shift;
    }
  }
  result.frames.erase(result.frames.begin(), result.frames.begin() + static_cast<std::ptrdiff_t>(begin));
  return result;
}

}  // namespace reprise
