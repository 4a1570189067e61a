// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/motion/performer_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/retarget/limb.h"
#include "reprise/synthetic/motion/foot_plan.h"
#include "reprise/synthetic/motion/gait.h"
#include "reprise/synthetic/motion/motion_curve.h"

namespace reprise {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double degree = std::numbers::pi / 180.0;

// Joints of a young woman of 1.6 m in an A-pose, all lengths times `size`.
Skeleton performer_skeleton(double size = 1.0) {
  Skeleton skeleton;
  const auto add = [&](const std::string& name, int parent, double x, double y, double z) {
    skeleton.joints.push_back({name, parent, size * Vector3d(x, y, z)});
    return skeleton.size() - 1;
  };
  const int pelvis = add("pelvis", -1, 0, .8389, .0173);
  const int spine = add("spine", pelvis, 0, .923, -.0221);
  const int chest = add("chest", spine, 0, 1.0775, .0122);
  const int neck = add("neck", chest, 0, 1.3755, -.0012);
  add("head", neck, 0, 1.4872, .0407);
  for (const std::string side : {"left_", "right_"}) {
    const double s = side == "left_" ? 1.0 : -1.0;
    const int collar = add(side + "collar", chest, s * .0229, 1.307, .0214);
    const int upper_arm = add(side + "upper_arm", collar, s * .1554, 1.292, .0209);
    const int forearm = add(side + "forearm", upper_arm, s * .3134, 1.1191, .0248);
    add(side + "hand", forearm, s * .4238, .9983, .1608);
    const int thigh = add(side + "thigh", pelvis, s * .0955, .8389, .0173);
    const int shin = add(side + "shin", thigh, s * .1354, .4667, .0479);
    const int foot = add(side + "foot", shin, s * .1661, .0859, .0297);
    add(side + "toe", foot, s * .1651, .0414, .1546);
  }
  return skeleton;
}

const std::vector<std::string> sets = {"character", "fashion1", "fashion2"};

const std::vector<PerformerClip>& clips_of(const std::string& set) {
  static std::map<std::string, std::vector<PerformerClip>> all;
  if (!all.contains(set)) all[set] = performer_clips(set, performer_skeleton());
  return all[set];
}

const PerformerClip& clip_of(const std::string& set, const std::string& name) {
  for (const PerformerClip& clip : clips_of(set))
    if (clip.motion.name == name) return clip;
  throw InvalidArgument("no clip " + name);
}

int frame_count(const PerformerClip& clip) {
  return static_cast<int>(clip.motion.frames.size()) - clip.lead_in;
}

const SkeletonPose& frame(const PerformerClip& clip, int frame_idx) {
  return clip.motion.frames[static_cast<std::size_t>(clip.lead_in + frame_idx)];
}

Vector3d place(const Skeleton& skeleton, const SkeletonPose& pose, const std::string& joint,
               const Vector3d& rest_point) {
  return pose.world_from_rest(skeleton, skeleton.joint_idx(joint)) * rest_point;
}

// Where heel, ball and tip of a foot's sole are.
struct Sole {
  Vector3d heel, ball, tip;
};
Sole sole(const Skeleton& skeleton, const SkeletonPose& pose, int side) {
  const motion::FootShape shape = motion::foot_shape(skeleton, side);
  const std::string prefix = side == 0 ? "left_" : "right_";
  const Vector3d under_ball(shape.ball.x(), 0.0, shape.ball.z());
  return {.heel = place(skeleton, pose, prefix + "foot", shape.heel),
          .ball = place(skeleton, pose, prefix + "toe", under_ball),
          .tip = place(skeleton, pose, prefix + "toe", shape.toe_tip)};
}

template <typename Test>
void for_each_clip(const Test& test) {
  for (const std::string& set : sets) {
    for (const PerformerClip& clip : clips_of(set)) {
      SCOPED_TRACE(set + " " + clip.motion.name);
      test(clip);
    }
  }
}

// Mean distance of joints, metres, between two poses that are first laid over one another: yaw and place of
// the hips.
double distance(const Skeleton& skeleton, const SkeletonPose& a, const SkeletonPose& b) {
  const auto left = static_cast<std::size_t>(skeleton.joint_idx("left_thigh"));
  const auto right = static_cast<std::size_t>(skeleton.joint_idx("right_thigh"));
  const auto frame = [&](const SkeletonPose& pose) {
    const Vector3d across = pose.position[left] - pose.position[right];
    Eigen::Isometry3d M = Eigen::Isometry3d::Identity();
    M.linear() = Eigen::AngleAxisd(std::atan2(-across.z(), across.x()), Vector3d::UnitY()).toRotationMatrix();
    const Vector3d middle = 0.5 * (pose.position[left] + pose.position[right]);
    M.translation() = Vector3d(middle.x(), 0.0, middle.z());
    return M;
  };
  const Eigen::Isometry3d a_from_b = frame(a) * frame(b).inverse();
  double sum = 0.0;
  for (std::size_t j = 0; j < a.position.size(); ++j)
    sum += (a.position[j] - a_from_b * b.position[j]).norm();
  return sum / static_cast<double>(a.position.size());
}

TEST(PerformerMotion, SetsHaveTheClipsAndSizesOfThePaper) {
  const auto sizes = [](const std::string& set) {
    std::map<std::string, int> result;
    for (const PerformerClip& clip : clips_of(set)) result[clip.motion.name] = frame_count(clip);
    return result;
  };
  const auto total = [](const std::map<std::string, int>& counts) {
    int sum = 0;
    for (const auto& [name, count] : counts) sum += count;
    return sum;
  };
  const auto names = [](const std::map<std::string, int>& counts) {
    std::vector<std::string> result;
    for (const auto& [name, count] : counts) result.push_back(name);
    return result;
  };
  const auto character = sizes("character"), first = sizes("fashion1"), second = sizes("fashion2");
  EXPECT_EQ(names(character),
            (std::vector<std::string>{"hit", "jog", "jog_walk", "stagger", "stand", "stand_walk", "tense",
                                      "walk", "walk_jog", "walk_stand"}));
  const std::vector<std::string> fashion = {"pose", "pose_twirl", "pose_walk", "twirl", "walk", "walk_pose"};
  EXPECT_EQ(names(first), fashion);
  EXPECT_EQ(names(second), fashion);
  EXPECT_EQ(total(character), 442);
  EXPECT_EQ(total(first), 491);
  EXPECT_EQ(total(second), 435);
  // Key-frames of the paper's examples, with a frame to spare on either side.
  EXPECT_GT(character.at("hit"), 46);
  EXPECT_GT(character.at("walk"), 17);
  EXPECT_GT(character.at("jog"), 14);
  EXPECT_GT(first.at("twirl"), 86);
  EXPECT_GT(second.at("twirl"), 101);
  EXPECT_GT(first.at("walk_pose"), 38);
}

TEST(PerformerMotion, BeginsAtTheOriginAlongZAfterALeadIn) {
  for_each_clip([](const PerformerClip& clip) {
    const Skeleton& skeleton = clip.motion.skeleton;
    EXPECT_EQ(clip.lead_in, 38);
    EXPECT_EQ(clip.contacts.size(), clip.motion.frames.size());
    EXPECT_EQ(clip.motion.frames_per_second, 25.0);
    const SkeletonPose& first = frame(clip, 0);
    Vector3d hips = Vector3d::Zero();
    for (const char* joint : {"left_thigh", "right_thigh"})
      hips += 0.5 * first.position[static_cast<std::size_t>(skeleton.joint_idx(joint))];
    EXPECT_LT(std::hypot(hips.x(), hips.z()), 0.005);
    const Vector3d ahead =
        first.rotation[static_cast<std::size_t>(skeleton.joint_idx("pelvis"))] * Vector3d::UnitZ();
    EXPECT_GT(ahead.z(), std::cos(35.0 * degree));
  });
}

TEST(PerformerMotion, FeetStayWhereTheyStand) {
  double worst = 0.0;
  for_each_clip([&](const PerformerClip& clip) {
    const Skeleton& skeleton = clip.motion.skeleton;
    const double rate = clip.motion.frames_per_second;
    constexpr double low = 0.0005;  // metres: on the ground
    for (int side = 0; side < 2; ++side) {
      int stood = 0;
      for (std::size_t k = 1; k < clip.motion.frames.size(); ++k) {
        const auto s = static_cast<std::size_t>(side);
        const Sole before = sole(skeleton, clip.motion.frames[k - 1], side);
        const Sole now = sole(skeleton, clip.motion.frames[k], side);
        const bool heel = before.heel.y() < low && now.heel.y() < low;
        const bool ball = before.ball.y() < low && now.ball.y() < low;
        if (clip.contacts[k][s]) {
          EXPECT_LT(std::min(now.heel.y(), now.ball.y()), low) << "frame " << k;
          EXPECT_GT(std::min(now.heel.y(), now.ball.y()), -1e-6) << "frame " << k;
        }
        if (!clip.contacts[k - 1][s] || !clip.contacts[k][s]) continue;
        ++stood;
        // What is on the ground does not slide: heel and ball on their own.
        const auto drift = [&](const Vector3d& from, const Vector3d& to) {
          worst = std::max(worst, rate * std::hypot(to.x() - from.x(), to.z() - from.z()));
        };
        if (heel) drift(before.heel, now.heel);
        if (ball) drift(before.ball, now.ball);
      }
      EXPECT_GT(stood, 10);
    }
  });
  EXPECT_LT(worst, 0.005) << "metres per second";
  RecordProperty("drift_mm_per_s", std::to_string(1000.0 * worst));
}

TEST(PerformerMotion, SolesStayAboveTheFloor) {
  double lowest = 1.0;
  for_each_clip([&](const PerformerClip& clip) {
    for (const SkeletonPose& pose : clip.motion.frames) {
      for (int side = 0; side < 2; ++side) {
        const Sole s = sole(clip.motion.skeleton, pose, side);
        lowest = std::min({lowest, s.heel.y(), s.ball.y(), s.tip.y()});
        EXPECT_GT(std::min({s.heel.y(), s.ball.y(), s.tip.y()}), -0.002);
      }
    }
  });
  RecordProperty("lowest_mm", std::to_string(1000.0 * lowest));
}

TEST(PerformerMotion, SomebodyStandsUnlessRunning) {
  for_each_clip([](const PerformerClip& clip) {
    const bool runs = clip.motion.name.find("jog") != std::string::npos;
    int flying = 0;
    for (const FootContacts& contact : clip.contacts) flying += !contact[0] && !contact[1] ? 1 : 0;
    if (runs) {
      EXPECT_GT(flying, 0);
    } else {
      EXPECT_EQ(flying, 0);
    }
  });
}

TEST(PerformerMotion, PosesAreForwardKinematicsOfTheSkeleton) {
  for_each_clip([](const PerformerClip& clip) {
    const Skeleton& skeleton = clip.motion.skeleton;
    for (std::size_t k = 0; k < clip.motion.frames.size(); k += 7) {
      const SkeletonPose& pose = clip.motion.frames[k];
      const SkeletonPose expected = pose_from_rotations(skeleton, pose.rotation, pose.position[0]);
      for (std::size_t j = 0; j < pose.position.size(); ++j) {
        EXPECT_LT((pose.position[j] - expected.position[j]).norm(), 1e-9);
        EXPECT_NEAR(pose.rotation[j].norm(), 1.0, 1e-9);
      }
    }
  });
}

TEST(PerformerMotion, KneesAndElbowsBendTheirWay) {
  for_each_clip([](const PerformerClip& clip) {
    const Skeleton& skeleton = clip.motion.skeleton;
    for (const SkeletonPose& pose : clip.motion.frames) {
      for (const std::string side : {"left_", "right_"}) {
        const auto at = [&](const std::string& joint) {
          return pose.position[static_cast<std::size_t>(skeleton.joint_idx(side + joint))];
        };
        const auto turned = [&](const std::string& joint) {
          return pose.rotation[static_cast<std::size_t>(skeleton.joint_idx(side + joint))];
        };
        const Vector3d thigh = (at("shin") - at("thigh")).normalized();
        const Vector3d shin = (at("foot") - at("shin")).normalized();
        // Never straight, never bent to the front: the knee lies before the line from hip to ankle, on the
        // side where the foot points.
        EXPECT_LT(thigh.dot(shin), std::cos(3.0 * degree));
        const Vector3d toes = turned("foot") * Vector3d::UnitX();
        EXPECT_GT(thigh.cross(shin).normalized().dot(toes), std::cos(55.0 * degree));
        // The thigh does not twist out of its socket against the shin.
        EXPECT_LT(turned("thigh").angularDistance(turned("shin")), 130.0 * degree);
        const Vector3d upper = (at("forearm") - at("upper_arm")).normalized();
        const Vector3d lower = (at("hand") - at("forearm")).normalized();
        EXPECT_GT(std::acos(std::clamp(upper.dot(lower), -1.0, 1.0)), 4.0 * degree);
      }
    }
  });
}

TEST(PerformerMotion, MovesSmoothly) {
  double fastest = 0.0, hardest = 0.0;
  for_each_clip([&](const PerformerClip& clip) {
    const auto& frames = clip.motion.frames;
    const double rate = clip.motion.frames_per_second;
    for (std::size_t k = 2; k < frames.size(); ++k) {
      for (std::size_t j = 0; j < frames[k].position.size(); ++j) {
        const double turned = frames[k].rotation[j].angularDistance(frames[k - 1].rotation[j]);
        fastest = std::max(fastest, turned);
        EXPECT_LT(turned, 55.0 * degree) << clip.motion.skeleton.joints[j].name << " frame " << k;
        const double acceleration =
            rate * rate *
            (frames[k].position[j] - 2.0 * frames[k - 1].position[j] + frames[k - 2].position[j]).norm();
        hardest = std::max(hardest, acceleration);
        EXPECT_LT(acceleration, 130.0) << clip.motion.skeleton.joints[j].name << " frame " << k;
      }
    }
  });
  RecordProperty("fastest_degrees_a_frame", std::to_string(fastest / degree));
  RecordProperty("hardest_m_per_s2", std::to_string(hardest));
}

// Sampled ever more finely, velocities of neighbouring samples come together: there are no jumps.
TEST(PerformerMotion, HasNoJumpsBetweenFrames) {
  for (const std::string& set : sets) {
    const auto fine = performer_clips(set, performer_skeleton(), 400.0);
    for (const PerformerClip& clip : fine) {
      SCOPED_TRACE(set + " " + clip.motion.name);
      double worst = 0.0;
      std::string where;
      for (std::size_t k = 2; k < clip.motion.frames.size(); ++k) {
        const auto& a = clip.motion.frames[k - 2].position;
        const auto& b = clip.motion.frames[k - 1].position;
        const auto& c = clip.motion.frames[k].position;
        for (std::size_t j = 0; j < a.size(); ++j)
          if (const double jump = (400.0 * ((c[j] - b[j]) - (b[j] - a[j]))).norm(); jump > worst) {
            worst = jump;
            where = fmt::format("{} at {:.3f} s", clip.motion.skeleton.joints[j].name,
                                (static_cast<double>(k) - clip.lead_in) / 400.0);
          }
      }
      // Where walking becomes jogging and back, a knee stops quickly just before its foot lands.
      const bool changes_gait = clip.motion.name == "walk_jog" || clip.motion.name == "jog_walk";
      EXPECT_LT(worst, changes_gait ? 3.5 : 1.0)
          << "metres per second from one 1/400 s to the next, " << where;
    }
  }
}

TEST(PerformerMotion, LoopsClose) {
  // The frame after the last one would be the first: its distance is that of neighbouring frames.
  const std::vector<std::array<std::string, 2>> loops = {
      {"character", "stand"}, {"character", "walk"}, {"character", "jog"}, {"character", "tense"},
      {"fashion1", "pose"},   {"fashion1", "walk"},  {"fashion2", "pose"}, {"fashion2", "walk"}};
  for (const auto& [set, name] : loops) {
    SCOPED_TRACE(set + " " + name);
    const PerformerClip& clip = clip_of(set, name);
    const Skeleton& skeleton = clip.motion.skeleton;
    const int count = frame_count(clip);
    double step = 0.0;
    for (int k = 1; k < count; ++k)
      step = std::max(step, distance(skeleton, frame(clip, k - 1), frame(clip, k)));
    EXPECT_LT(distance(skeleton, frame(clip, count - 1), frame(clip, 0)), 1.5 * step + 0.002);
  }
}

TEST(PerformerMotion, TransitionsJoinTheirClips) {
  const auto nearest = [](const PerformerClip& clip, int frame_idx, const PerformerClip& other) {
    double best = 1.0;
    for (int k = 0; k < frame_count(other); ++k)
      best = std::min(best, distance(clip.motion.skeleton, frame(clip, frame_idx), frame(other, k)));
    return best;
  };
  const auto joins = [&](const std::string& set, const std::string& from, const std::string& to) {
    SCOPED_TRACE(set + " " + from + "_" + to);
    const PerformerClip& clip = clip_of(set, from + "_" + to);
    for (const int k : {0, 2}) EXPECT_LT(nearest(clip, k, clip_of(set, from)), 0.02) << "from, frame " << k;
    for (const int k : {1, 3})
      EXPECT_LT(nearest(clip, frame_count(clip) - k, clip_of(set, to)), 0.02) << "to, frame -" << k;
  };
  joins("character", "stand", "walk");
  joins("character", "walk", "stand");
  joins("character", "walk", "jog");
  joins("character", "jog", "walk");
  for (const std::string set : {"fashion1", "fashion2"}) {
    joins(set, "pose", "walk");
    joins(set, "walk", "pose");
    joins(set, "pose", "twirl");
  }
  // Actions leave standing and come back to it.
  for (const std::string action : {"hit", "stagger"}) {
    const PerformerClip& clip = clip_of("character", action);
    EXPECT_LT(nearest(clip, 0, clip_of("character", "stand")), 0.02) << action;
    EXPECT_LT(nearest(clip, frame_count(clip) - 1, clip_of("character", "stand")), 0.02) << action;
  }
}

TEST(PerformerMotion, GaitsHaveTheirSpeedsAndArmsSwingAgainstLegs) {
  const auto speed = [](const PerformerClip& clip) {
    const auto travelled = frame(clip, frame_count(clip) - 1).position[0] - frame(clip, 0).position[0];
    return travelled.z() / (frame_count(clip) - 1) * 25.0;
  };
  EXPECT_NEAR(speed(clip_of("character", "walk")), 1.3, 0.06);
  EXPECT_NEAR(speed(clip_of("character", "jog")), 2.6, 0.1);
  EXPECT_GT(speed(clip_of("fashion2", "walk")), speed(clip_of("fashion1", "walk")) + 0.15);
  for (const char* name : {"walk", "jog"}) {
    const PerformerClip& clip = clip_of("character", name);
    const auto forward = [&](int k, const char* joint, const char* parent) {
      const Skeleton& skeleton = clip.motion.skeleton;
      return (frame(clip, k).position[static_cast<std::size_t>(skeleton.joint_idx(joint))] -
              frame(clip, k).position[static_cast<std::size_t>(skeleton.joint_idx(parent))])
          .z();
    };
    double correlation = 0.0;
    for (int k = 0; k < frame_count(clip); ++k) {
      const double legs = forward(k, "left_foot", "left_thigh") - forward(k, "right_foot", "right_thigh");
      const double arms =
          forward(k, "left_forearm", "left_upper_arm") - forward(k, "right_forearm", "right_upper_arm");
      correlation += legs * arms;
    }
    EXPECT_LT(correlation, 0.0) << name;
  }
}

// Nobody kneels in the middle of a run-up: where the gait changes, the hips stay about as high as they are in
// the gaits it changes between.
TEST(PerformerMotion, HipsStayUpWhileTheGaitChanges) {
  const auto heights = [](const std::string& name) {
    const PerformerClip& clip = clip_of("character", name);
    std::vector<double> result;
    for (int k = 0; k < frame_count(clip); ++k) result.push_back(frame(clip, k).position[0].y());
    return result;
  };
  const double lowest = std::min(std::ranges::min(heights("walk")), std::ranges::min(heights("jog"))) - 0.07;
  const double highest = std::max(std::ranges::max(heights("walk")), std::ranges::max(heights("jog"))) + 0.03;
  for (const char* name : {"walk_jog", "jog_walk", "stand_walk", "walk_stand"}) {
    EXPECT_GT(std::ranges::min(heights(name)), lowest) << name;
    EXPECT_LT(std::ranges::max(heights(name)), highest) << name;
  }
}

// The knees of the walk follow the textbook's curve, although they come from inverse kinematics.
TEST(PerformerMotion, WalkingKneesFollowWinter) {
  const PerformerClip& clip = clip_of("character", "walk");
  const Skeleton& skeleton = clip.motion.skeleton;
  const auto flexion = [&](int k) {
    const auto at = [&](const char* joint) {
      return frame(clip, k).position[static_cast<std::size_t>(skeleton.joint_idx(joint))];
    };
    const Vector3d thigh = (at("left_shin") - at("left_thigh")).normalized();
    const Vector3d shin = (at("left_foot") - at("left_shin")).normalized();
    return std::acos(std::clamp(thigh.dot(shin), -1.0, 1.0)) / degree;
  };
  // Extremes of the cycle, 26 frames from the left foot's strike (Winter 2009): about 18 degrees in loading,
  // 5 in late stance, 62 in swing; a straight leg's joints are 5 degrees off a line.
  double loading = 0.0, stance = 90.0, swing = 0.0;
  for (int k = 1; k < 7; ++k) loading = std::max(loading, flexion(k));
  for (int k = 7; k < 13; ++k) stance = std::min(stance, flexion(k));
  for (int k = 14; k < 25; ++k) swing = std::max(swing, flexion(k));
  EXPECT_NEAR(loading - 5.0, 18.0, 6.0);
  EXPECT_NEAR(stance - 5.0, 5.0, 6.0);
  EXPECT_NEAR(swing - 5.0, 62.0, 8.0);
}

TEST(PerformerMotion, TwirlTurnsRoundOnce) {
  for (const auto& [set, turns] : {std::pair<std::string, double>{"fashion1", 1.0}, {"fashion2", 2.0}}) {
    const PerformerClip& clip = clip_of(set, "twirl");
    const auto chest = static_cast<std::size_t>(clip.motion.skeleton.joint_idx("chest"));
    double turned = 0.0;
    double fastest = 0.0;
    for (int k = 1; k < frame_count(clip); ++k) {
      const Vector3d a = frame(clip, k - 1).rotation[chest] * Vector3d::UnitZ();
      const Vector3d b = frame(clip, k).rotation[chest] * Vector3d::UnitZ();
      const double step = std::atan2(a.z() * b.x() - a.x() * b.z(), a.x() * b.x() + a.z() * b.z());
      turned += step;
      fastest = std::max(fastest, step);
    }
    EXPECT_NEAR(turned / (2.0 * std::numbers::pi), turns, 0.05) << set;
    EXPECT_GT(25.0 * fastest / degree, 330.0) << set;
  }
}

TEST(PerformerMotion, IsDeterministic) {
  const auto again = performer_clips("fashion2", performer_skeleton());
  const auto& first = clips_of("fashion2");
  ASSERT_EQ(again.size(), first.size());
  for (std::size_t c = 0; c < again.size(); ++c) {
    EXPECT_EQ(again[c].contacts, first[c].contacts);
    for (std::size_t k = 0; k < again[c].motion.frames.size(); ++k)
      EXPECT_EQ(again[c].motion.frames[k].position, first[c].motion.frames[k].position);
  }
}

// A performer of twice the size does the same, twice as large.
TEST(PerformerMotion, ScalesWithTheLegs) {
  const auto large = performer_clips("character", performer_skeleton(1.25));
  const auto& plain = clips_of("character");
  for (std::size_t c = 0; c < large.size(); ++c) {
    // Balance depends on gravity, which does not grow: a few per cent.
    const auto path = [](const PerformerClip& clip) {
      return Vector3d(frame(clip, frame_count(clip) - 1).position[0] - frame(clip, 0).position[0]);
    };
    EXPECT_LT((path(large[c]) - 1.25 * path(plain[c])).norm(), 0.03) << large[c].motion.name;
    for (std::size_t k = 0; k < large[c].motion.frames.size(); k += 5) {
      for (int side = 0; side < 2; ++side) {
        const Sole s = sole(large[c].motion.skeleton, large[c].motion.frames[k], side);
        EXPECT_GT(std::min({s.heel.y(), s.ball.y(), s.tip.y()}), -0.002);
      }
    }
  }
}

TEST(PerformerMotion, OtherRatesShowTheSameMotion) {
  const auto fine = performer_clips("fashion1", performer_skeleton(), 50.0);
  const auto& plain = clips_of("fashion1");
  for (std::size_t c = 0; c < fine.size(); ++c) {
    EXPECT_EQ(frame_count(fine[c]), 2 * frame_count(plain[c]));
    for (int k = 0; k < frame_count(plain[c]); ++k) {
      for (std::size_t j = 0; j < 21; ++j)
        EXPECT_LT((frame(fine[c], 2 * k).position[j] - frame(plain[c], k).position[j]).norm(), 1e-9);
    }
  }
}

TEST(PerformerMotion, RefusesWhatItDoesNotKnow) {
  EXPECT_THROW(performer_clips("ballet", performer_skeleton()), InvalidArgument);
  EXPECT_THROW(performer_clips("character", performer_skeleton(), 0.0), InvalidArgument);
  EXPECT_THROW(performer_clips("character", performer_skeleton(), std::nan("")), InvalidArgument);
  Skeleton armless = performer_skeleton();
  armless.joints[armless.joint_idx("left_hand")].name = "left_hook";
  EXPECT_THROW(performer_clips("character", armless), InvalidArgument);
}

}  // namespace
}  // namespace reprise
