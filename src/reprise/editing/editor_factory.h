// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Editors of any model for the frames of one performer.

#pragma once

#include <memory>

#include "reprise/database/performance_database.h"
#include "reprise/deform/surface_editor.h"
#include "reprise/editing/edit_model.h"

namespace reprise {

// Makes editors and keeps what they share: learnt operators, skinning weights, the clips' skeletons. Each is
// made when it is first asked for. Thread-safe. Virtual, so that other models can be tried in a session.
class EditorFactory {
 public:
  // `database` must outlive the factory and stay as it is. What a model needs is looked at when it is made.
  explicit EditorFactory(const PerformanceDatabase& database);
  virtual ~EditorFactory();
  EditorFactory(const EditorFactory&) = delete;
  EditorFactory& operator=(const EditorFactory&) = delete;

  const PerformanceDatabase& database() const;

  // Throws `InvalidArgument` that says what to do if the database lacks what the model needs: a learnt model
  // (`reprise model learn`), or a markup (`reprise markup`).
  virtual std::unique_ptr<SurfaceEditor> make(EditModel model) const;

  // The pose of a captured frame for skinned models, which stays as long as the factory; null for the others.
  // Throws as `make`, and for a frame that the database does not have.
  virtual const SkeletonPose* pose(EditModel model, FrameId frame) const;

  // The vertices whose turning an edit takes part in: those of the markup's root part (the torso), else of
  // the learnt root part, else all.
  std::vector<std::int32_t> root_vertices() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace reprise
