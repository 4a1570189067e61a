// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// An artist's session on one performer: pick a frame, hold some vertices, drag others, think better of it.

#pragma once

#include <memory>
#include <string>
#include <vector>

#include "reprise/editing/editor_factory.h"

namespace reprise {

// Vertices that are held (an anchor) or moved (a handle) as one.
struct Handle {
  std::string name;                    // one name in the session, among anchors and handles
  std::vector<std::int32_t> vertices;  // ascending, at least one
  double weight = 1.0;                 // of each vertex, as in `PositionConstraint`

  bool operator==(const Handle&) const = default;
};

// What was made of a captured frame.
struct EditedFrame {
  FrameId frame;
  std::vector<PositionConstraint> constraints;  // anchors, then handles
  Positions positions;                          // N x 3, metres
};

// Every change is one step that can be undone, and a change to what is already so is none. An error leaves
// the session as it was. The surface depends on model, frame, anchors and handles as they are now and on
// nothing before: undo gives back the same bits. With every handle at rest it is the captured frame, bit for
// bit. One thread at a time.
class EditingSession {
 public:
  // Throws `InvalidArgument` for a frame that the database does not have, and as `EditorFactory::make`; so do
  // the setters.
  EditingSession(std::shared_ptr<const EditorFactory> factory, EditModel model, FrameId frame);
  ~EditingSession();

  void set_model(EditModel model);
  void set_frame(FrameId frame);  // anchors and handles stay and rest at their new places
  EditModel model() const;
  FrameId frame() const;

  // Anchors stay where they are in the frame; a handle is at rest until it is dragged. A handle that was
  // there before, with the same name and vertices, stays where it was dragged to. Throw `InvalidArgument` for
  // a name that is empty or taken, vertices that are none, unsorted or out of range, a weight that is not
  // positive and finite, or a vertex in two handles. A vertex of both a handle and an anchor goes with the
  // handle; one of two anchors is held with the greater weight.
  void set_anchors(std::vector<Handle> anchors);
  void set_handles(std::vector<Handle> handles);
  const std::vector<Handle>& anchors() const;
  const std::vector<Handle>& handles() const;

  // Puts a handle `displacement` (metres) away from its captured place and `rotation` about its centroid
  // there. With `is_final` false, further drags of the same handle are the same step of undo. Throws
  // `InvalidArgument` for a handle that does not exist (offers the nearest name), or values that are not
  // finite.
  DeformReport drag(const std::string& handle, const Eigen::Vector3d& displacement,
                    const Eigen::Quaterniond& rotation = Eigen::Quaterniond::Identity(),
                    bool is_final = true);
  // Where a handle was dragged to.
  Eigen::Vector3d displacement(const std::string& handle) const;
  Eigen::Quaterniond rotation(const std::string& handle) const;

  bool undo();   // false: nothing to undo
  bool redo();   // false: nothing to redo
  void reset();  // all handles at rest; can be undone

  // The surface now, N x 3, metres, its unit normals, and how well it meets the constraints.
  const Coordinates& positions() const;
  const Positions& normals() const;
  const DeformReport& report() const;

  // Keeps the surface of now, instead of an earlier one of the same frame. Commits are results: undo leaves
  // them alone.
  const EditedFrame& commit();
  const std::vector<EditedFrame>& commits() const;  // in the order of first commit

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace reprise
