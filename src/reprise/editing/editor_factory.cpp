// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/editing/editor_factory.h"

#include <mutex>
#include <numeric>
#include <vector>

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include "reprise/core/error.h"
#include "reprise/deform/laplacian_editor.h"
#include "reprise/deform/part_editor.h"
#include "reprise/deform/skin_editor.h"
#include "reprise/skeleton/skeleton_extraction.h"

namespace reprise {
namespace {

bool is_skinned(EditModel model) {
  return model == EditModel::lbs || model == EditModel::dqs;
}

}  // namespace

struct EditorFactory::Impl {
  const PerformanceDatabase& database;
  std::mutex mutex;
  std::shared_ptr<const PartModel> part, whole;
  std::shared_ptr<const SkinWeights> weights;
  std::vector<std::unique_ptr<const SkeletalMotion>> motions;  // one a clip

  // Makes what is missing, once. A thread that waits inside of parallel work must not meet its own lock, so
  // it takes no other work up meanwhile.
  template <typename Value, typename Make>
  const Value& once(Value& value, const Make& make_value) {
    const std::lock_guard lock(mutex);
    if (!value) tbb::this_task_arena::isolate([&] { value = make_value(); });
    return value;
  }

  const Markup& markup() const {
    if (database.markup()) return *database.markup();
    throw InvalidArgument(
        "the database has no markup, from which skinning takes its skeleton: give it one with `reprise "
        "markup`");
  }

  std::shared_ptr<const PartModel> learnt(EditModel model) {
    const bool is_whole = model == EditModel::whole;
    return once(is_whole ? whole : part, [&] {
      const LearntModel& stored = is_whole ? database.models().whole : database.models().part;
      if (stored.parts.empty()) {
        throw InvalidArgument(
            fmt::format("the database has no learnt {}: learn one with `reprise model learn`",
                        is_whole ? "whole-body model" : "model of parts"));
      }
      return std::make_shared<const PartModel>(database.topology(), stored);
    });
  }

  std::shared_ptr<const SkinWeights> skinning() {
    return once(weights, [&] {
      return std::make_shared<const SkinWeights>(skin_weights(database.topology(), markup()));
    });
  }
};

EditorFactory::EditorFactory(const PerformanceDatabase& database)
    : impl_(new Impl{.database = database, .motions = {}}) {
  impl_->motions.resize(database.clips().size());
}

EditorFactory::~EditorFactory() = default;

const PerformanceDatabase& EditorFactory::database() const {
  return impl_->database;
}

std::unique_ptr<SurfaceEditor> EditorFactory::make(EditModel model) const {
  const PerformanceDatabase& database = impl_->database;
  if (database.empty()) throw InvalidArgument("there is nothing to edit: the database has no clip");
  switch (model) {
    case EditModel::part:
    case EditModel::whole:
      return std::make_unique<PartEditor>(impl_->learnt(model));
    case EditModel::laplacian: {
      if (!database.markup()) {
        return std::make_unique<LaplacianEditor>(database.topology(), database.clips().front().frame(0));
      }
      const Positions& reference = database.markup()->reference;
      return std::make_unique<LaplacianEditor>(database.topology(),
                                               PositionsView(reference.data(), reference.rows(), 3));
    }
    case EditModel::lbs:
    case EditModel::dqs:
      return std::make_unique<SkinEditor>(
          impl_->skinning(), impl_->markup().skeleton,
          PoseFitOptions{.skinning = model == EditModel::lbs ? Skinning::linear : Skinning::dual_quaternion});
  }
  throw InvalidArgument(fmt::format("there is no model number {}", static_cast<int>(model)));
}

const SkeletonPose* EditorFactory::pose(EditModel model, FrameId frame) const {
  const MeshSequence& clip = impl_->database.clip(frame.clip_idx);
  static_cast<void>(clip.frame(frame.frame_idx));  // throws if there is no such frame
  if (!is_skinned(model)) return nullptr;
  const auto& motion = impl_->once(impl_->motions[frame.clip_idx], [&] {
    return std::make_unique<const SkeletalMotion>(extract_skeleton(clip, impl_->markup()));
  });
  return &motion->frames[frame.frame_idx];
}

std::vector<std::int32_t> EditorFactory::root_vertices() const {
  const PerformanceDatabase& database = impl_->database;
  if (database.markup()) {
    for (const BodyPart& part : database.markup()->parts) {
      if (part.parent < 0) return part.vertices;
    }
  }
  if (const LearntModel& model = database.models().part; !model.parts.empty()) {
    return model.parts.front().part.vertices;
  }
  std::vector<std::int32_t> all(
      database.topology() == nullptr ? 0 : static_cast<std::size_t>(database.topology()->vertex_count));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

}  // namespace reprise
