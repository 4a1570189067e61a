// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mocap/mocap_character.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"
#include "reprise/deform/skin_weights.h"
#include "reprise/mocap/surface_driver.h"
#include "reprise/synthesis/path_player.h"

namespace reprise {
namespace {

constexpr std::size_t stretch_length = 64;  // frames made at a time

const Markup& markup_of(const PerformanceDatabase& database) {
  if (database.markup()) return *database.markup();
  throw InvalidArgument(
      "the database has no markup, from which motion capture takes the character's skeleton: give it one "
      "with "
      "`reprise markup`");
}

std::vector<SkeletalMotion> follow(const PerformanceDatabase& database, const SkeletonFollower& follower) {
  std::vector<SkeletalMotion> motions;
  for (const MeshSequence& clip : database.clips()) {
    SkeletalMotion& motion = motions.emplace_back();
    motion = {.name = clip.name(),
              .skeleton = follower.skeleton(),
              .frames_per_second = clip.frames_per_second(),
              .frames = std::vector<SkeletonPose>(clip.frame_count())};
    parallel_for(0, clip.frame_count(),
                 [&](std::size_t f) { motion.frames[f] = follower.pose(clip.frame(f)); });
  }
  return motions;
}

JointTrack track_of(const std::vector<SkeletonPose>& poses) {
  JointTrack track;
  track.reserve(poses.size());
  for (const SkeletonPose& pose : poses) {
    Eigen::MatrixX3d& joints = track.emplace_back(static_cast<Eigen::Index>(pose.position.size()), 3);
    for (std::size_t j = 0; j < pose.position.size(); ++j) {
      joints.row(static_cast<Eigen::Index>(j)) = pose.position[j].transpose();
    }
  }
  return track;
}

std::vector<JointTrack> tracks_of(const std::vector<SkeletalMotion>& motions) {
  std::vector<JointTrack> tracks;
  for (const SkeletalMotion& motion : motions) tracks.push_back(track_of(motion.frames));
  return tracks;
}

// Where the captures stand: the mean over clips of what a twentieth of their frames' lowest points are below.
double captured_ground(const PerformanceDatabase& database) {
  double sum = 0.0;
  for (const MeshSequence& clip : database.clips()) {
    std::vector<double> lowest;
    for (std::size_t f = 0; f < clip.frame_count(); ++f) {
      lowest.push_back(static_cast<double>(clip.frame(f).col(1).minCoeff()));
    }
    const auto low = lowest.begin() + static_cast<std::ptrdiff_t>(lowest.size() / 20);
    std::nth_element(lowest.begin(), low, lowest.end());
    sum += *low;
  }
  return sum / static_cast<double>(database.clips().size());
}

// The lowest points of both feet on the marked surface over the captured ground. They need not be labelled:
// of the vertices nearer to one ankle than to the other. None if there is no surface there.
std::optional<std::array<double, 2>> soles_at_rest(const Markup& markup, double ground) {
  constexpr double foot_length = 0.35;  // metres, at most
  const JointMap map = find_joints(markup.skeleton, "the character");
  std::array<Eigen::RowVector3f, 2> ankles;
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    const std::string& name = map.joints.at(side == 0 ? "left_foot" : "right_foot");
    const Joint& joint = markup.skeleton.joints[static_cast<std::size_t>(markup.skeleton.joint_idx(name))];
    ankles[side] = joint.rest_position.cast<float>().transpose();
  }
  std::array<double, 2> soles = {std::numeric_limits<double>::infinity(),
                                 std::numeric_limits<double>::infinity()};
  for (Eigen::Index v = 0; v < markup.reference.rows(); ++v) {
    const std::array<float, 2> away = {(markup.reference.row(v) - ankles[0]).norm(),
                                       (markup.reference.row(v) - ankles[1]).norm()};
    const std::size_t side = away[0] < away[1] ? 0 : 1;
    if (static_cast<double>(away[side]) > foot_length) continue;
    soles[side] = std::min(soles[side], static_cast<double>(markup.reference(v, 1)));
  }
  if (!std::isfinite(soles[0]) || !std::isfinite(soles[1])) return std::nullopt;
  return std::array{soles[0] - ground, soles[1] - ground};
}

// Whether all frames have the colours of the first.
bool is_repeated(const std::vector<Color>& colors, std::size_t vertex_count) {
  for (std::size_t begin = vertex_count; begin < colors.size(); begin += vertex_count) {
    const auto frame = colors.begin() + static_cast<std::ptrdiff_t>(begin);
    if (!std::equal(frame, frame + static_cast<std::ptrdiff_t>(vertex_count), colors.begin())) return false;
  }
  return true;
}

}  // namespace

struct MocapCharacter::Impl {
  Impl(const PerformanceDatabase& of, const SurfaceMotionGraph& graph,
       std::vector<DriveVertex> drive_vertices)
      : database(of),
        markup(markup_of(of)),
        profile(graph.options.profile),
        poisson(of.topology(), of.clip(0).frame(0)),
        follower(of.clips(), markup),
        motions(follow(of, follower)),
        figure(markup.skeleton, motions, "the character", soles_at_rest(markup, captured_ground(of))),
        retriever(tracks_of(motions), of.clip_names(), graph.active_transitions(), profile,
                  of.frames_per_second()) {
    rig.topology = of.topology();
    rig.markup = &markup;
    rig.weights = std::make_shared<const SkinWeights>(skin_weights(of.topology(), markup));
    rig.vertices = drive_vertices.empty() ? choose_drive_vertices(of, follower) : std::move(drive_vertices);
  }

  // The rig with what the model has learnt.
  DriveRig rig_for(DriveModel model) {
    DriveRig result = rig;
    if (model != DriveModel::part && model != DriveModel::whole) return result;
    const bool is_whole = model == DriveModel::whole;
    const LearntModel& stored = is_whole ? database.models().whole : database.models().part;
    if (stored.parts.empty()) {
      throw InvalidArgument(fmt::format("the database has no learnt {}: learn one with `reprise model learn`",
                                        is_whole ? "whole-body model" : "model of parts"));
    }
    const std::lock_guard lock(mutex);
    std::shared_ptr<const PartModel>& kept = is_whole ? whole : part;
    if (!kept) kept = std::make_shared<const PartModel>(database.topology(), stored, drive_part_options());
    result.learnt = kept;
    return result;
  }

  const PerformanceDatabase& database;
  const Markup& markup;
  BlendProfile profile;
  PoissonReconstruction poisson;
  SkeletonFollower follower;
  std::vector<SkeletalMotion> motions;  // of the clips
  StandingFigure figure;
  SkeletonRetriever retriever;
  DriveRig rig;
  std::mutex mutex;
  std::shared_ptr<const PartModel> part, whole;
};

MocapCharacter::MocapCharacter(const PerformanceDatabase& database, const SurfaceMotionGraph& graph,
                               std::vector<DriveVertex> drive_vertices) {
  check_graph_fits(graph, database);
  impl_ = std::make_unique<Impl>(database, graph, std::move(drive_vertices));
}

MocapCharacter::~MocapCharacter() = default;

const PerformanceDatabase& MocapCharacter::database() const {
  return impl_->database;
}
const SkeletonFollower& MocapCharacter::follower() const {
  return impl_->follower;
}
const StandingFigure& MocapCharacter::figure() const {
  return impl_->figure;
}
const std::vector<DriveVertex>& MocapCharacter::drive_vertices() const {
  return impl_->rig.vertices;
}

tl::expected<std::vector<MocapPlan>, NoRetrieval> MocapCharacter::plan(const SkeletalMotion& query,
                                                                       const MocapOptions& options) const {
  RetargetOptions retargeting = options.retargeting;
  retargeting.frames_per_second = impl_->database.frames_per_second();
  const RetargetedMotion target = retarget_motion(query, impl_->figure, retargeting);
  auto found = impl_->retriever.retrieve(track_of(target.motion.frames), options.retrieval);
  if (!found) return tl::make_unexpected(std::move(found.error()));
  std::vector<MocapPlan> plans;
  for (Retrieval& retrieval : *found) {
    std::vector<double> times = path_times(retrieval.path_frame, options.timing);
    plans.push_back({target, std::move(retrieval), std::move(times)});
  }
  return plans;
}

void MocapCharacter::animate(const MocapPlan& plan, const MocapOptions& options,
                             const FrameSink& sink) const {
  const std::vector<SkeletonPose>& targets = plan.target.motion.frames;
  if (plan.times.size() != targets.size() || targets.empty()) {
    throw InvalidArgument(
        fmt::format("the plan has {} moments for {} target poses", plan.times.size(), targets.size()));
  }
  const PathPlayer player(impl_->database, impl_->poisson, plan.retrieval.path, impl_->profile, plan.times);
  const DriveRig rig = impl_->rig_for(options.model);
  tbb::enumerable_thread_specific<SurfaceDriver> drivers([&] { return SurfaceDriver(rig, options.model); });
  GroundTransform start;  // where a motion that is not driven begins

  Progress progress("motion capture", targets.size());
  for (std::size_t first = 0; first < targets.size(); first += stretch_length) {
    const std::size_t last = std::min(first + stretch_length, targets.size());
    MeshSequence frames = player.frames(first, last);
    if (options.model == DriveModel::none && first == 0) {
      start = nearest_upright(impl_->follower.pose(std::as_const(frames).frame(0)), targets[0]).ground;
    }
    if (frames.has_normals()) frames.mutable_normals(0);
    parallel_for(0, last - first, [&](std::size_t f) {
      const PositionsRef frame = frames.frame(f);
      const PositionsView shown(frame.data(), frame.rows(), 3);
      if (options.model == DriveModel::none) {
        transform_positions(start, shown, frame);
        if (frames.has_normals()) {
          transform_positions({.yaw = start.yaw}, std::as_const(frames).normals(f),
                              frames.mutable_normals(f));
        }
      } else {
        drivers.local().drive(shown, impl_->follower.pose(shown), targets[first + f], frame);
        if (frames.has_normals()) frames.mutable_normals(f) = vertex_normals(*frames.topology(), shown);
      }
      progress.advance();
    });
    for (std::size_t f = 0; f < last - first; ++f) {
      sink(frames.mesh(f), frames.origins().at(f));
    }
  }
}

MeshSequence MocapCharacter::animate(const MocapPlan& plan, const MocapOptions& options) const {
  MeshSequence animation(options.name, impl_->database.topology(), plan.times.size(),
                         impl_->database.frames_per_second());
  std::vector<FrameOrigin> origins;
  std::vector<Color> colors;
  animate(plan, options, [&](const Mesh& mesh, const FrameOrigin& origin) {
    const std::size_t f = origins.size();
    animation.frame(f) = mesh.positions;
    if (mesh.normals.rows() > 0) animation.mutable_normals(f) = mesh.normals;
    colors.insert(colors.end(), mesh.colors.begin(), mesh.colors.end());
    origins.push_back(origin);
  });
  animation.set_origins(std::move(origins));
  if (is_repeated(colors, animation.vertex_count())) colors.resize(animation.vertex_count());
  animation.set_colors(std::move(colors));
  return animation;
}

}  // namespace reprise
