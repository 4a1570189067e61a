// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/database/performance_database.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/core/hash.h"
#include "reprise/core/text.h"

namespace reprise {

namespace {

// Does a database gain by looking like `offered` instead of `current`, the same surface?
bool adds_appearance(const Topology& current, const Topology& offered) {
  if (!current.has_uvs()) return offered.has_uvs();
  return !current.texture && offered.texture && current.uvs == offered.uvs &&
         current.triangle_uvs == offered.triangle_uvs;
}

bool is_same(const Skeleton& a, const Skeleton& b) {
  return std::ranges::equal(a.joints, b.joints, [](const Joint& p, const Joint& q) {
    return p.name == q.name && p.parent == q.parent && p.rest_position == q.rest_position;
  });
}

}  // namespace

void PerformanceDatabase::add(MeshSequence clip) {
  const std::string& name = clip.name();
  if (name.empty() || name == "." || name == ".." || name.find_first_of(":/") != std::string::npos) {
    throw InvalidArgument(fmt::format("'{}' cannot name a clip: expected a name without ':' and '/'", name));
  }
  if (std::ranges::count(clips_, name, &MeshSequence::name) > 0) {
    throw InvalidArgument(fmt::format("there is a clip named '{}' already", name));
  }
  if (clip.frame_count() == 0) throw InvalidArgument(fmt::format("clip '{}' has no frames", name));
  if (!topology_) {
    topology_ = clip.topology();
  } else if (clip.topology() != topology_) {
    const std::string difference =
        first_difference(*topology_, *clip.topology(), fmt::format("clip '{}'", clips_.front().name()),
                         fmt::format("clip '{}'", name));
    if (!difference.empty()) {
      throw InvalidArgument("all clips of a database share one topology, but " + difference);
    }
    if (adds_appearance(*topology_, *clip.topology())) {
      topology_ = clip.topology();
      for (MeshSequence& earlier : clips_) earlier.share_topology(topology_);
    }
    clip.share_topology(topology_);
  }
  first_frames_.push_back(frame_count_);
  frame_count_ += clip.frame_count();
  clips_.push_back(std::move(clip));
  truths_.emplace_back();
}

const MeshSequence& PerformanceDatabase::clip(std::size_t clip_idx) const {
  if (clip_idx >= clips_.size()) {
    throw InvalidArgument(fmt::format("there is no clip {}: the database holds {}", clip_idx, clips_.size()));
  }
  return clips_[clip_idx];
}

std::size_t PerformanceDatabase::first_frame(std::size_t clip_idx) const {
  clip(clip_idx);  // checks the index
  return first_frames_[clip_idx];
}

std::vector<std::string> PerformanceDatabase::clip_names() const {
  std::vector<std::string> names;
  names.reserve(clips_.size());
  for (const MeshSequence& clip : clips_) names.push_back(clip.name());
  return names;
}

std::size_t PerformanceDatabase::clip_idx(const std::string& name) const {
  const auto found = std::ranges::find(clips_, name, &MeshSequence::name);
  if (found != clips_.end()) return static_cast<std::size_t>(found - clips_.begin());
  if (clips_.empty())
    throw InvalidArgument(fmt::format("there is no clip '{}': the database holds none", name));
  const std::vector<std::string> names = clip_names();
  const std::string nearest = nearest_word(name, names);
  throw InvalidArgument(
      nearest.empty() ? fmt::format("there is no clip '{}'; the clips are {}", name, fmt::join(names, ", "))
                      : fmt::format("there is no clip '{}'; did you mean '{}'?", name, nearest));
}

FrameId PerformanceDatabase::parse_frame(const std::string& text) const {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) {
    throw InvalidArgument(fmt::format("'{}' is not a frame: expected CLIP:FRAME, such as {}:0", text,
                                      clips_.empty() ? "walk" : clips_.front().name()));
  }
  FrameId frame{.clip_idx = clip_idx(text.substr(0, colon))};
  const std::string number = text.substr(colon + 1);
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), frame.frame_idx);
  if (error != std::errc() || end != number.data() + number.size()) {
    throw InvalidArgument(fmt::format("'{}' is not a frame: expected a number from 0 after the colon", text));
  }
  const MeshSequence& c = clips_[frame.clip_idx];
  if (frame.frame_idx >= c.frame_count()) {
    throw InvalidArgument(fmt::format("clip '{}' has frames 0 to {}, asked for {}", c.name(),
                                      c.frame_count() - 1, frame.frame_idx));
  }
  return frame;
}

std::string PerformanceDatabase::to_string(FrameId frame) const {
  return fmt::format("{}:{}", clip(frame.clip_idx).name(), frame.frame_idx);
}

double PerformanceDatabase::frames_per_second() const {
  if (clips_.empty()) throw InvalidArgument("the database holds no clip");
  for (const MeshSequence& c : clips_) {
    if (c.frames_per_second() != clips_.front().frames_per_second()) {
      throw InvalidArgument(fmt::format(
          "clip '{}' has {} frames per second and clip '{}' has {}: expected one rate", clips_.front().name(),
          clips_.front().frames_per_second(), c.name(), c.frames_per_second()));
    }
  }
  return clips_.front().frames_per_second();
}

void PerformanceDatabase::set_markup(std::optional<Markup> markup) {
  if (markup) {
    if (!topology_) throw InvalidArgument("a markup needs a database with a clip: it labels the vertices");
    validate(*markup, topology_->vertex_count);
  }
  if (!markup || !markup_ || !is_same(markup->skeleton, markup_->skeleton)) {
    for (std::optional<ClipTruth>& truth : truths_) truth.reset();
  }
  markup_ = std::move(markup);
}

const ClipTruth* PerformanceDatabase::truth(std::size_t clip_idx) const {
  clip(clip_idx);  // checks the index
  return truths_[clip_idx] ? &*truths_[clip_idx] : nullptr;
}

void PerformanceDatabase::set_truth(std::size_t clip_idx, ClipTruth truth) {
  const MeshSequence& c = clip(clip_idx);
  if (!markup_) {
    throw InvalidArgument(fmt::format(
        "clip '{}': a truth needs a markup, whose skeleton its poses are poses of; there is none", c.name()));
  }
  try {
    validate(truth, markup_->skeleton, c.frame_count());
  } catch (const InvalidArgument& error) {
    throw InvalidArgument(fmt::format("clip '{}': {}", c.name(), error.what()));
  }
  truths_[clip_idx] = std::move(truth);
}

void PerformanceDatabase::set_models(LearntModels models) {
  if (!models.empty()) {
    if (!topology_)
      throw InvalidArgument("a learnt model needs a database with a clip: it deforms its surface");
    validate(models, topology_->vertex_count);
  }
  models_ = std::move(models);
}

std::string PerformanceDatabase::content_hash() const {
  ContentHash hash;
  if (topology_) {
    hash.add_number(topology_->vertex_count).add(std::span<const Triangle>(topology_->triangles));
  }
  for (const MeshSequence& c : clips_) {
    hash.add(c.name()).add_number(c.frames_per_second()).add(std::span<const float>(c.data()));
  }
  return hash.hex();
}

std::string PerformanceDatabase::appearance_hash() const {
  ContentHash hash;
  if (topology_) {
    hash.add(std::span<const std::array<float, 2>>(topology_->uvs))
        .add(std::span<const Triangle>(topology_->triangle_uvs));
    if (const auto& texture = topology_->texture) {
      hash.add_number(texture->width)
          .add_number(texture->height)
          .add(std::span<const std::uint8_t>(texture->rgb));
    }
  }
  for (const MeshSequence& c : clips_) {
    const std::size_t sets = c.has_colors_per_frame() ? c.frame_count() : c.has_colors() ? 1 : 0;
    hash.add(c.name()).add_number(static_cast<double>(sets));
    for (std::size_t f = 0; f < sets; ++f) hash.add(c.colors(f));
  }
  return hash.hex();
}

}  // namespace reprise
