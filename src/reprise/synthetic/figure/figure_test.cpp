// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/figure/figure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/synthetic/figure/figure_skin.h"
#include "reprise/synthetic/figure/figure_surface.h"

namespace reprise {
namespace {

using Eigen::Vector3d;

const PerformanceDatabase& performer() {
  static const PerformanceDatabase database = make_figure();
  return database;
}

// What `performer()` was made of: same vertices.
const figure::Body& body() {
  static const figure::Body made = figure::make_body(FigureOptions{}.voxel_size);
  return made;
}

figure::Motion motion_of(const std::string& name) {
  for (const figure::ClipPlan& plan : figure::clip_plans()) {
    if (plan.name == name) return figure::Motion(plan);
  }
  throw std::out_of_range(name);
}

const MeshSequence& clip_of(const std::string& name) {
  return performer().clip(performer().clip_idx(name));
}

std::vector<Vector3d> skinned(const figure::Pose& pose) {
  const figure::Skin skin(body(), pose);
  std::vector<Vector3d> points;
  for (std::size_t v = 0; v < body().points.size(); ++v) points.push_back(skin(v));
  return points;
}

TEST(Figure, SurfaceIsOneClosedManifoldWithoutHandles) {
  const Topology& topology = *performer().topology();
  validate(topology);
  std::map<std::pair<int, int>, int> uses;
  for (const Triangle& t : topology.triangles) {
    for (int k = 0; k < 3; ++k) ++uses[{t[k], t[(k + 1) % 3]}];
  }
  for (const auto& [edge, count] : uses) {
    ASSERT_EQ(count, 1);
    ASSERT_EQ(uses.count({edge.second, edge.first}), 1u);
  }
  const auto edges = static_cast<std::int64_t>(uses.size() / 2);
  EXPECT_EQ(topology.vertex_count - edges + static_cast<std::int64_t>(topology.triangles.size()), 2);
  EXPECT_EQ(connected_components(topology).count, 1);
  EXPECT_GE(topology.vertex_count, 4000);
  EXPECT_LE(topology.vertex_count, 6000);
}

TEST(Figure, RestSurfaceFacesOutwardsWithEvenTriangles) {
  const Topology& topology = *body().topology;
  const std::vector<Vector3d>& points = body().points;
  std::vector<Vector3d> normals(points.size(), Vector3d::Zero());
  double six_volumes = 0.0;
  double sum = 0.0;
  double squares = 0.0;
  for (const Triangle& t : topology.triangles) {
    six_volumes += points[t[0]].dot(points[t[1]].cross(points[t[2]]));
    const Vector3d normal = (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
    for (int k = 0; k < 3; ++k) {
      normals[t[k]] += normal;
      const double length = (points[t[k]] - points[t[(k + 1) % 3]]).norm();
      sum += length;
      squares += length * length;
    }
  }
  // A slim person of 1.75 m.
  EXPECT_GT(six_volumes / 6.0, 0.04);
  EXPECT_LT(six_volumes / 6.0, 0.09);
  const double count = 3.0 * static_cast<double>(topology.triangles.size());
  const double mean = sum / count;
  const double variation = std::sqrt(squares / count - mean * mean) / mean;
  RecordProperty("edge_variation", std::to_string(variation));
  EXPECT_LT(variation, 0.3);
  std::size_t inverted = 0;
  for (const Triangle& t : topology.triangles) {
    const Vector3d normal = (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
    if (normal.dot(normals[t[0]] + normals[t[1]] + normals[t[2]]) <= 0.0) ++inverted;
  }
  EXPECT_EQ(inverted, 0u);
}

TEST(Figure, HasTheStatedClipsOnOneTopologyWithColors) {
  const std::vector<std::string> expected = {"stand",    "walk",  "walk_curve", "jog", "walk_jog",
                                             "jog_walk", "start", "stop",       "wave"};
  EXPECT_EQ(performer().clip_names(), expected);
  for (const MeshSequence& clip : performer().clips()) {
    EXPECT_EQ(clip.topology(), performer().topology());
    EXPECT_TRUE(clip.has_colors());
    EXPECT_GE(clip.frame_count(), 50u);
    EXPECT_LE(clip.frame_count(), 75u);
    for (std::size_t f = 0; f < clip.frame_count(); ++f) {
      ASSERT_EQ(degeneracy(*clip.topology(), clip.frame(f)), "") << clip.name() << ":" << f;
    }
  }
}

TEST(Figure, PlantedSolesStayWhereTheyAre) {
  for (const MeshSequence& clip : performer().clips()) {
    const figure::Motion motion = motion_of(clip.name());
    const double fps = clip.frames_per_second();
    double fastest = 0.0;
    std::size_t measured = 0;
    for (std::size_t f = 0; f + 1 < clip.frame_count(); ++f) {
      for (int side = 0; side < 2; ++side) {
        if (!motion.flat_footed(side, static_cast<double>(f) / fps) ||
            !motion.flat_footed(side, static_cast<double>(f + 1) / fps)) {
          continue;
        }
        const PositionsView now = clip.frame(f);
        const PositionsView next = clip.frame(f + 1);
        for (Eigen::Index v = 0; v < now.rows(); ++v) {
          const Vector3d& rest = body().points[static_cast<std::size_t>(v)];
          if (rest.y() > 0.004 || rest.x() * figure::side_sign(side) < 0.0) continue;
          ++measured;
          fastest = std::max(fastest, fps * static_cast<double>((next.row(v) - now.row(v)).norm()));
        }
      }
    }
    EXPECT_GT(measured, 100u) << clip.name();
    EXPECT_LT(fastest, 0.01) << clip.name();  // m/s
  }
}

TEST(Figure, NothingSinksIntoTheGroundAndSomethingTouchesItUnlessItJogs) {
  for (const MeshSequence& clip : performer().clips()) {
    const bool flies = clip.name().find("jog") != std::string::npos;
    float lowest = 1.0F;
    float highest = 0.0F;  // of the lowest point of a frame
    for (std::size_t f = 0; f < clip.frame_count(); ++f) {
      const float bottom = clip.frame(f).col(1).minCoeff();
      lowest = std::min(lowest, bottom);
      highest = std::max(highest, bottom);
    }
    EXPECT_GT(lowest, -0.005F) << clip.name();
    if (flies) {
      EXPECT_GT(highest, 0.01F) << clip.name();
    } else {
      EXPECT_LT(highest, 0.005F) << clip.name();
    }
  }
}

TEST(Figure, WalksAndJogsAtTheirSpeeds) {
  const std::vector<std::pair<std::string, double>> speeds = {
      {"stand", 0.0}, {"walk", 1.35}, {"jog", 2.6}, {"wave", 0.0}};
  for (const auto& [name, speed] : speeds) {
    const MeshSequence& clip = clip_of(name);
    const std::vector<Eigen::Vector2d> at = ground_trajectory(clip);
    const double time = static_cast<double>(clip.frame_count() - 1) / clip.frames_per_second();
    EXPECT_NEAR((at.back().y() - at.front().y()) / time, speed, 0.04) << name;
    EXPECT_NEAR(at.back().x(), at.front().x(), 0.05) << name;
  }
  // The curve leads to the left, by about a radian.
  EXPECT_NEAR(motion_of("walk_curve").path(motion_of("walk_curve").plan().duration).yaw, 1.0, 0.2);
}

TEST(Figure, LoopsContinueWhereTheyBegan) {
  for (const std::string name : {"stand", "walk", "jog"}) {
    const figure::Motion motion = motion_of(name);
    const double end = motion.plan().duration;
    const std::vector<Vector3d> first = skinned(motion.pose(0.0));
    const std::vector<Vector3d> after_last = skinned(motion.pose(end));
    const GroundTransform end_from_begin = motion.path(end) * motion.path(0.0).inverse();
    for (std::size_t v = 0; v < first.size(); ++v) {
      ASSERT_LT((end_from_begin * first[v] - after_last[v]).norm(), 1e-3) << name;
    }
  }
}

TEST(Figure, ClipsMeetInSimilarPoses) {
  // Mean distance of the nearest pair of frames after alignment of the paths, metres.
  const auto nearest = [](const std::string& from, const std::string& to) {
    const MeshSequence& a = clip_of(from);
    const MeshSequence& b = clip_of(to);
    const figure::Motion motion_a = motion_of(from);
    const figure::Motion motion_b = motion_of(to);
    double best = 1.0;
    for (std::size_t i = 0; i < a.frame_count(); ++i) {
      const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> p = a.frame(i);
      const GroundTransform at_a = motion_a.path(static_cast<double>(i) / a.frames_per_second());
      for (std::size_t j = 0; j < b.frame_count(); ++j) {
        const GroundTransform a_from_b =
            at_a * motion_b.path(static_cast<double>(j) / b.frames_per_second()).inverse();
        const PositionsView q = b.frame(j);
        double sum = 0.0;
        int count = 0;
        for (Eigen::Index v = 0; v < p.rows(); v += 50) {
          sum +=
              (p.row(v).transpose().cast<double>() - a_from_b * Vector3d(q.row(v).transpose().cast<double>()))
                  .norm();
          ++count;
        }
        best = std::min(best, sum / count);
      }
    }
    return best;
  };
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{{"stand", "start"},
                                                                                 {"start", "walk"},
                                                                                 {"walk", "stop"},
                                                                                 {"stop", "stand"},
                                                                                 {"walk", "walk_curve"},
                                                                                 {"walk", "walk_jog"},
                                                                                 {"walk_jog", "jog"},
                                                                                 {"jog", "jog_walk"},
                                                                                 {"jog_walk", "walk"},
                                                                                 {"stand", "wave"}}) {
    EXPECT_LT(nearest(from, to), 0.015) << from << " to " << to;
  }
}

TEST(Figure, MotionHasNoPops) {
  for (const MeshSequence& clip : performer().clips()) {
    const double fps = clip.frames_per_second();
    const bool jogs = clip.name().find("jog") != std::string::npos;
    double peak = 0.0;
    for (std::size_t f = 1; f + 1 < clip.frame_count(); ++f) {
      const auto acceleration =
          (clip.frame(f + 1) - 2.0F * clip.frame(f) + clip.frame(f - 1)).rowwise().norm();
      peak = std::max(peak, fps * fps * static_cast<double>(acceleration.maxCoeff()));
    }
    RecordProperty("peak_" + clip.name(), std::to_string(peak));
    EXPECT_LT(peak, jogs ? 100.0 : 60.0) << clip.name();  // m/s^2; feet reach about 40 and 80
  }
}

TEST(Figure, HemLagsBehindTheHips) {
  // How far the hem turns about the body, and how far the skin alone would turn it.
  const figure::Motion motion = motion_of("walk");
  const MeshSequence& clip = clip_of("walk");
  std::vector<double> shown;
  std::vector<double> held;
  for (std::size_t f = 0; f < clip.frame_count(); ++f) {
    const figure::Skin skin(body(), motion.pose(static_cast<double>(f) / clip.frames_per_second()));
    double x = 0.0;
    double skin_x = 0.0;
    double count = 0.0;
    for (std::size_t v = 0; v < body().points.size(); ++v) {
      if (body().hem[v] < 0.9) continue;
      x += static_cast<double>(clip.frame(f)(static_cast<Eigen::Index>(v), 0));
      skin_x += skin(v).x();
      count += 1.0;
    }
    shown.push_back(x / count);
    held.push_back(skin_x / count);
  }
  // Correlation over two whole cycles of 24 frames, so that the mean of each does not depend on the lag.
  const auto correlation = [&](int lag) {
    double sum = 0.0;
    for (int f = 12; f < 60; ++f)
      sum += shown[static_cast<std::size_t>(f + lag)] * held[static_cast<std::size_t>(f)];
    return sum;
  };
  int best = -8;
  for (int lag = -8; lag <= 8; ++lag) {
    if (correlation(lag) > correlation(best)) best = lag;
  }
  EXPECT_GE(best, 1);
  EXPECT_LE(best, 5);
}

TEST(Figure, SameBytesOnEveryRunAndNumberOfThreads) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(make_figure().content_hash(), performer().content_hash());
}

TEST(Figure, HeightScalesEverything) {
  const PerformanceDatabase small =
      make_figure({.height = 0.875, .voxel_size = 0.5 * FigureOptions{}.voxel_size});
  ASSERT_EQ(small.topology()->vertex_count, performer().topology()->vertex_count);
  const MeshSequence& clip = small.clip(small.clip_idx("jog"));
  EXPECT_LT((2.0F * clip.frame(30) - clip_of("jog").frame(30)).cwiseAbs().maxCoeff(), 1e-5F);
  EXPECT_NEAR(clip_of("stand").frame(0).col(1).maxCoeff(), FigureOptions{}.height, 0.02);
}

TEST(Figure, RateSamplesTheSameMotion) {
  const PerformanceDatabase fast = make_figure({.frames_per_second = 50.0});
  const MeshSequence& clip = fast.clip(fast.clip_idx("walk"));
  EXPECT_EQ(clip.frame_count(), 2 * clip_of("walk").frame_count());
  // The simulated hem may differ by its step; nothing else does.
  EXPECT_LT((clip.frame(60) - clip_of("walk").frame(30)).cwiseAbs().maxCoeff(), 2e-3F);
}

TEST(Figure, BadOptionsAreNamed) {
  EXPECT_THROW(make_figure({.frames_per_second = 0.0}), InvalidArgument);
  EXPECT_THROW(make_figure({.frames_per_second = std::nan("")}), InvalidArgument);
  EXPECT_THROW(make_figure({.height = -1.0}), InvalidArgument);
  EXPECT_THROW(make_figure({.voxel_size = 1.0}), InvalidArgument);
  EXPECT_THROW(make_figure({.voxel_size = 0.0}), InvalidArgument);
}

TEST(Figure, SurfaceWithAHandleIsRefused) {
  const auto torus = [](const Vector3d& p) {
    return std::hypot(std::hypot(p.x(), p.z()) - 0.3, p.y()) - 0.1;
  };
  const auto sphere = [](const Vector3d& p) { return p.norm() - 0.3; };
  const Eigen::AlignedBox3d box(Vector3d::Constant(-0.5), Vector3d::Constant(0.5));
  EXPECT_THROW(figure::surface_from_distance(torus, box, 0.02, {}), InvalidArgument);
  const figure::Surface surface = figure::surface_from_distance(sphere, box, 0.02, {Vector3d(0.0, 0.0, 0.3)});
  double off = 0.0;
  double to_pin = 1.0;
  for (const Vector3d& point : surface.points) {
    off = std::max(off, std::abs(sphere(point)));
    to_pin = std::min(to_pin, (point - Vector3d(0.0, 0.0, 0.3)).norm());
  }
  EXPECT_LT(off, 1e-3);
  EXPECT_LT(to_pin, 1e-6);
}

TEST(Figure, MarkupAndTruthDescribeTheSurface) {
  const PerformanceDatabase& database = performer();
  ASSERT_TRUE(database.markup());
  const Markup& markup = *database.markup();
  EXPECT_EQ(markup.parts.size(), 6U);
  const int head = markup.skeleton.joint_idx("head");
  const ClipTruth* truth = database.truth(database.clip_idx("jog"));
  ASSERT_NE(truth, nullptr);
  const MeshSequence& jog = clip_of("jog");
  ASSERT_EQ(truth->poses.size(), jog.frame_count());
  ASSERT_EQ(truth->contacts.size(), jog.frame_count());
  // The head is rigid: where its joint says it is, there its vertices are.
  for (std::size_t f = 0; f < jog.frame_count(); f += 9) {
    const Eigen::Isometry3d moved = truth->poses[f].world_from_rest(markup.skeleton, head);
    for (const std::int32_t v : markup.vertices_of_joint(head)) {
      if (body().bindings[static_cast<std::size_t>(v)].weights.front() < 1.0) continue;
      const Vector3d expected = moved * Vector3d(markup.reference.row(v).transpose().cast<double>());
      EXPECT_LT((expected - jog.frame(f).row(v).transpose().cast<double>()).norm(), 1e-5);
    }
  }
}

}  // namespace
}  // namespace reprise
