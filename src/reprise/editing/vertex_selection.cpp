// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/editing/vertex_selection.h"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/core/text.h"

namespace reprise {
namespace {

const Markup& markup_of(const PerformanceDatabase& database, const char* kind, const std::string& name) {
  if (database.markup()) return *database.markup();
  throw InvalidArgument(fmt::format(
      "{} '{}': the database has no markup; give it one with `reprise markup`, or choose by vertices or near",
      kind, name));
}

const BodyPart& part_of(const Markup& markup, const std::string& name) {
  std::vector<std::string> names;
  for (const BodyPart& part : markup.parts) {
    if (part.name == name) return part;
    names.push_back(part.name);
  }
  const std::string nearest = nearest_word(name, names);
  throw InvalidArgument(fmt::format("there is no part '{}'{}; there are {}", name,
                                    nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest),
                                    fmt::join(names, ", ")));
}

// Keeps of `chosen` what `also` names.
void keep(const std::vector<std::int32_t>& also, std::vector<bool>& chosen) {
  std::vector<bool> named(chosen.size(), false);
  for (const std::int32_t vertex : also) named[static_cast<std::size_t>(vertex)] = true;
  for (std::size_t v = 0; v < chosen.size(); ++v) chosen[v] = chosen[v] && named[v];
}

}  // namespace

std::vector<std::int32_t> select_vertices(const PerformanceDatabase& database, FrameId frame,
                                          const VertexSelection& selection) {
  if (selection.empty()) {
    throw InvalidArgument("no vertex is chosen: expected vertices, joint, part or near");
  }
  const PositionsView positions = database.clip(frame.clip_idx).frame(frame.frame_idx);
  std::vector<bool> chosen(static_cast<std::size_t>(positions.rows()), true);
  if (!selection.vertices.empty()) {
    for (const std::int32_t vertex : selection.vertices) {
      if (vertex >= 0 && vertex < positions.rows()) continue;
      throw InvalidArgument(
          fmt::format("expected vertices from 0 to {}, found {}", positions.rows() - 1, vertex));
    }
    keep(selection.vertices, chosen);
  }
  if (!selection.joint.empty()) {
    const Markup& markup = markup_of(database, "joint", selection.joint);
    const std::vector<std::int32_t> labelled =
        markup.vertices_of_joint(markup.skeleton.joint_idx(selection.joint));
    if (labelled.empty()) {
      throw InvalidArgument(fmt::format("no vertex follows the joint '{}' in the markup", selection.joint));
    }
    keep(labelled, chosen);
  }
  if (!selection.part.empty()) {
    keep(part_of(markup_of(database, "part", selection.part), selection.part).vertices, chosen);
  }
  double nearest = std::numeric_limits<double>::infinity();
  if (selection.near) {
    if (!(selection.radius > 0.0) || !std::isfinite(selection.radius) || !selection.near->allFinite()) {
      throw InvalidArgument(fmt::format(
          "expected a finite place and a radius above 0 m, found a radius of {}", selection.radius));
    }
    for (std::size_t v = 0; v < chosen.size(); ++v) {
      if (!chosen[v]) continue;
      const double distance =
          (positions.row(static_cast<Eigen::Index>(v)).transpose().cast<double>() - *selection.near).norm();
      nearest = std::min(nearest, distance);
      chosen[v] = distance <= selection.radius;
    }
  }
  std::vector<std::int32_t> vertices;
  for (std::size_t v = 0; v < chosen.size(); ++v) {
    if (chosen[v]) vertices.push_back(static_cast<std::int32_t>(v));
  }
  if (vertices.empty()) {
    throw InvalidArgument(
        std::isfinite(nearest)
            ? fmt::format("no vertex is within {:g} m of ({:g}, {:g}, {:g}); the nearest is {:.3g} m away",
                          selection.radius, selection.near->x(), selection.near->y(), selection.near->z(),
                          nearest)
            : std::string("no vertex is in all that is given"));
  }
  return vertices;
}

}  // namespace reprise
