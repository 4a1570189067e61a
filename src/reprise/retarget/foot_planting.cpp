// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/retarget/foot_planting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "reprise/retarget/bone_angles.h"
#include "reprise/retarget/foot_shape.h"
#include "reprise/retarget/hip_course.h"
#include "reprise/retarget/limb.h"

namespace reprise::retargeting {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// A foot in one frame: where its ankle is, and the world rotations of foot and toes.
struct Foot {
  Vector3d ankle;
  Quaterniond foot, toe;
};

struct Angles {
  double yaw = 0.0, pitch = 0.0;
};

Angles angles_of(const Quaterniond& foot) {
  const Vector3d ahead = foot * Vector3d::UnitZ();
  return {std::atan2(ahead.x(), ahead.z()), std::asin(std::clamp(ahead.y(), -1.0, 1.0))};
}

Quaterniond pitch_rotation(double pitch) {  // positive: toes up
  return Quaterniond(Eigen::AngleAxisd(-pitch, Vector3d::UnitX()));
}

double smoother_step(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * u * (u * (6.0 * u - 15.0) + 10.0);
}

// What is within `dead` of zero becomes zero, the rest moves towards it.
double beyond(double value, double dead) {
  return std::copysign(std::max(0.0, std::abs(value) - dead), value);
}

// Feet that differ less than this from flat or from their heading stand still.
constexpr double dead_pitch = 1.5 * radians_per_degree;
constexpr double leaving_pitch = -30.0 * radians_per_degree;
constexpr double dead_yaw = 5.0 * radians_per_degree;
// Farthest that the places a standing foot implies may lie from their mean, metres: beyond, it stands twice.
constexpr double greatest_spread = 0.07;
constexpr double longest_lead = 0.4;  // seconds over which a swing is led from or to a contact

using AnkleShifts = std::vector<std::array<Vector3d, 2>>;

// One foot of the whole motion.
class PlantedFoot {
 public:
  PlantedFoot(const SkeletalMotion& motion, int side, std::vector<bool> contacts, const AnkleShifts& shifts);

  std::size_t ankle_joint() const { return foot_joint_; }
  std::size_t toe_joint() const { return toe_joint_; }
  const std::vector<bool>& contacts() const { return contacts_; }
  const std::vector<Foot>& feet() const { return feet_; }

 private:
  struct Stance {
    std::size_t begin, end;  // frames
  };
  void level();
  std::vector<Stance> stances() const;
  void split(Stance stance);
  Vector3d implied_ball(std::size_t frame, double yaw) const;
  double mean_yaw(const Stance& stance) const;
  Foot standing(const Vector3d& ball, double yaw, double pitch) const;
  void stand(const Stance& stance);
  void swing(std::size_t begin, std::size_t end);
  void keep_above_ground(Foot& foot) const;

  FootShape shape_;
  double frames_per_second_;
  std::size_t foot_joint_, toe_joint_;
  std::vector<bool> contacts_;
  std::vector<Foot> raw_;   // as transferred, with level soles
  std::vector<Foot> feet_;  // as planted
};

PlantedFoot::PlantedFoot(const SkeletalMotion& motion, int side, std::vector<bool> contacts,
                         const AnkleShifts& shifts)
    : shape_(foot_shape(motion.skeleton, side)),
      frames_per_second_(motion.frames_per_second),
      contacts_(std::move(contacts)) {
  const std::string name = side == 0 ? "left_" : "right_";
  foot_joint_ = static_cast<std::size_t>(motion.skeleton.joint_idx(name + "foot"));
  toe_joint_ = static_cast<std::size_t>(motion.skeleton.joint_idx(name + "toe"));
  for (const SkeletonPose& pose : motion.frames) {
    raw_.push_back({pose.position[foot_joint_], pose.rotation[foot_joint_], pose.rotation[toe_joint_]});
  }
  for (std::size_t f = 0; f < shifts.size(); ++f) {
    raw_[f].ankle += shifts[f][static_cast<std::size_t>(side)];
  }
  level();
  // With the heel that high the foot is leaving: it rolls over the tip of its toes, not over its ball.
  for (std::size_t f = 0; f < raw_.size(); ++f) {
    if (angles_of(raw_[f].foot).pitch < leaving_pitch) contacts_[f] = false;
  }
  for (const Stance& stance : stances()) split(stance);
  feet_ = raw_;
  const std::vector<Stance> all = stances();
  for (const Stance& stance : all) stand(stance);
  std::size_t begin = 0;
  for (const Stance& stance : all) {
    swing(begin, stance.begin);
    begin = stance.end;
  }
  swing(begin, raw_.size());
}

// What is flat in the motion's rest pose need not be so when it stands: the pitch of the stillest standing
// frames is flat.
void PlantedFoot::level() {
  constexpr double still = 0.15;  // m/s
  constexpr double greatest = 20.0 * radians_per_degree;
  std::vector<double> pitches;
  for (std::size_t f = 1; f + 1 < raw_.size(); ++f) {
    const double speed = 0.5 * frames_per_second_ * (raw_[f + 1].ankle - raw_[f - 1].ankle).norm();
    if (contacts_[f] && speed < still) pitches.push_back(angles_of(raw_[f].foot).pitch);
  }
  if (pitches.empty()) return;
  const double flat = std::clamp(median(std::move(pitches)), -greatest, greatest);
  for (Foot& foot : raw_) {
    foot.foot = (foot.foot * pitch_rotation(-flat)).normalized();
    foot.toe = (foot.toe * pitch_rotation(-flat)).normalized();
  }
}

std::vector<PlantedFoot::Stance> PlantedFoot::stances() const {
  std::vector<Stance> result;
  for (std::size_t f = 0; f < contacts_.size(); ++f) {
    if (!contacts_[f]) continue;
    if (f == 0 || !contacts_[f - 1]) result.push_back({f, f});
    result.back().end = f + 1;
  }
  return result;
}

double PlantedFoot::mean_yaw(const Stance& stance) const {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (std::size_t f = stance.begin; f < stance.end; ++f) {
    const double yaw = angles_of(raw_[f].foot).yaw;
    sum += Eigen::Vector2d(std::sin(yaw), std::cos(yaw));
  }
  return std::atan2(sum.x(), sum.y());
}

// Where the ball would have to stand for the foot to be where it is, on the heel or the ball as it is
// pitched.
Vector3d PlantedFoot::implied_ball(std::size_t frame, double yaw) const {
  const Foot& foot = raw_[frame];
  const double pitch = beyond(angles_of(foot.foot).pitch, dead_pitch);
  return foot.ankle + shape_.ball - standing(shape_.ball, yaw, pitch).ankle;
}

// Cuts a contact where the foot moves most, as long as the places it implies are too far apart.
void PlantedFoot::split(Stance stance) {
  std::vector<Stance> open = {stance};
  while (!open.empty()) {
    const Stance s = open.back();
    open.pop_back();
    const double yaw = mean_yaw(s);
    std::vector<Vector3d> balls;
    Vector3d mean = Vector3d::Zero();
    for (std::size_t f = s.begin; f < s.end; ++f) {
      balls.push_back(implied_ball(f, yaw));
      balls.back().y() = 0.0;
      mean += balls.back();
    }
    mean /= static_cast<double>(balls.size());
    double spread = 0.0;
    for (const Vector3d& ball : balls) spread = std::max(spread, (ball - mean).norm());
    if (spread < greatest_spread || balls.size() < 3) continue;
    std::size_t fastest = 1;
    for (std::size_t i = 1; i + 1 < balls.size(); ++i) {
      if ((balls[i + 1] - balls[i - 1]).norm() > (balls[fastest + 1] - balls[fastest - 1]).norm())
        fastest = i;
    }
    contacts_[s.begin + fastest] = false;
    open.push_back({s.begin, s.begin + fastest});
    if (s.begin + fastest + 1 < s.end) open.push_back({s.begin + fastest + 1, s.end});
  }
}

Foot PlantedFoot::standing(const Vector3d& ball, double yaw, double pitch) const {
  const Quaterniond turn = turn_about_up(yaw);
  const Quaterniond rotation = turn * pitch_rotation(pitch);
  if (pitch <= 0.0) return {ball + rotation * (shape_.ankle - shape_.ball), rotation, turn};
  const Vector3d heel = ball + turn * (shape_.heel - shape_.ball);
  return {heel + rotation * (shape_.ankle - shape_.heel), rotation, rotation};
}

void PlantedFoot::stand(const Stance& stance) {
  const double yaw = mean_yaw(stance);
  // The median place: frames in which the foot is still going down or already leaving say least.
  std::vector<double> x, z;
  for (std::size_t f = stance.begin; f < stance.end; ++f) {
    const Vector3d implied = implied_ball(f, yaw);
    x.push_back(implied.x());
    z.push_back(implied.z());
  }
  const Vector3d ball(median(std::move(x)), shape_.ball.y(), median(std::move(z)));
  std::vector<double> pitch, turned;
  for (std::size_t f = stance.begin; f < stance.end; ++f) {
    const Angles angles = angles_of(raw_[f].foot);
    pitch.push_back(beyond(angles.pitch, dead_pitch));
    turned.push_back(beyond(std::remainder(angles.yaw - yaw, 2.0 * std::numbers::pi), dead_yaw));
  }
  // The foot pivots about its ball, so only while the ball is down: on the heel it would slide.
  const auto on_ball = [](double angle) { return angle <= 0.0; };
  const auto first = static_cast<std::size_t>(std::ranges::find_if(pitch, on_ball) - pitch.begin());
  double pivot = first < pitch.size() ? turned[first] : 0.0;
  for (std::size_t i = 0; i < pitch.size(); ++i) {
    if (i > first && on_ball(pitch[i]) && on_ball(pitch[i - 1])) pivot += turned[i] - turned[i - 1];
    feet_[stance.begin + i] = standing(ball, yaw + pivot, pitch[i]);
  }
}

// Frames between two contacts: what planting moved at either end wears off.
void PlantedFoot::swing(std::size_t begin, std::size_t end) {
  struct Correction {
    Vector3d ankle = Vector3d::Zero();
    Quaterniond foot = Quaterniond::Identity(), toe = Quaterniond::Identity();
  };
  const auto correction = [&](std::size_t f) {
    return Correction{feet_[f].ankle - raw_[f].ankle, feet_[f].foot * raw_[f].foot.conjugate(),
                      feet_[f].toe * raw_[f].toe.conjugate()};
  };
  const bool has_before = begin > 0, has_after = end < raw_.size();
  const Correction before = has_before ? correction(begin - 1) : Correction{};
  const Correction after = has_after ? correction(end) : Correction{};
  double duration = longest_lead * frames_per_second_;
  if (has_before && has_after) duration = std::min(duration, static_cast<double>(end - begin + 1));
  const Quaterniond none = Quaterniond::Identity();
  for (std::size_t f = begin; f < end; ++f) {
    const double since = static_cast<double>(f + 1 - begin), until = static_cast<double>(end - f);
    const double w0 = has_before ? 1.0 - smoother_step(since / duration) : 0.0;
    const double w1 = has_after ? 1.0 - smoother_step(until / duration) : 0.0;
    Foot& foot = feet_[f];
    foot.ankle = raw_[f].ankle + w0 * before.ankle + w1 * after.ankle;
    foot.foot = (none.slerp(w0, before.foot) * none.slerp(w1, after.foot) * raw_[f].foot).normalized();
    foot.toe = (none.slerp(w0, before.toe) * none.slerp(w1, after.toe) * raw_[f].toe).normalized();
    keep_above_ground(foot);
  }
}

void PlantedFoot::keep_above_ground(Foot& foot) const {
  const Vector3d ball = foot.ankle + foot.foot * (shape_.ball - shape_.ankle);
  const Vector3d ball_sole(shape_.ball.x(), 0.0, shape_.ball.z());
  const double lowest = std::min({(foot.ankle + foot.foot * (shape_.heel - shape_.ankle)).y(),
                                  (ball + foot.toe * (ball_sole - shape_.ball)).y(),
                                  (ball + foot.toe * (shape_.toe_tip - shape_.ball)).y()});
  foot.ankle.y() += std::max(0.0, -lowest);
}

// A leg from the hip joint to the ankle.
struct Leg {
  std::size_t thigh, shin;
  Limb limb;
};

Leg make_leg(const Skeleton& skeleton, int side) {
  const std::string name = side == 0 ? "left_" : "right_";
  const int thigh = skeleton.joint_idx(name + "thigh"), shin = skeleton.joint_idx(name + "shin");
  const auto rest = [&](int j) { return skeleton.joints[static_cast<std::size_t>(j)].rest_position; };
  return {static_cast<std::size_t>(thigh), static_cast<std::size_t>(shin),
          Limb(rest(thigh), rest(shin), rest(skeleton.joint_idx(name + "foot")), Vector3d::UnitX())};
}

// How far a hip joint must sink for the ankle to be within `reach`; at most `most`.
double sinking(const Vector3d& hip, const Vector3d& ankle, double reach, double most) {
  const Vector3d way = ankle - hip;
  if (way.norm() <= reach) return 0.0;
  const double across = way.x() * way.x() + way.z() * way.z();
  if (across >= reach * reach) return most;
  return std::clamp(-way.y() - std::sqrt(reach * reach - across), 0.0, most);
}

// The least curve above the values that is as smooth as half a stride: greatest of the neighbours, then their
// mean over the same window.
std::vector<double> smooth_above(const std::vector<double>& values, int window) {
  const int last = static_cast<int>(values.size()) - 1;
  std::vector<double> above(values.size()), result(values.size());
  const auto at = [&](const std::vector<double>& from, int f) {
    return from[static_cast<std::size_t>(std::clamp(f, 0, last))];
  };
  for (int f = 0; f <= last; ++f) {
    for (int k = -window; k <= window; ++k) {
      above[static_cast<std::size_t>(f)] = std::max(above[static_cast<std::size_t>(f)], at(values, f + k));
    }
  }
  for (int f = 0; f <= last; ++f) {
    double sum = 0.0, weights = 0.0;
    for (int k = -window; k <= window; ++k) {
      const double weight = 1.0 + std::cos(std::numbers::pi * k / (window + 1.0));
      sum += weight * at(above, f + k);
      weights += weight;
    }
    result[static_cast<std::size_t>(f)] = sum / weights;
  }
  return result;
}

}  // namespace

void plant_feet(SkeletalMotion& motion, std::vector<FootContacts>& contacts, const AnkleShifts& shifts) {
  constexpr double greatest_share = 0.995;   // of a leg's length that it reaches with: a straight knee pops
  constexpr double greatest_reach = 0.998;   // beyond, legs stretch ever less
  constexpr double greatest_sinking = 0.16;  // metres
  constexpr double half_window = 0.12;       // seconds
  const Skeleton& skeleton = motion.skeleton;
  std::vector<PlantedFoot> feet;
  std::vector<Leg> legs;
  for (const int side : {0, 1}) {
    std::vector<bool> of_side;
    for (const FootContacts& both : contacts) of_side.push_back(both[static_cast<std::size_t>(side)]);
    feet.emplace_back(motion, side, std::move(of_side), shifts);
    legs.push_back(make_leg(skeleton, side));
  }
  HipCourse course(motion.frames.size());
  std::array<std::vector<Vector3d>, 2> ways;  // from hip joint to ankle, before
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    std::vector<Vector3d> shifted;
    for (std::size_t f = 0; f < motion.frames.size(); ++f) {
      contacts[f][side] = feet[side].contacts()[f];
      const SkeletonPose& pose = motion.frames[f];
      const Vector3d& ankle = pose.position[feet[side].ankle_joint()];
      ways[side].push_back(ankle - pose.position[legs[side].thigh]);
      shifted.push_back(feet[side].feet()[f].ankle - ankle);
    }
    course.add_leg(legs[side].limb, ways[side], shifted, motion.frames_per_second);
  }
  const std::vector<Vector3d> hips = course.shifts(motion.frames_per_second);

  std::vector<double> needed(motion.frames.size(), 0.0);
  for (std::size_t f = 0; f < needed.size(); ++f) {
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      // A leg may be as straight as the motion has it.
      const double reach = std::max(greatest_share * legs[side].limb.reach(),
                                    std::min(ways[side][f].norm(), greatest_reach * legs[side].limb.reach()));
      needed[f] = std::max(needed[f], sinking(motion.frames[f].position[legs[side].thigh] + hips[f],
                                              feet[side].feet()[f].ankle, reach, greatest_sinking));
    }
  }
  const int window = std::max(1, static_cast<int>(std::lround(half_window * motion.frames_per_second)));
  const std::vector<double> sunk = smooth_above(needed, window);
  for (std::size_t f = 0; f < motion.frames.size(); ++f) {
    SkeletonPose& pose = motion.frames[f];
    std::vector<Quaterniond> rotations = pose.rotation;
    const Vector3d moved = hips[f] - sunk[f] * Vector3d::UnitY();
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      const Foot& foot = feet[side].feet()[f];
      const Leg& leg = legs[side];
      const Vector3d hip = pose.position[leg.thigh] + moved;
      // The knee keeps to the plane in which the transferred thigh bends it, so that it never flips.
      const Vector3d hinge = pose.rotation[leg.thigh] * Vector3d::UnitX();
      const Vector3d pole = (foot.ankle - hip).cross(hinge);
      const Limb::Rotations turned = leg.limb.reaching(hip, foot.ankle, pole, greatest_reach);
      rotations[leg.thigh] = turned.upper;
      rotations[leg.shin] = turned.lower;
      rotations[feet[side].ankle_joint()] = foot.foot;
      rotations[feet[side].toe_joint()] = foot.toe;
    }
    pose = pose_from_rotations(skeleton, rotations, pose.position[0] + moved);
  }
}

}  // namespace reprise::retargeting
