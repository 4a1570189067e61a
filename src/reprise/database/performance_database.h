// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A performance database: all captured clips of one performer, on one topology.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reprise/database/learnt_model.h"
#include "reprise/database/markup.h"
#include "reprise/sequence/mesh_sequence.h"

namespace reprise {

// A frame of a clip, as the user writes it: "crane:20" is frame 20 (from 0) of clip "crane".
struct FrameId {
  std::size_t clip_idx = 0;
  std::size_t frame_idx = 0;
  bool operator==(const FrameId&) const = default;
};

class PerformanceDatabase {
 public:
  // Adds a clip. Throws `InvalidArgument` if it has no frames, if its name is empty, "." or "..", holds ':'
  // or '/', or is taken, or if its topology is not that of the clips before it (says the first difference).
  // Equal topologies become one shared object: the first that has texture coordinates, for a clip without
  // them gains by sharing. A texture goes with its coordinates: it is taken from a later clip only if the
  // coordinates are the same.
  void add(MeshSequence clip);

  bool empty() const { return clips_.empty(); }
  const TopologyPtr& topology() const { return topology_; }
  const std::vector<MeshSequence>& clips() const { return clips_; }
  // Throws `InvalidArgument` if the index is out of range, like everything here that takes one.
  const MeshSequence& clip(std::size_t clip_idx) const;
  std::vector<std::string> clip_names() const;

  // Index of the clip of that name. Throws `InvalidArgument` that offers the nearest name.
  std::size_t clip_idx(const std::string& name) const;

  // Parses "CLIP:FRAME". Throws `InvalidArgument` for an unknown clip, a frame that is not a number, or one
  // beyond the clip (says its last frame).
  FrameId parse_frame(const std::string& text) const;
  std::string to_string(FrameId frame) const;

  // Frames of all clips lie one after the other: index of the first frame of a clip, and the number of all
  // frames.
  std::size_t first_frame(std::size_t clip_idx) const;
  std::size_t frame_count() const { return frame_count_; }

  // The rate all clips share. Throws `InvalidArgument` naming two clips that differ: motion between clips of
  // different rates has no frame time.
  double frames_per_second() const;

  // Joints, parts and layers of the performer, if somebody marked them. Throws `InvalidArgument` if it does
  // not fit the topology, or if there is no clip yet. Truths of clips stay only if the skeleton stays.
  const std::optional<Markup>& markup() const { return markup_; }
  void set_markup(std::optional<Markup> markup);

  // The truth of a synthetic clip, or null. `set_truth` throws `InvalidArgument` unless there is a markup
  // whose skeleton the poses fit, one pose and one contact entry a frame.
  const ClipTruth* truth(std::size_t clip_idx) const;
  void set_truth(std::size_t clip_idx, ClipTruth truth);

  // How parts and whole were learnt to deform, as far as they were. Their reference and parts are their own:
  // another markup leaves them as they are, and so do clips added later. Throws `InvalidArgument` if they do
  // not fit the topology, or if there is no clip yet.
  const LearntModels& models() const { return models_; }
  void set_models(LearntModels models);

  // Content hash of names, rates, topology and positions: the key of everything computed from the database.
  // Markup, truth and models are no part of it.
  std::string content_hash() const;
  // Hash of what `content_hash` leaves out and a look depends on: colours, texture and its coordinates.
  std::string appearance_hash() const;

 private:
  TopologyPtr topology_;
  std::vector<MeshSequence> clips_;
  std::vector<std::size_t> first_frames_;
  std::size_t frame_count_ = 0;
  std::optional<Markup> markup_;
  std::vector<std::optional<ClipTruth>> truths_;  // one a clip
  LearntModels models_;
};

}  // namespace reprise
